"""Dry friction that changes with time, against scipy, and found in a record."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import MASS, STIFFNESS, plant, record
from frictionrigs import rubbing

from msd_ident.data.record import from_samples
from msd_ident.model import Simulator
from msd_ident.model.effects import Effect
from msd_ident.model.effects.friction_drift import FrictionDrift
from msd_ident.model.effects.settling_friction import SettlingFriction
from msd_ident.workflow import pipeline

LAWS = {
    "drift": (FrictionDrift(0.4, -0.3), lambda t, x: 0.4 * max(1.0 - 0.3 * t, 0.0)),
    "gone": (FrictionDrift(0.4, -0.8), lambda t, x: 0.4 * max(1.0 - 0.8 * t, 0.0)),
    "settles": (SettlingFriction(0.2, 2.0, 0.4), lambda t, x: 0.2 * (1.0 + 2.0 * math.exp(-t / 0.4))),
}


@pytest.mark.parametrize("name", LAWS)
def test_against_scipy(name: str) -> None:
    effect, friction = LAWS[name]
    measured = record(rate=250.0, duration=2.0)
    model = plant() + effect
    found = Simulator(model, measured).positions(model.values)
    expected = rubbing(measured, friction, 1e5)
    assert np.max(np.abs(found - expected)) < 2e-4 * np.ptp(expected)


def test_a_held_cart_breaks_away_when_the_friction_no_longer_holds_it() -> None:
    """The force does not change; 1.2 N are held until the friction of 2 N has fallen to that."""
    time = np.arange(1001) / 250.0
    measured = from_samples(time, np.full(time.size, 1.2), np.zeros(time.size))
    model = plant() + FrictionDrift(2.0, -0.2)
    moved = Simulator(model, measured).positions(model.values)
    begins = time[np.flatnonzero(moved != 0.0)[0]]
    assert begins == pytest.approx(2.0, abs=1.1 / 250.0)


@pytest.mark.parametrize("settles", [False, True])
def test_it_is_found(settles: bool, asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "friction_drift", "settling_friction", "position_dependent_friction")
    time = np.arange(2000) / 250.0
    random = np.random.default_rng(8)
    force = random.uniform(-8.0, 8.0, 16)[np.arange(time.size) // 125]
    measured = from_samples(time, force, np.zeros(time.size))
    truth: Effect = SettlingFriction(0.3, 1.5, 2.0) if settles else FrictionDrift(0.6, -0.08)
    friction = (
        (lambda t, x: 0.3 * (1.0 + 1.5 * math.exp(-t / 2.0))) if settles else (lambda t, x: 0.6 * (1.0 - 0.08 * t))
    )
    readings = rubbing(measured, friction, 1e4) + random.normal(0.0, 1e-5, time.size)
    found = pipeline.diagnose([from_samples(time, force, readings)])
    assert [cause.name for cause in found.causes] == [truth.name]
    model = found.extended.model
    assert (model["mass"], model["stiffness"]) == pytest.approx((MASS, STIFFNESS), rel=5e-3)
    for parameter, value in zip(truth.parameters, truth.values, strict=True):
        assert model[parameter.name] == pytest.approx(value, rel=0.15), parameter.name
