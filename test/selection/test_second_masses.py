"""Starts for a second mass, by regressions alone."""

from __future__ import annotations

import math

import pytest
from massrigs import swept
from setrigs import BASE, fitted, steps

from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.second_mode import SecondMode
from msd_ident.selection.second_masses import second_masses, swing
from msd_ident.selection.structure_search import Search


def test_a_heavy_second_mass_is_begun_where_a_regression_puts_it() -> None:
    """The model without it has the sum of both masses, and from there no small change leads to two."""
    second = {"second_mass": 0.36, "second_stiffness": 3017.0, "second_damping": 1.7}
    record = swept({"second_mode": second})
    whole = Plant(1.37, 1.354, 724.4)
    residual = simulate(whole, record).position - record.position
    start = second_masses(whole, record, residual, ())[0]
    assert start.plant == pytest.approx((0.96, 1.35, 712.0), rel=0.15)
    assert start.hung[:2] == pytest.approx((0.36, 3017.0), rel=0.2)
    held = second_masses(whole, record, residual, ("mass",))
    assert held and all(one.plant[0] == whole.mass for one in held)


@pytest.mark.parametrize(("stiffness", "period"), [(200.0, 2.0 * math.pi / math.sqrt(600.0)), (0.0, math.inf)])
def test_a_second_mass_swings_against_the_first(stiffness: float, period: float) -> None:
    plant = Model(1.0, 2.0, 100.0)
    assert swing(plant + SecondMode(0.5, stiffness, 0.1)) == pytest.approx(period)
    assert swing(plant) == 0.0 == swing(plant + SecondMode(0.0, stiffness, 0.0))


def test_a_second_mass_that_does_not_swing_once_is_not_kept() -> None:
    """An axis with a ball screw had one of 106 kg on 1.7 N/m, and dropped the offset that acts beside it."""
    data = steps()
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    slow, seen = (fitted(data, BASE + SecondMode(0.5, k2, 0.1), 100.0) for k2 in (1e-3, 50.0))
    search._keep(slow)
    assert not search.sets
    search._keep(seen)
    assert search.sets[seen.causes] is seen
