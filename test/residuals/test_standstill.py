"""What a model moves while the cart stands still."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import from_samples
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.residuals.noise_model import Readings, of_record
from msd_ident.residuals.standstill import chi

RATE, STEP = 400.0, 1e-5
NOISE = STEP / np.sqrt(12.0)
PLANT = Plant(1.0, 4.0, 400.0)
TIME = np.arange(2400) / RATE
STOP = 800


def stopping(flicker: float = 0.0) -> Readings:
    """A swing of 20 mm that stands still from two seconds on, read by an encoder."""
    moving = 0.02 * np.cos(20.0 * TIME) * np.where(TIME[STOP] > TIME, 1.0, 0.0)
    noise = flicker * np.random.default_rng(3).standard_normal(TIME.size)
    return of_record(from_samples(TIME, np.zeros(TIME.size), np.round((moving + noise) / STEP) * STEP), NOISE, STEP)


def swinging(readings: Readings, amplitude: float, until: float = 0.0) -> np.ndarray:
    """Residual of a model that swings on, off the readings by ``until`` before the standstill."""
    off = np.where(TIME[STOP] > TIME, until, amplitude * np.cos(20.0 * TIME))
    return readings.root * off


def test_a_run_of_readings_is_a_standstill_if_it_outlasts_half_a_swing() -> None:
    ((first, behind),) = stopping().standstills
    assert (first, behind) == (STOP, TIME.size), "the turns of the swing are none"
    assert not stopping(flicker=STEP).standstills, "noise that dithers the encoder leaves no runs"


@settings(max_examples=20)
@given(st.floats(1e-4, 1e-2), st.floats(-0.1, 0.1))
def test_a_swing_counts_by_its_variance_and_nothing_else_does(amplitude: float, until: float) -> None:
    readings = stopping()
    expected = 0.5 * (amplitude / NOISE) ** 2
    assert chi(swinging(readings, amplitude, until), readings, PLANT) == pytest.approx(expected, rel=0.02)
    assert chi(readings.root * until, readings, PLANT) == 0.0, "standing somewhere else is not moving"
    assert chi(swinging(readings, 2.0 * NOISE), readings, PLANT) == 0.0, "nor is what rounding hides"


@settings(max_examples=20)
@given(st.floats(1.0, 50.0), st.floats(3.0, 40.0), st.floats(0.0, 0.1), st.floats(-0.5, 0.5))
def test_the_true_motion_does_not_count_however_coarse_the_encoder(
    steps: float, rate: float, ratio: float, zero: float
) -> None:
    motion = STEP * (zero + steps * np.cos(rate * TIME) * np.exp(-ratio * rate * TIME))
    read = np.round(motion / STEP) * STEP
    readings = of_record(from_samples(TIME, np.zeros(TIME.size), read), NOISE, STEP)
    assert chi(readings.root * (motion - read), readings, PLANT) == 0.0


def test_friction_accounts_for_a_standstill_as_far_as_it_holds() -> None:
    readings, amplitude = stopping(), 1e-3
    moved = swinging(readings, amplitude)
    whole = chi(moved, readings, PLANT)
    holding = 400.0 * amplitude
    assert chi(moved, readings, PLANT + CoulombFriction(1.01 * holding)) == 0.0
    assert 0.0 < chi(moved, readings, PLANT + CoulombFriction(0.5 * holding)) < 0.5 * whole
    free = Plant(1.0, 4.0, 0.0)
    assert chi(moved, readings, free + CoulombFriction(1e-6)) == 0.0, "without a spring nothing pulls"
    assert chi(moved, readings, free) == whole
