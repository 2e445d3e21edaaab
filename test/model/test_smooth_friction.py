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
from msd_ident.model.effects.smooth_friction_turn import SmoothFrictionTurn
from msd_ident.model.effects.smooth_stribeck_friction import SmoothStribeckFriction
from msd_ident.workflow import pipeline

RECORD = record(rate=500.0, duration=1.0)


def following(measured: Record, rubs: Callable[[float], float]) -> np.ndarray:
    """Positions of the plant with this friction [N] at a velocity [m/s], by scipy."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        return [v, (force - DAMPING * v - STIFFNESS * x - rubs(v)) / MASS]

    return followed(slope, measured, states=2, method="LSODA")


def with_friction(measured: Record, size: float, creep: float) -> np.ndarray:
    """Positions of the plant with Fc·tanh(v/vc), by scipy."""
    return following(measured, lambda v: size * np.tanh(v / creep))


def noisy(measured: Record, moved: np.ndarray) -> Record:
    """The record with these positions and noise of a thousandth of their spread."""
    noise = np.random.default_rng(3).normal(0.0, 1e-3 * float(np.std(moved)), moved.size)
    return replace(measured, position=moved + noise)


@pytest.mark.parametrize(("size", "creep"), [(0.5, 0.05), (2.0, 0.002), (0.3, 3e-4)])
def test_the_law_is_the_published_one(size: float, creep: float) -> None:
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + SmoothFriction(size, creep)
    found = Simulator(whole, measured).positions(whole.values)
    expected = with_friction(measured, size, creep)
    assert np.max(np.abs(found - expected)) < 1e-5 * np.ptp(expected)


@pytest.mark.parametrize(("creep", "sharpness"), [(0.05, 1.0), (0.02, 2.0), (0.003, 6.0)])
def test_a_turn_of_another_sharpness_is_the_published_one(creep: float, sharpness: float) -> None:
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + SmoothFrictionTurn(0.5, creep, sharpness)
    found = Simulator(whole, measured).positions(whole.values)
    expected = following(measured, lambda v: 0.5 * v / (abs(v) ** sharpness + creep**sharpness) ** (1.0 / sharpness))
    assert np.max(np.abs(found - expected)) < 1e-5 * np.ptp(expected)


@pytest.mark.parametrize(("peak", "falls", "creep"), [(0.8, 0.05, 0.0035), (0.6, 0.02, 0.02), (0.4, 0.05, 0.01)])
def test_a_peak_is_that_of_block_diagrams(peak: float, falls: float, creep: float) -> None:
    """A breakaway below the sliding friction counts as that."""
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + SmoothStribeckFriction(0.5, peak, falls, creep)

    def rubs(v: float) -> float:
        bump = np.sqrt(2.0 * np.e) * (max(peak, 0.5) - 0.5) * np.exp(-((v / falls) ** 2)) * v / falls
        return float(bump + 0.5 * np.tanh(v / creep))

    found = Simulator(whole, measured).positions(whole.values)
    expected = following(measured, rubs)
    assert np.max(np.abs(found - expected)) < 1e-5 * np.ptp(expected)
    assert SmoothStribeckFriction.force(falls / np.sqrt(2.0), 0.1, 0.5, falls, creep) == pytest.approx(
        0.4 + 0.1 * np.tanh(falls / np.sqrt(2.0) / creep)
    )


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
    measured = record(rate=500.0, duration=1.5)
    truth = plant() + SmoothFriction(0.4, 0.01)
    seen = replace(measured, position=Simulator(truth, measured).positions(truth.values))
    start = plant().with_values({"mass": 1.05 * MASS}) + SmoothFriction(0.25, 0.03)
    found = fit(start, seen).model
    assert found["smooth_friction"] == pytest.approx(0.4, rel=1e-3)
    assert found["creep_speed"] == pytest.approx(0.01, rel=1e-3)
    assert found.mass == pytest.approx(MASS, rel=1e-3)


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize(
    ("creep", "named"),
    [
        (0.05, "smooth_friction"),
        pytest.param(2e-4, "smooth_friction", marks=pytest.mark.long),
        (1e-5, "coulomb_friction"),
    ],
)
def test_a_joint_that_creeps_has_no_second_mass_and_no_fading_damping(
    creep: float, named: str, asking_about: Callable[..., None]
) -> None:
    """Friction of a physics engine, Fc·tanh(v/vc), had a second mass with 99 %. Where vc is unseen, it is Coulomb's."""
    asking_about("coulomb_friction", "smooth_friction", "stribeck_friction", "fading_damping", "rubbing_second_mode")
    pushed = record(rate=500.0, duration=3.0)
    moved = with_friction(pushed, 0.4, creep)
    found = pipeline.diagnose([noisy(pushed, moved)])
    assert [cause.name for cause in found.causes] == [named]
    assert found.causes[0].probability > 0.8
    assert found.extended.model["mass"] == pytest.approx(MASS, rel=2e-3)


