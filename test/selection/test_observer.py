"""Fits through observers: from a wrong start to the truth where a cart sticks, and records whose force pulls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import LARGEST, Record, from_samples
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.drive_damping import DriveDamping
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.load_dependent_friction import LoadDependentFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.sensor_drift import SensorDrift
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.time_offset import TimeOffset
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.observer import _OBSERVERS, _frequency, _held, _pulled, _strength, can_follow, followed
from msd_sim import api

PEAK = frozenset({"stribeck_friction"})
PLANT = Plant(0.6, 1.0, 830.0)


@pytest.fixture(scope="module")
def sticking() -> Experiment:
    """A breakaway friction of four times the sliding one that is gone at 17 mm/s: the cart sticks at most turns."""
    made = api.simulate(
        {
            "mass": 0.6014, "damping": 1.126, "stiffness": 827.5, "friction_coefficient": 0.0, "rate": 1000.0,
            "effects": {"stribeck_friction": {
                "coulomb_force": 0.5, "static_force": 2.2, "stribeck_velocity": 0.0174}},
            "encoder": {"counts_per_metre": 0.0, "noise": 1.1e-5}, "seed": 7,
            "experiment": {"name": "steps", "force": 7.5, "hold": 0.75},
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), PLANT, frozenset())


def floors(experiment: Experiment, chi: float) -> float:
    return float(np.sqrt(chi / experiment.evidence))


def guesses(experiment: Experiment) -> list[Model]:
    return [PLANT + law for law in StribeckFriction.guess(experiment.records[0], PLANT)]


def test_observers_lead_to_a_breakaway_friction_that_no_start_finds(sticking: Experiment) -> None:
    still = [Initial(0.0, 0.0, float(sticking.records[0].position[0]))]
    alone = [refine(sticking, PEAK, model, still) for model in guesses(sticking)]
    assert min(floors(sticking, one.chi) for one in alone) > 10.0, "else this rig is no test of observers"
    found = followed(sticking, PEAK, guesses(sticking), still)
    assert floors(sticking, found.chi) < 1.1
    assert found.model["static_force"] == pytest.approx(2.2, rel=0.02)
    assert found.model["coulomb_force"] == pytest.approx(0.5, rel=0.02)
    assert found.model["stribeck_velocity"] == pytest.approx(0.0174, rel=0.05)
    assert found.model.mass == pytest.approx(0.6014, rel=0.002)


@pytest.mark.parametrize(
    ("model", "may"),
    [
        (PLANT, False),  # nothing sticks
        (PLANT + QuadraticDrag(1.0), False),
        (PLANT + CoulombFriction(0.0), False),
        (PLANT + CoulombFriction(1.0), True),
        (PLANT + CoulombFriction(1.0) + QuadraticDrag(1.0), True),
        (PLANT + CoulombFriction(1.0) + TimeOffset(0.01), False),  # it would delay the observer's pull
        (PLANT + CoulombFriction(1.0) + SensorDrift(0.01), False),  # the readings are not the cart's place
        (PLANT + LoadDependentFriction(1.0, 0.1), False),  # the observer's spring would load it
        (PLANT + CoulombFriction(1.0) + DriveDamping(1.0), False),  # an observer would count as a drive that is on
    ],
)
def test_only_a_cart_that_sticks_and_is_read_as_it_is_can_be_followed(model: Model, may: bool) -> None:
    assert can_follow(model) is may


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("encoder_zero", [0.0, 0.3])
@pytest.mark.parametrize("plant", [PLANT, Plant(0.6, 1.0, 0.0)], ids=["sprung", "axis"])
@pytest.mark.parametrize("begin", [0.0, 0.5])
def test_an_observer_does_not_pull_a_model_that_is_right(
    hold: str, encoder_zero: float, plant: Model, begin: float
) -> None:
    """The pulled cart follows the readings to a thousandth, with a held force and a linear one, from its start or
    later, with a spring and without.
    """
    time = np.arange(0.0, 6.0, 1e-3)
    force = 5.0 * np.sign(np.cos(4.0 * time)) if hold == "zero" else 5.0 * np.cos(9.0 * time)
    acts = time >= begin
    bare = Record(time, np.zeros(time.size), time[acts], force[acts], hold=hold)  # type: ignore[arg-type]
    moved = simulate(plant, bare).position
    read = replace(bare, position=moved + encoder_zero)
    data = Experiment(prepare([read]), plant, frozenset())
    for observer in _OBSERVERS:
        frequency = _frequency(data)
        spring, damper = _strength(plant.mass, frequency, observer)
        pulled = _pulled(read, encoder_zero, spring, damper, frequency)
        left = simulate(_held(plant, spring, damper), pulled).position - moved
        assert np.max(np.abs(left)) < 1e-3 * np.ptp(moved)


def test_an_axis_is_followed_at_the_pace_of_its_motion_however_long_it_is_recorded() -> None:
    time = np.arange(0.0, 60.0, 5e-3)
    force = np.sin(4.4 * time) + np.sin(12.0 * time)
    read = simulate(Plant(0.6, 1.0, 0.0), Record(time, np.zeros(time.size), time, force)).position
    data = Experiment(prepare([Record(time, read, time, force)]), Plant(0.6, 1.0, 0.0), frozenset({"stiffness"}))
    assert 3.0 < _frequency(data) < 15.0


def test_a_force_beyond_all_sizes_ends_no_search() -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    force = 9e19 * np.sign(np.sin(4.0 * time))
    plant = Plant(6e18, 1e19, 8.3e21)
    record = Record(time, simulate(plant, Record(time, np.zeros(time.size), time, force)).position, time, force)
    pulled = _pulled(record, 0.0, 8.3e22, 1e21, 37.0)
    assert np.max(np.abs(pulled.force)) == LARGEST


def test_a_model_without_its_observer_is_what_it_was_and_never_less_than_nothing() -> None:
    with_both = _held(PLANT, 100.0, 2.0)
    assert (with_both.stiffness, with_both.damping) == (930.0, 3.0)
    back = _held(with_both, -100.0, -2.0)
    assert (back.mass, back.damping, back.stiffness) == (0.6, 1.0, 830.0)
    assert _held(PLANT, -1000.0, -2.0).stiffness == 0.0 and _held(PLANT, -1000.0, -2.0).damping == 0.0


def test_an_end_that_leaves_more_than_a_still_cart_is_not_refined(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a motion by hand an observer ended at a hysteresis of 2.5e7 N on 5 g: simulated step by tiny step, 5 s."""
    record = from_samples(0.02 * np.arange(200), np.zeros(200), 0.01 * np.sin(0.1 * np.arange(200)))
    experiment = Experiment(prepare([record]), Plant(1.0, 1.0, 10.0), frozenset())
    wild = Plant(5e-3, 1e4, 0.0) + Hysteresis(2.5e7, 1e-6)
    monkeypatch.setattr("msd_ident.selection.observer._drawn", lambda *given: (0.0, (wild, (Initial(0.0, 50.0, 0.0),))))
    assert followed(experiment, frozenset({"hysteresis"}), [wild], (Initial(0.0, 50.0, 0.0),)) is None
