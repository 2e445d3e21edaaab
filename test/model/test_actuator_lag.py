"""A lag of the force, and the motor that moves alike."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lsim

from msd_ident.data.record import from_samples
from msd_ident.model import Plant
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.position_dependent_gain import PositionDependentGain
from msd_ident.model.effects.sensor_drift import SensorDrift
from msd_ident.workflow import pipeline

PLANT, LAG = Plant(1.0, 4.0, 400.0), ActuatorLag(0.05)
SAID = "actuator_lag is equivalent to a motor's back-EMF behind its inductance, where a voltage drives it"


@pytest.mark.parametrize("brake", [0.5, 4.0])
def test_a_motor_with_inductance_is_a_lag_and_its_mass_is_within_what_is_said(
    brake: float, asking_about: Callable[..., None]
) -> None:
    asking_about("actuator_lag", "time_offset", "second_mode", "drive_damping", "coulomb_friction")
    mass, damping, stiffness, constant = 0.7, 1.5, 300.0, 0.04  # constant: L/R [s]
    motor = np.polyadd(np.polymul([constant, 1.0], [mass, damping, stiffness]), [brake, 0.0])
    time = np.arange(2000) / 250.0
    force = 6.0 * np.sin(2.0 * np.pi * (0.3 * time + 0.5 * time**2))
    position = lsim(([1.0], motor), force, time)[1]
    position += np.random.default_rng(3).normal(0.0, 2e-5, time.size)

    found = pipeline.diagnose([from_samples(time, force, position, hold="linear")], pipeline.Options(model="spring"))
    assert [cause.name for cause in found.causes] == ["actuator_lag"]
    (said,) = (warning for warning in found.warnings if warning.startswith(SAID))
    more = float(said.split("up to ")[1].split(" %")[0]) / 100.0
    least = found.extended.model["mass"]
    assert 0.995 * least <= mass <= 1.005 * least * (1.0 + more)
    assert found.extended.model["stiffness"] == pytest.approx(stiffness, rel=5e-3)


def test_where_the_two_differ_nothing_is_said() -> None:
    assert LAG.same_as(PLANT + LAG).startswith(f"{SAID}: then the mass is up to 20 % larger")
    for part, words in ((0.2, "3 times as large"), (1e-4, "many times as large")):
        light = PLANT.with_values({"mass": part * 0.5 * PLANT.mass})
        assert f"the mass is up to {words}, and" in LAG.same_as(light + LAG)
    assert LAG.same_as(PLANT + LAG + SensorDrift(1e-4)).startswith(SAID)
    for beside in (CoulombFriction(0.1), PositionDependentGain(1.0, 0.0)):
        said = LAG.same_as(PLANT + LAG + beside)
        assert said.startswith(SAID.replace("equivalent", "nearly equivalent")) and "up to 20 % larger" in said
    assert ActuatorLag(1e-3).same_as(PLANT + ActuatorLag(1e-3)) == ""
