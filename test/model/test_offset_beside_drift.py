"""A constant force beside a stiffness that drifts, and a sensor that drifts beside it: each is begun from the other."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Model, Simulator
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.sensor_drift import SensorDrift
from msd_ident.model.effects.stiffness_drift import StiffnessDrift

AGING = StiffnessDrift(-0.01)
PLANT = Model(1.0, 20.0, 400.0) + AGING


def slow() -> Record:
    """The spring is pushed slowly, in 8 s, from nothing to 2 N and back; the cart begins where it rests."""
    time = np.arange(1601) / 200.0
    return from_samples(time, 2.0 * np.sin(np.pi * time / 8.0), np.zeros(time.size))


def readings(model: Model, rest: float) -> np.ndarray:
    """Positions of a cart that begins at rest there [m], as the sensor reads them."""
    made = Simulator(model, slow())
    return np.asarray(made.positions(model.values, rest, 0.0))


@pytest.mark.parametrize("force", [1.5, -0.8])
def test_each_moves_slowly_as_the_other(force: float) -> None:
    pushed = PLANT + ForceOffset(force)
    drifting = SensorDrift.in_place_of(ForceOffset(force), pushed)
    assert drifting is not None and set(drifting.effect_names) == {"stiffness_drift", "sensor_drift"}
    shift = SensorDrift(0.0).zero_in(pushed)
    assert shift == pytest.approx(-force / 400.0)
    one, other = readings(pushed, -force / 400.0), readings(drifting, 0.0) + shift
    moved = np.ptp(one - one[0])
    assert np.max(np.abs(one - other)) < 0.02 * abs(force) / 400.0 < 0.02 * moved
    assert np.max(np.abs(one - readings(PLANT, 0.0) - shift)) > 0.05 * abs(force) / 400.0, "a shift alone is not enough"
    back = ForceOffset.in_place_of(drifting.effect("sensor_drift"), drifting)
    assert back is not None and back["offset_force"] == pytest.approx(force)
    assert ForceOffset(0.0).zero_in(drifting) == pytest.approx(-shift)


def test_without_a_drift_of_the_stiffness_neither_stands_for_the_other() -> None:
    plain = Model(1.0, 20.0, 400.0)
    assert ForceOffset.in_place_of(SensorDrift(1e-4), plain + SensorDrift(1e-4)) is None
    assert SensorDrift.in_place_of(ForceOffset(1.0), plain + ForceOffset(1.0)) is None
    assert ForceOffset(1.0).zero_in(plain + AGING) == 0.0 == SensorDrift(1.0).zero_in(plain + AGING)
