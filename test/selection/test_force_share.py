"""How much of the applied force a fitted set explains."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import Initial
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.gravity import Gravity
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.sensor_eccentricity import SensorEccentricity
from msd_ident.residuals import noise_model
from msd_ident.selection.force_share import explains_force

#: A joint that carries a weight, led along a slow sine, and a heavy mass on a spring that swings as slowly.
JOINT = Plant(1.5, 1.6, 0.0) + CoulombFriction(1.4) + Gravity(10.0)
RATE = 0.6
SWINGING = Plant(600.0, 0.0, 600.0 * RATE**2)


def led(noise: float, seconds: float = 12.0) -> Record:
    """The planned motion about the upright place, read with noise [rad], and the force that a drive gives for it."""
    time = np.arange(0.0, seconds, 0.01)
    angle = math.pi + np.sin(RATE * time)
    speed, acceleration = RATE * np.cos(RATE * time), -(RATE**2) * np.sin(RATE * time)
    force = 1.5 * acceleration + 1.6 * speed + 1.4 * np.sign(speed) + 10.0 * np.sin(angle)
    read = angle + noise * np.random.default_rng(1).standard_normal(time.size)
    return replace(from_samples(time, force, read, hold="linear"), position_unit="rad", force_unit="A")


def fitted(model: Model, record: Record, zero: float = 0.0) -> Any:
    """A set as far as it is asked about."""
    readings = noise_model.prepare((record,))
    return SimpleNamespace(model=model, readings=readings, initial=(Initial(0.0, 0.0, zero),))


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-5])
def test_a_motion_that_needs_no_force_explains_none(noise: float) -> None:
    record = led(noise)
    assert explains_force(fitted(JOINT, record))
    assert not explains_force(fitted(SWINGING, record, math.pi))
    assert not explains_force(fitted(SWINGING + CoulombFriction(1.4), record, math.pi))


def test_noise_of_the_readings_is_no_force() -> None:
    """What noise of 3 mrad makes of the second differences is more than ten times the force."""
    record = led(3e-3)
    assert np.std(np.diff(record.position, 2)) / 1e-4 * 1.5 > 10.0 * np.std(record.force)
    assert explains_force(fitted(JOINT, record))
    assert explains_force(fitted(SWINGING, record, math.pi)), "of a mass of 600 the noise hides everything"


def test_a_part_of_the_weight_is_too_little() -> None:
    record = led(1e-5)
    assert explains_force(fitted(JOINT.without("gravity") + Gravity(7.0), record))
    assert not explains_force(fitted(JOINT.without("gravity"), record))


def test_what_does_not_follow_from_the_motion_is_not_judged() -> None:
    record = led(1e-5)
    memory = SWINGING + Hysteresis(1.0, 0.1)
    assert explains_force(fitted(memory, record, math.pi))
    short = replace(record.window(0.0, 0.2), time=record.window(0.0, 0.2).time)
    assert explains_force(fitted(SWINGING, short, math.pi))


def test_a_simulated_rig_explains_its_own_force() -> None:
    time = np.arange(0.0, 6.0, 0.01)
    still = from_samples(time, np.sign(np.sin(1.7 * time)), np.zeros(time.size))
    rig = Plant(1.0, 0.4, 20.0) + CoulombFriction(0.1)
    record = replace(still, position=simulate(rig, still).position)
    assert explains_force(fitted(rig, record))
    assert not explains_force(fitted(Plant(1.0, 0.4, 60.0) + CoulombFriction(0.1), record))


def test_an_error_of_the_reading_is_no_force() -> None:
    """The wheel's eccentricity ripples the reading; its second derivative times the mass is more than the force."""
    heavy, ripple = replace(JOINT, mass=11.5), SensorEccentricity(2e-3, 0.1, 0.3)
    record = led(0.0)
    force = record.force - 10.0 * RATE**2 * np.sin(RATE * record.time)
    wrong = 2e-3 * np.sin(2.0 * math.pi * record.position / 0.1 + 0.3)
    read = replace(record, position=record.position + wrong, force=force)
    assert explains_force(fitted(heavy + ripple, read)) and not explains_force(fitted(heavy, read))