ASKED = (
    "coulomb_friction", "smooth_friction", "smooth_friction_turn", "smooth_stribeck_friction", "stribeck_friction",
    "fading_damping", "quadratic_drag",
)  # fmt: skip


def test_friction_of_block_diagrams_is_stribeck_friction(asking_about: Callable[..., None]) -> None:
    """It was fading damping with 99.6 %."""
    asking_about(*ASKED)
    pushed = record(rate=500.0, duration=2.0)
    pushed = replace(pushed, force=np.where(pushed.time > 1.7, 5.0, pushed.force))
    falls = 0.04

    def rubs(v: float) -> float:
        bump = np.sqrt(2.0 * np.e) * 0.3 * np.exp(-((v / falls) ** 2)) * v / falls
        return float(bump + 0.4 * np.tanh(14.14 * v / falls))

    found = pipeline.diagnose([noisy(pushed, following(pushed, rubs))])
    assert [cause.name for cause in found.causes] == ["smooth_stribeck_friction"]
    assert found.causes[0].probability > 0.9
    assert found.causes[0].parameters["peak_friction"].value == pytest.approx(0.7, rel=0.05)


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("turned", [True, False])
def test_friction_that_creeps_in_another_way_is_no_damping(turned: bool, asking_about: Callable[..., None]) -> None:
    """Fc·(1 - exp(-abs(v)/vc)): fading damping came nearest where no other turn is asked about."""
    asking_about(*(name for name in ASKED if turned or name != "smooth_friction_turn"))
    pushed = record(rate=500.0, duration=3.0)
    moved = following(pushed, lambda v: -0.6 * np.sign(v) * np.expm1(-abs(v) / 0.015))
    found = pipeline.diagnose([noisy(pushed, moved)])
    (cause,) = found.causes
    assert cause.name == ("smooth_friction_turn" if turned else "smooth_friction")


@pytest.mark.parametrize(("peak", "same"), [(0.3, True), (0.4, True), (0.5, False)])
def test_without_a_peak_a_smooth_law_takes_the_place_of_one_with_a_peak(peak: float, same: bool) -> None:
    peaked = SmoothStribeckFriction(0.4, peak, 0.02, 2e-4)
    model = plant() + peaked
    found = SmoothFriction.in_place_of(peaked, model)
    assert found is not None and found.effects == (SmoothFriction(0.4, 2e-4),)
    assert SmoothFriction.is_all_of(peaked, model) == same
    apart = [Simulator(one, RECORD).positions(one.values) for one in (model, found)]
    assert np.allclose(*apart, rtol=0.0, atol=1e-9 * np.ptp(apart[0])) == same


def test_it_takes_the_place_of_no_other_law() -> None:
    turn, sharp = SmoothFrictionTurn(0.4, 2e-4, 3.0), CoulombFriction(0.4)
    assert SmoothFriction.in_place_of(turn, plant() + turn) == plant() + SmoothFriction(0.4, 2e-4)
    assert not SmoothFriction.is_all_of(turn, plant() + turn)
    for other in (sharp, SmoothFriction(0.4, 2e-4)):
        assert SmoothFriction.in_place_of(other, plant() + other) is None
        assert not SmoothFriction.is_all_of(other, plant() + other)
