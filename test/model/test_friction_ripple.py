"""Dry friction that repeats along the travel: against scipy, and found in a record."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import MASS, STIFFNESS, plant, record
from frictionrigs import rubbing

from msd_ident.data.record import from_samples
from msd_ident.model import Simulator
from msd_ident.model.effects.friction_ripple import FrictionRipple
from msd_ident.workflow import pipeline


def friction(law: FrictionRipple) -> Callable[[float, float], float]:
    """The law's friction [N] over time and place, written once more."""
    fc, ripple, pitch, phase = law.values
    return lambda t, x: fc * max(1.0 + ripple * math.sin(2.0 * math.pi * x / pitch + phase), 0.0)


@pytest.mark.parametrize("values", [(0.3, 0.5, 0.012, 0.4), (0.4, 1.5, 0.02, -1.0)], ids=["part", "gone at places"])
def test_against_scipy(values: tuple[float, ...]) -> None:
    law = FrictionRipple(*values)
    measured = record(rate=250.0, duration=2.0)
    model = plant() + law
    found = Simulator(model, measured).positions(model.values)
    expected = rubbing(measured, friction(law), 1e5)
    assert np.max(np.abs(found - expected)) < 2e-4 * np.ptp(expected)


def test_it_holds_where_it_is_strong() -> None:
    """A cart at rest at the crest of the friction stays; at its foot the same force moves it."""
    time = np.arange(250) / 250.0
    pushed = from_samples(time, np.full(time.size, 0.5), np.zeros(time.size))
    for phase, moves in ((0.5 * math.pi, False), (-0.5 * math.pi, True)):
        model = plant() + FrictionRipple(0.4, 0.5, 0.02, phase)
        assert bool(np.any(Simulator(model, pushed).positions(model.values))) is moves


def test_it_is_found(asking_about: Callable[..., None]) -> None:
    asking_about("friction_ripple", "coulomb_friction", "position_dependent_friction", "smooth_friction", "cogging")
    time = np.arange(3000) / 500.0
    random = np.random.default_rng(8)
    force = random.uniform(-8.0, 8.0, 16)[np.arange(time.size) // 250]
    measured = from_samples(time, force, np.zeros(time.size))
    truth = FrictionRipple(0.5, 0.4, 0.011, 0.8)
    readings = rubbing(measured, friction(truth), 1e4) + random.normal(0.0, 1e-5, time.size)
    found = pipeline.diagnose([from_samples(time, force, readings)])
    assert [cause.name for cause in found.causes] == ["friction_ripple"] and found.causes[0].probability > 0.9
    model = found.extended.model
    assert (model["mass"], model["stiffness"]) == pytest.approx((MASS, STIFFNESS), rel=5e-3)
    for parameter, value in zip(truth.parameters[:3], truth.values[:3], strict=True):
        assert model[parameter.name] == pytest.approx(value, rel=0.05), parameter.name
