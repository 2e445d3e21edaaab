"""A second mass with dry friction of its own: against scipy, its limits, and found from data of another start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record, silent

from msd_ident.estimate import fit
from msd_ident.model import Simulator
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.rubbing_second_mode import RubbingSecondMode
from msd_ident.model.effects.second_mode import SecondMode


@pytest.mark.parametrize(
    ("mass", "rubs", "creep", "dry"),
    [(0.2, 0.3, 0.02, 0.0), (0.1, 1.5, 0.002, 0.0), (0.05, 0.4, 2e-4, 0.0), (0.1, 0.5, 0.002, 0.4)],
)
def test_the_law_is_the_published_one(mass: float, rubs: float, creep: float, dry: float) -> None:
    """Also where the friction stops the second mass well within a sample, and where friction holds the cart."""
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + RubbingSecondMode(mass, 800.0, 0.5, rubs, creep)
    whole = whole + CoulombFriction(dry) if dry else whole

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v, y, u = state
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        pull = 800.0 * (x - y) + 0.5 * (v - u)
        on_cart = force - DAMPING * v - STIFFNESS * x - pull - dry * np.tanh(v / 1e-5)
        return [v, on_cart / MASS, u, (pull - rubs * np.tanh(u / creep)) / mass]

    found = Simulator(whole, measured).positions(whole.values)
    expected = followed(slope, measured, states=4, method="LSODA")
    assert np.max(np.abs(found - expected)) < 1e-4 * np.ptp(expected)


def test_without_friction_it_is_a_second_mode() -> None:
    measured = record()
    same, simple = plant() + RubbingSecondMode(0.2, 800.0, 0.5, 0.0, 0.01), plant() + SecondMode(0.2, 800.0, 0.5)
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)


def test_on_a_stiff_spring_it_is_coulomb_friction_of_a_heavier_cart() -> None:
    """The masses then move as one; they are not joined, because the friction would go with the second one."""
    measured = record()
    same = plant() + RubbingSecondMode(0.2, 1e7, 50.0, 0.5, 1e-4)
    simple = plant().with_values({"mass": MASS + 0.2}) + CoulombFriction(0.5)
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 5e-3 * np.ptp(expected)


def test_friction_on_the_second_mass_takes_energy_and_never_gives_any() -> None:
    """Without any other damping, the cart never swings further than it was let go from, and less in the end."""
    free = silent(rate=2000.0)
    whole = plant().with_values({"damping": 0.0}) + RubbingSecondMode(0.2, 800.0, 0.0, 0.5, 0.001)
    moved = Simulator(whole, free).positions(whole.values, 0.01, 0.0)
    assert np.max(np.abs(moved)) <= 0.01 * (1.0 + 1e-9)
    assert np.max(np.abs(moved[-1000:])) < 0.8 * 0.01


def test_its_values_are_found_from_another_start() -> None:
    measured = record(rate=250.0, duration=1.0)
    truth = plant() + RubbingSecondMode(0.15, 900.0, 0.4, 0.4, 0.001)
    seen = replace(measured, position=Simulator(truth, measured).positions(truth.values))
    start = plant().with_values({"mass": 1.05 * MASS}) + RubbingSecondMode(0.1, 700.0, 0.6, 0.25, 0.005)
    found = fit(start, seen).model
    assert found["second_friction"] == pytest.approx(0.4, rel=1e-3)
    assert found["second_mass"] == pytest.approx(0.15, rel=1e-3)
    assert found.mass == pytest.approx(MASS, rel=1e-3)


def test_a_stiffer_coupling_is_out_of_its_range() -> None:
    """A cart whose own friction is smooth had a second mass on a rigid coupling with 99 %."""
    seen = RecordScales(
        MASS, STIFFNESS, reach=0.02, span=0.04, duration=3.0, period=2e-3, speed=0.4, rate=27.0, force=10.0
    )
    _, stiffest = RubbingSecondMode.resolvable(seen)["second_stiffness"]
    assert stiffest < 0.2 * SecondMode.resolvable(seen)["second_stiffness"][1]
