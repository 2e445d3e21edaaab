"""A reading that follows the force, against scipy, and found in a record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, plant, record
from scipy.signal import lsim

from msd_ident.data.record import from_samples
from msd_ident.model import Simulator
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.frame_compliance import FrameCompliance
from msd_ident.model.effects.time_offset import TimeOffset
from msd_ident.workflow import pipeline

GIVES = 1e-4


@pytest.mark.parametrize("others", [(), (CoulombFriction(0.2),)], ids=["exact path", "general path"])
@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_it_adds_the_force_at_each_sample(hold: str, others: tuple[CoulombFriction, ...]) -> None:
    measured = record(rate=500.0, duration=1.5, hold=hold)
    without = plant() + list(others)[0] if others else plant()
    simulated = Simulator(without + FrameCompliance(GIVES), measured)
    bare = Simulator(without, measured)
    added = simulated.positions((without + FrameCompliance(GIVES)).values) - bare.positions(without.values)
    assert added == pytest.approx(GIVES * measured.force_at(measured.time), abs=1e-15)


def test_it_is_the_force_that_arrives() -> None:
    """Behind a lag, late, and with the plant's own constant force left out."""
    measured = record(rate=500.0, duration=1.5)
    lagging = plant() + ActuatorLag(0.05) + TimeOffset(0.01) + ForceOffset(0.3)
    model = lagging + FrameCompliance(GIVES)
    added = Simulator(model, measured).positions(model.values) - Simulator(lagging, measured).positions(lagging.values)
    fine = np.arange(measured.time[0], measured.time[-1] + 1e-5, 1e-5)
    held = np.where(fine - 0.01 < measured.force_time[0], 0.0, measured.force_at(fine - 0.01))
    arrives = lsim(([1.0], [0.05, 1.0]), held, fine, interp=False)[1]
    assert added == pytest.approx(GIVES * np.interp(measured.time, fine, arrives), abs=2e-4 * GIVES * np.ptp(held))


@pytest.mark.parametrize(
    ("experiment", "gives"),
    [
        ("steps", 1.5e-4),
        ("sweep", -6e-5),
        *(pytest.param(*other, marks=pytest.mark.long) for other in (("steps", -6e-5), ("sweep", 1.5e-4))),
    ],
)
def test_it_is_found(experiment: str, gives: float, asking_about: Callable[..., None]) -> None:
    """It was a second mass of which the first was 1 % of the whole, beside a delay with 0.995."""
    asking_about("frame_compliance", "second_mode", "time_offset", "actuator_lag", "coulomb_friction")
    time = np.arange(2000) / 250.0
    random = np.random.default_rng(5)
    force = 6.0 * np.sin(2.0 * np.pi * (0.3 * time + 0.5 * time**2))
    if experiment == "steps":
        force = random.uniform(-6.0, 6.0, 10)[np.arange(time.size) // 200]
    position = lsim(([1.0], [MASS, DAMPING, STIFFNESS]), force, time, interp=experiment == "sweep")[1]
    readings = position + gives * force + random.normal(0.0, 2e-5, time.size)
    hold = "linear" if experiment == "sweep" else "zero"
    found = pipeline.diagnose([from_samples(time, force, readings, hold=hold)])
    assert [cause.name for cause in found.causes] == ["frame_compliance"]
    assert found.causes[0].probability > 0.9
    model = found.extended.model
    assert model["frame_compliance"] == pytest.approx(gives, rel=0.02)
    assert (model["mass"], model["stiffness"]) == pytest.approx((MASS, STIFFNESS), rel=5e-3)


def test_a_decay_has_none() -> None:
    time = np.arange(500) / 250.0
    decay = from_samples(time, np.zeros(500), 0.01 * np.exp(-time) * np.cos(20.0 * time))
    assert not FrameCompliance.fits(decay)


def test_under_a_proportional_controller_it_is_a_scale_of_the_reading() -> None:
    """Of five measured records of such loops it was named with negative values, up to 0.90."""
    time = np.arange(500) / 250.0
    reading = 0.1 * (1.0 - np.exp(-3.0 * time) * np.cos(9.0 * time))
    setpoint = np.where(time < 1.0, 0.1, 0.15)
    assert not FrameCompliance.fits(from_samples(time, 100.0 * (0.1 - reading), reading))
    assert FrameCompliance.fits(from_samples(time, 100.0 * (setpoint - reading), reading)), "the setpoint jumps"
    assert not FrameCompliance.fits(from_samples(time, time, np.zeros(500))), "nothing moves"


def test_steps_of_long_holds_show_it() -> None:
    """A spring brings the cart to F/k, which is no scale of the reading: a frame adds to it in proportion."""
    time = np.arange(4000) / 50.0
    force = np.random.default_rng(2).uniform(-6.0, 6.0, 8)[np.arange(time.size) // 500]
    position = lsim(([1.0], [1.0, 30.0, STIFFNESS]), force, time, interp=False)[1] + 1e-4 * force
    assert np.corrcoef(force, position)[0, 1] ** 2 > 0.99
    assert FrameCompliance.fits(from_samples(time, force, position))
