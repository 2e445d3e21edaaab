"""Motions that no simulation follows from the first sample on: told, and cut into stretches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.gravity import Gravity
from msd_ident.workflow import pipeline, unstable_motion
from msd_ident.workflow.unstable_motion import growth, stretches, transitions

MASS, DAMPING, WEIGHT, PERIOD = 0.15, 0.02, 2.8, 2e-3
JOINT = Plant(MASS, DAMPING, 0.0) + Gravity(WEIGHT)


@cache
def held_upright(seconds: float, seed: int = 1) -> Record:
    """A pendulum that is swung up and held over its axis by a controller, and pushed by small random torques, which
    nobody records.
    """
    rng = np.random.default_rng(seed)
    angle, speed = 0.0, 0.0
    angles, torques = [], []
    for i in range(round(seconds / PERIOD)):
        wanted = 3.4 if i * PERIOD < 1.0 else -25.0 * (angle - math.pi) - 3.0 * speed
        torque = min(max(wanted, -4.0), 4.0)
        angles.append(angle)
        torques.append(torque)
        push = 0.3 * rng.standard_normal()
        for _ in range(4):
            speed += (torque + push - WEIGHT * math.sin(angle) - DAMPING * speed) / MASS * PERIOD / 4.0
            angle += speed * PERIOD / 4.0
    time = np.arange(len(angles)) * PERIOD
    record = from_samples(time, np.array(torques), np.round(np.array(angles) / 1e-3) * 1e-3)
    return replace(record, position_unit="rad", force_unit="N·m")


def fitted(model: Model, *starts: Initial) -> Any:
    """A fit as far as it is asked about."""
    return SimpleNamespace(model=model, initial=starts)


def test_a_deviation_grows_as_the_linear_theory_says() -> None:
    """x'' = (G/I) x about the upright place: a deviation grows as e^(rate·t)."""
    rate, time = math.sqrt(WEIGHT / MASS), np.arange(0.0, 1.2, PERIOD)
    model = Plant(MASS, 0.0, 0.0) + Gravity(WEIGHT)
    still = replace(from_samples(time, np.zeros(time.size), np.zeros(time.size)), position_unit="rad")
    record = replace(still, position=simulate(model, still, math.pi - 1e-4).position)
    pieces = [record.window(0.3 * i, 0.3 * (i + 1)) for i in range(4)]
    found = growth(transitions(model, pieces, 0.0))
    assert 0.5 * math.exp(rate * record.duration) < found < 2.0 * math.exp(rate * record.duration)


@pytest.mark.parametrize("model", [Plant(1.0, 2.0, 400.0), Plant(1.0, 2.0, 400.0) + CoulombFriction(0.2)])
def test_a_stable_rig_forgets_its_start(model: Model) -> None:
    time = np.arange(0.0, 4.0, PERIOD)
    record = from_samples(time, np.sign(np.sin(3.0 * time)), np.zeros(time.size))
    record = replace(record, position=simulate(model, record).position)
    assert stretches(fitted(model, Initial()), [record]) is None


def test_a_record_in_which_nothing_moves_has_no_growth() -> None:
    time = np.arange(0.0, 1.0, PERIOD)
    still = from_samples(time, np.zeros(time.size), np.zeros(time.size))
    assert growth(transitions(Plant(1.0, 1.0, 0.0), [still], 0.0)) == 1.0
    assert stretches(fitted(Plant(1.0, 1.0, 0.0), Initial()), [still]) is None


def test_a_joint_that_is_held_upright_is_cut_where_it_moves() -> None:
    record = held_upright(6.0)
    found = stretches(fitted(JOINT, Initial()), [record])
    assert found is not None and len(found.records) > 3
    assert f"cut into {len(found.records)} stretches," in found.said and record.name in found.said
    for part in found.records:
        assert part.origin == record.origin and part.hold_known
        first = int(np.searchsorted(record.time, part.time[0]))
        np.testing.assert_array_equal(part.position, record.position[first : first + part.samples])
        np.testing.assert_array_equal(part.force_at(part.time), record.force_at(part.time))
        assert np.ptp(part.position) > 2e-3, "no stretch in which only the last digit changes"


@pytest.mark.parametrize("samples", [20, 39, 41, 500, 1000, 5000])
def test_a_stretch_of_each_piece_has_samples_enough_for_a_record(samples: int) -> None:
    time = np.arange(samples) * PERIOD
    record = from_samples(time, np.sin(time), np.cos(time))
    pieces = unstable_motion._pieces(record)
    parts = unstable_motion._parts(record, pieces, range(len(pieces)))
    np.testing.assert_array_equal(np.concatenate([part.time for part in parts]), time)


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
def test_its_weight_is_found_and_nothing_is_certain(seed: int, asking_about: Callable[..., None]) -> None:
    """Of the whole record a tone, a force offset and friction that settles were certain; the inertia was 20 % off."""
    asking_about("gravity", "periodic_disturbance")
    found = pipeline.diagnose([held_upright(10.0, seed)])
    assert "gravity" in [cause.name for cause in found.causes]
    assert all(cause.probability < 0.9 + 1e-6 for cause in found.causes)
    assert found.extended.model["gravity_moment"] == pytest.approx(WEIGHT, rel=0.02)
    assert found.extended.model.mass == pytest.approx(MASS, rel=0.02)
    assert len(found.records) > 3 and "is unstable" in found.warnings[0]
    assert any("which friction also does: no cause is certain" in said for said in found.warnings)
