"""Drifts of the force's gain and of the sensor's scale, and a bent sensor: against the rig, and beside each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_examples import DAMPING, EXAMPLES, MASS, STIFFNESS, example, model, plant, record

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import fit
from msd_ident.estimate.resolution import ranges
from msd_ident.model import simulate
from msd_ident.model.effects import by_name
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_sim.rig import Rig
from msd_sim.truth import Truth

LAWS = ("gain_drift", "scale_drift", "sensor_nonlinearity")


def rig_readings(name: str, measured: Record) -> FloatArray:
    """What the sensor of the rig says."""
    truth = Truth(MASS, DAMPING, STIFFNESS, {name: EXAMPLES[name]})
    rig = Rig(truth, 0.0, 0.0, float(measured.time[0]), measured.hold)
    rig.drive(measured.force_time, measured.force)
    motion = rig.sample(measured.time)
    return truth.sensed(motion.time, motion.position)


@pytest.mark.parametrize(("hold", "agree"), [("zero", 1e-6), ("linear", 1e-5)])
@pytest.mark.parametrize("name", LAWS)
def test_the_rig_agrees(name: str, hold: str, agree: float) -> None:
    """Between two samples of a force with straight lines the solver has a line too, the rig its product with time."""
    measured = record(1000.0, hold)  # type: ignore[arg-type]
    theirs = rig_readings(name, measured)
    assert np.max(np.abs(simulate(model(name), measured).position - theirs)) <= agree * np.max(np.abs(theirs))


def steps() -> Record:
    """A force that is held for long at four levels, whose few stamps lie between the samples."""
    time = np.arange(4000) / 500.0
    stamps, force = np.array([0.0011, 2.0003, 4.0007, 5.9999]), np.array([8.0, -4.0, 3.0, 0.0])
    return Record(time, 0.0 * time, stamps, force)


@pytest.mark.parametrize("name", LAWS)
def test_it_is_found_again(name: str) -> None:
    measured = steps()
    noise = 1e-5 * np.random.default_rng(1).standard_normal(measured.samples)
    seen = replace(measured, position=rig_readings(name, measured) + noise)
    wrong = plant().with_values({"mass": 1.0, "damping": 3.0, "stiffness": 680.0})
    found = fit(wrong + by_name(name).guess(seen, plant())[0], [seen]).model
    for parameter, value in {"mass": MASS, "damping": DAMPING, "stiffness": STIFFNESS, **EXAMPLES[name]}.items():
        assert found[parameter] == pytest.approx(value, rel=0.02), parameter


def test_the_gain_drifts_while_one_command_is_held() -> None:
    """And behind a lag."""
    measured = steps()
    calm = {"damping": 30.0}
    seen = simulate(model("gain_drift").with_values(calm), measured).position
    late = (measured.time > 1.8) & (measured.time < 2.0)
    assert STIFFNESS * np.mean(seen[late]) == pytest.approx(8.0 * (1.0 + 0.02 * 1.9), rel=2e-3)
    lagged = simulate(model("gain_drift", "actuator_lag").with_values(calm), measured).position
    assert STIFFNESS * np.mean(lagged[late]) == pytest.approx(8.0 * (1.0 + 0.02 * 1.9), rel=2e-3)


def test_an_eccentric_wheel_is_seen_to_repeat() -> None:
    """A bent scale over the whole travel is one turn of a wheel, nearly; of one and a half, half a turn repeats."""
    x = np.linspace(-0.02, 0.02, 2001)
    bent = x + 100.0 * x**3
    wheel = by_name("sensor_eccentricity")
    seen = replace(record(), time=np.arange(x.size) / 100.0, position=bent, force_time=np.zeros(1), force=np.zeros(1))
    _, longest = ranges([seen], plant())["eccentricity_pitch"]
    assert 1.5 * longest == pytest.approx(np.ptp(bent))
    assert all(guess.values[1] <= longest for guess in wheel.guess(seen, plant()))
    assert all(start.values[1] <= longest for start in wheel.from_residual(seen, x - bent))


def test_each_law_is_given_what_the_one_before_made() -> None:
    measured = steps()
    x = simulate(plant(), measured).position
    bent, drift = example("sensor_nonlinearity"), example("sensor_drift")
    both = simulate(plant() + bent + drift, measured).position
    shifted = x + drift.values[0] * measured.time
    np.testing.assert_allclose(both, shifted + shifted**2 * (bent.values[0] + bent.values[1] * shifted), atol=1e-12)
    limited = simulate(plant() + ForceGainNonlinearity(0.0, 6.0) + example("gain_drift"), measured).position
    less = replace(measured, force=np.clip(measured.force, -6.0, 6.0))
    np.testing.assert_allclose(limited, simulate(model("gain_drift"), less).position, atol=1e-9)
