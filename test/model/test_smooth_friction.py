"""Dry friction that creeps: against scipy, its limits, found from another start, and told from what looks like it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record, silent

from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.model import Simulator
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.workflow import pipeline


def with_friction(measured: Record, size: float, creep: float) -> np.ndarray:
    """Positions of the plant with Fc·tanh(v/vc), by scipy."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        return [v, (force - DAMPING * v - STIFFNESS * x - size * np.tanh(v / creep)) / MASS]

    return followed(slope, measured, states=2, method="LSODA")


@pytest.mark.parametrize(("size", "creep"), [(0.5, 0.05), (2.0, 0.002), (0.3, 3e-4)])
def test_the_law_is_the_published_one(size: float, creep: float) -> None:
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + SmoothFriction(size, creep)
    found = Simulator(whole, measured).positions(whole.values)
    expected = with_friction(measured, size, creep)
    assert np.max(np.abs(found - expected)) < 1e-5 * np.ptp(expected)


def test_far_below_all_speeds_it_is_coulomb_friction() -> None:
    measured = record()
    same, simple = plant() + SmoothFriction(0.5, 1e-5), plant() + CoulombFriction(0.5)
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 2e-3 * np.ptp(expected)


def test_far_above_all_speeds_it_is_damping() -> None:
    measured = record()
    same, simple = plant() + SmoothFriction(300.0, 100.0), plant().with_values({"damping": DAMPING + 3.0})
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 1e-4 * np.ptp(expected)


def test_it_takes_energy_and_never_gives_any() -> None:
    whole = plant().with_values({"damping": 0.0}) + SmoothFriction(0.5, 0.01)
    moved = Simulator(whole, silent(rate=2000.0)).positions(whole.values, 0.01, 0.0)
    assert np.max(np.abs(moved)) <= 0.01 * (1.0 + 1e-9)
    assert np.max(np.abs(moved[-1000:])) < 0.5 * 0.01


def test_its_values_are_found_from_another_start() -> None:
    measured = record(rate=500.0)
    truth = plant() + SmoothFriction(0.4, 0.01)
    seen = replace(measured, position=Simulator(truth, measured).positions(truth.values))
    start = plant().with_values({"mass": 1.05 * MASS}) + SmoothFriction(0.25, 0.03)
    found = fit(start, seen).model
    assert found["smooth_friction"] == pytest.approx(0.4, rel=1e-3)
    assert found["creep_speed"] == pytest.approx(0.01, rel=1e-3)
    assert found.mass == pytest.approx(MASS, rel=1e-3)


@pytest.mark.parametrize(("creep", "named"), [(0.05, "smooth_friction"), (2e-4, "coulomb_friction")])
def test_a_joint_that_creeps_has_no_second_mass_and_no_fading_damping(
    creep: float, named: str, asking_about: Callable[..., None]
) -> None:
    """Friction of a physics engine, Fc·tanh(v/vc), had a second mass with 99 %. Where vc is unseen, it is Coulomb's."""
    asking_about("coulomb_friction", "smooth_friction", "stribeck_friction", "fading_damping", "rubbing_second_mode")
    pushed = record(rate=500.0, duration=3.0)
    moved = with_friction(pushed, 0.4, creep)
    noise = np.random.default_rng(3).normal(0.0, 1e-3 * float(np.std(moved)), moved.size)
    found = pipeline.diagnose([replace(pushed, position=moved + noise)])
    assert [cause.name for cause in found.causes] == [named]
    assert found.causes[0].probability > 0.8
    assert found.extended.model["mass"] == pytest.approx(MASS, rel=2e-3)
