"""Frequency response: the measured one of a linear rig is that of its equation."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import FloatArray, Record
from msd_ident.model import Plant, frequency_response
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_sim.api import simulate

RIG = {"mass": 1.0, "damping": 4.0, "stiffness": 400.0, "friction_coefficient": 0.0, "rate": 500, "seed": 2}
#: Records that end at rest: otherwise what still swings leaks into all frequencies.
STEPS = {**RIG, "experiment": {"name": "steps", "force": 8.0, "hold": 4.0}}


def record(spec: dict[str, object]) -> Record:
    made = simulate(spec)
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold)


def formula(omega: FloatArray) -> np.ndarray:
    return 1.0 / (400.0 + 4.0j * omega - omega**2)


def test_model_is_the_equation() -> None:
    omega = frequency_response.band(Plant(1.0, 4.0, 400.0))
    found = frequency_response.modelled(Plant(1.0, 4.0, 400.0), omega)
    assert np.allclose(found.magnitude, np.abs(formula(omega)), rtol=1e-9)
    assert np.allclose(found.phase, np.degrees(np.angle(formula(omega))), atol=1e-6)
    late = frequency_response.modelled(Plant(1.0, 4.0, 400.0) + ActuatorLag(0.01), omega)
    assert np.allclose(late.magnitude, found.magnitude / np.hypot(1.0, 0.01 * omega), rtol=1e-9)


def test_measured_steps_follow_the_equation_in_size_and_phase() -> None:
    found = frequency_response.measured([record(STEPS)], frequency_response.band(Plant(1.0, 4.0, 400.0)))
    assert found is not None and found.frequency.size > 15
    calm = np.abs(found.frequency / 20.0 - 1.0) > 0.2  # at resonance a band averages over the peak
    there = formula(found.frequency[calm])
    assert found.magnitude[calm] == pytest.approx(np.abs(there), rel=0.15)
    assert found.phase[calm] == pytest.approx(np.degrees(np.angle(there)), abs=10.0)


def test_without_a_changing_force_there_is_no_response() -> None:
    assert (
        frequency_response.measured(
            [record({**RIG, "experiment": {"name": "release"}})], frequency_response.band(Plant(1, 4, 400))
        )
        is None
    )


def test_a_plain_axis_has_a_band_too() -> None:
    omega = frequency_response.band(Plant(2.0, 4.0, 0.0))
    assert omega[0] < 2.0 < omega[-1] and np.all(
        np.isfinite(frequency_response.modelled(Plant(2.0, 4.0, 0.0), omega).magnitude)
    )
