"""Steps from the accelerations of the steps before."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from msd_ident.data.record import Record
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.second_mode import SecondMode
from msd_ident.model.kernel.adams import (
    _ERROR,
    _ONWARD,
    _V0,
    _V1,
    _X0,
    _X1,
    FEWEST,
    PAST,
    _sum,
    _weights,
)
from msd_ident.model.plant import Model

PLANT = Plant(0.94, 3.9, 694.0)


#: Numbers of accelerations before the present one that a step may take.
COUNTS = range(FEWEST, PAST + 1)


@pytest.mark.parametrize("nodes", [tuple(range(first, -n, -1)) for n in COUNTS for first in (0, 1)])
def test_polynomials_are_integrated_exactly(nodes: tuple[int, ...]) -> None:
    once, twice = _weights(nodes)
    random = np.random.default_rng(1)
    for degree in range(len(nodes)):
        acceleration = Polynomial(random.normal(size=degree + 1))
        values = acceleration(np.array(nodes))
        velocity = acceleration.integ()
        assert once @ values == pytest.approx(velocity(1.0), rel=1e-12)
        assert twice @ values == pytest.approx(velocity.integ()(1.0), rel=1e-12)


@pytest.mark.parametrize("n", COUNTS)
def test_the_last_difference_puts_a_step_right(n: int) -> None:
    """With it a step is exact one degree further: the polynomial through the acceleration at the end as well."""
    random = np.random.default_rng(2)
    acceleration = Polynomial(random.normal(size=n + 1))
    a, *past = acceleration(np.arange(0.0, -8.0, -1.0))
    last = acceleration(1.0) - _sum.py_func(_ONWARD, n, a, past)
    assert last == pytest.approx(acceleration.deriv(n)(0.0), rel=1e-8)
    velocity = acceleration.integ()
    for weights, one, exact in ((_V0, _V1, velocity(1.0)), (_X0, _X1, velocity.integ()(1.0))):
        foreseen = _sum.py_func(weights, n, a, past)
        assert foreseen + one[n] * last == pytest.approx(exact, rel=1e-8)
        assert foreseen != pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("n", COUNTS)
def test_the_next_difference_tells_the_error(n: int) -> None:
    """One degree beyond that, the velocity is wrong by the difference after the last one, times its weight."""
    acceleration = Polynomial([0.0] * (n + 1) + [1.0])
    a, *past = acceleration(np.arange(0.0, -9.0, -1.0))
    last = acceleration(1.0) - _sum.py_func(_ONWARD, n, a, past)
    beyond = last - (a - _sum.py_func(_ONWARD, n, past[0], past[1:]))
    made = _sum.py_func(_V0, n, a, past) + _V1[n] * last
    assert beyond == pytest.approx(math.factorial(n + 1), rel=1e-12)
    assert abs(made - acceleration.integ()(1.0)) == pytest.approx(_ERROR[n] * beyond, rel=1e-9)


@pytest.mark.parametrize(
    "model",
    [
        PLANT + CubicSpring(2e5),
        PLANT + Cogging(0.3, 0.01, 0.4),
        PLANT + Hysteresis(0.4, 0.003),
        PLANT + SecondMode(0.2, 800.0, 0.5) + CubicSpring(2e5),
    ],
    ids=lambda model: "+".join(model.effect_names),
)
def test_even_samples_give_the_motion_that_odd_ones_give(model: Model) -> None:
    """Between even samples one more at an odd place, so that every step is made from itself alone."""
    even = np.arange(3000) / 1000.0
    both = np.sort(np.concatenate([even, even[:-1] + 0.00037]))
    at, force = np.array([0.0, 0.7, 1.4, 2.2]), np.array([10.0, -10.0, 5.0, -3.0])
    motions = [
        simulate(model, Record(time=time, position=0.0 * time, force_time=at, force=force)) for time in (even, both)
    ]
    apart = motions[0].position - motions[1].position[np.searchsorted(both, even)]
    assert np.max(np.abs(apart)) < 2e-7 * np.max(np.abs(motions[1].position))
