"""A magnet that a controller holds in the air, and stable rigs, with and without a controller."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import opposite_signs
from msd_sim.api import simulate


@cache
def levitated(push: float, gain: float = 40.0) -> Record:
    """A mass of 4 g that a force −``push``·x pulls back to its place, under a controller that moves it to and fro.

    Below 0 it pushes the mass away. A positive current pulls the mass downwards, as of a magnet above it.
    """
    mass, step, each = 0.004, 1e-4, 20
    rng = np.random.default_rng(3)
    setpoint = 1e-3 * np.repeat(rng.choice([-1.0, 1.0], 60), 1000)
    x = v = current = 0.0
    position, force = [], []
    for i, wanted in enumerate(setpoint):
        if i % each == 0:
            current = gain * (x - wanted) + 0.6 * v
            position.append(x + 2e-6 * rng.normal())
            force.append(current)
        v += step * (-current - push * x - 0.02 * v) / mass
        x += step * v
    return from_samples(step * each * np.arange(len(position)), np.array(force), np.array(position))


def test_a_magnet_in_the_air_is_told() -> None:
    """Two public records of such rigs got a delay of −17 and −27 ms, and masses of the wrong sign."""
    said = opposite_signs.warning([levitated(-9.0)])
    assert "of opposite signs." in said and "a controller holds an unstable motion" in said
    mass, stiffness = (float(said.split(f"a {what} (")[1].split()[0]) for what in ("mass", "stiffness"))
    assert mass == pytest.approx(-0.004, rel=0.15) and stiffness == pytest.approx(9.0, rel=0.1)


@pytest.mark.parametrize("push", [0.0, 9.0])
def test_a_stable_mass_under_the_same_controller_is_not(push: float) -> None:
    """Its current has a turned sign too: mass and stiffness are both below 0."""
    assert opposite_signs.warning([levitated(push)]) == ""
    signs = opposite_signs._signs(levitated(push), 6)
    assert push == 0.0 or (signs is not None and signs[0] < 0.0 and signs[1] < 0.0)


@pytest.mark.parametrize("experiment", ["steps", "sweep"])
@pytest.mark.parametrize("friction", [0.0, 0.03])
def test_an_open_loop_is_not(experiment: str, friction: float) -> None:
    rig = {"mass": 1.0, "damping": 20.0, "stiffness": 400.0, "friction_coefficient": friction}
    made = simulate({**rig, "experiment": experiment, "rate": 200.0})
    record = Record(made.time, made.position, made.force_time, made.force)
    assert opposite_signs.warning([record]) == ""
    assert opposite_signs._signs(record, 6) is not None, "the regression tells"


def test_a_turned_sign_is_told_of_stable_rigs_only() -> None:
    assert opposite_signs.turned([levitated(9.0)]) and not opposite_signs.turned([levitated(-9.0)])
    still = from_samples(np.arange(0.0, 4.0, 0.01), np.zeros(400), np.zeros(400))
    assert not opposite_signs.turned([still]) and not opposite_signs.turned([])
    assert opposite_signs.turned([still, levitated(9.0)]), "the other one tells"
    assert not opposite_signs.turned([levitated(9.0), levitated(-9.0)])


@pytest.mark.parametrize("stiffness", [0.0, 400.0])
def test_the_damping_decides_where_neither_mass_nor_stiffness_is_known(stiffness: float) -> None:
    values, no, yes = np.array([1.0, -2.0, stiffness]), np.array([False, True, False]), np.array([True, True, False])
    assert opposite_signs._below(values, no) and not opposite_signs._below(values, yes)
    assert not opposite_signs._below(values, np.zeros(3, np.bool_))
