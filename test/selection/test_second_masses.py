"""Starts for a second mass, by regressions alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from massrigs import swept
from setrigs import BASE, fitted, steps

from msd_ident.data.record import from_samples
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


def test_a_faint_swing_of_many_turns_is_known_to_a_part_of_a_turn() -> None:
    """Motor and load on a shaft without a spring, 70 turns of the ringing: trials 12 % apart led the fit astray."""
    rng, time = np.random.default_rng(3), 0.004 * np.arange(1600)
    force = 0.6 * np.repeat(rng.choice([-1.0, 1.0], 40), 40)
    true = Plant(0.002, 0.03, 0.0) + SecondMode(0.004, 6.0, 0.004)
    still = from_samples(time, force, 0.0 * time)
    read = simulate(true, still).position + rng.normal(0.0, 2.6e-4, time.size)
    record, whole = replace(still, position=read), Plant(0.006, 0.03, 0.0)
    start = second_masses(whole, record, simulate(whole, record).position - read, ("stiffness",))[0]
    assert start.hung[:2] == pytest.approx((0.004, 6.0), rel=0.03)
    assert math.sqrt(start.hung[1] / start.hung[0]) == pytest.approx(math.sqrt(6.0 / 0.004), rel=0.005)


@pytest.mark.parametrize("swings", [0.4, 0.7, 1.3])
def test_a_plant_that_is_faster_than_the_samples_has_no_wild_start(swings: float) -> None:
    """Beyond half the sampling rate the rule that bends a frequency makes a filter that blows up."""
    time, rate = 0.05 * np.arange(20_000), swings * 2.0 * math.pi / 0.05
    still = from_samples(time, 0.0 * time, 0.0 * time)
    read = np.sin(rate * time) + np.random.default_rng(1).normal(0.0, 0.1, time.size)
    found = second_masses(Plant(1.0, 1.0, rate**2), replace(still, position=read), read, ())
    assert all(math.isfinite(value) for one in found for value in (*one.plant, *one.hung))


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
