"""The motion that a cause would give a cart at rest."""

from __future__ import annotations

import numpy as np
import pytest
from effect_examples import EXAMPLES, model
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import from_samples
from msd_ident.model import Plant, Simulator
from msd_ident.model.effects import by_name
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.residuals.noise_model import Readings, of_record
from msd_ident.residuals.rest_response import chi

PLANT, NOISE = Plant(1.0, 4.0, 400.0), 1e-5
TIME = np.arange(800) / 400.0


def resting(motion: np.ndarray | float = 0.0) -> Readings:
    """Readings of a cart that should rest."""
    noise = NOISE * np.random.default_rng(3).standard_normal(TIME.size)
    return of_record(from_samples(TIME, np.zeros(TIME.size), 0.07 + motion + noise), NOISE)


@pytest.mark.parametrize("name", [name for name in sorted(EXAMPLES) if by_name(name).steady])
def test_what_does_not_act_by_itself_moves_nothing(name: str) -> None:
    assert chi(model(name), resting()) == 0.0


@settings(max_examples=20)
@given(st.floats(0.01, 1.0), st.floats(5.0, 60.0), st.floats(-3.0, 3.0))
def test_a_disturbance_that_is_not_seen_counts_with_its_motion(
    amplitude: float, frequency: float, phase: float
) -> None:
    disturbed = PLANT + PeriodicDisturbance(amplitude, frequency, phase)
    moved = Simulator(disturbed, resting().record).positions(disturbed.values)
    expected = float(np.sum((moved - moved.mean()) ** 2)) / NOISE**2
    found = chi(disturbed, resting())
    assert abs(found - expected) < 6.0 * np.sqrt(expected)  # the noise along the motion
    lean = disturbed + ForceOffset(3.0)
    assert chi(lean, resting()) == pytest.approx(found, rel=1e-6), "a constant force only shifts the balance"


def test_a_disturbance_that_is_seen_at_rest_does_not_count() -> None:
    disturbed = PLANT + PeriodicDisturbance(0.05, 25.0, 0.4)
    moved = Simulator(disturbed, resting().record).positions(disturbed.values)
    assert chi(disturbed, resting(moved)) == 0.0
    assert chi(disturbed, resting()) > 1e3


def test_friction_that_holds_the_cart_holds_it_at_rest_too() -> None:
    pushed = PLANT + PeriodicDisturbance(0.2, 25.0, 0.4)
    assert chi(pushed, resting()) > 1e3
    assert chi(pushed + CoulombFriction(0.5), resting()) < 1.0
