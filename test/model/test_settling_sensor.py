"""A reading that drifts and settles: over one decay a spring that relaxes moves alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from effect_examples import MASS, STIFFNESS, plant

from msd_ident.data.record import Record
from msd_ident.model import simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.relaxing_spring import RelaxingSpring
from msd_ident.model.effects.second_mode import SecondMode
from msd_ident.model.effects.sensor_drift import SensorDrift
from msd_ident.model.effects.settling_sensor import SettlingSensor
from msd_ident.workflow import pipeline

#: How far the cart is pulled out [m], the relaxing spring's stiffness [N/m] and its time [s].
PULLED, BEHIND, TIME = 0.02, 0.05 * STIFFNESS, 1.5


def decay(seconds: float = 6.0) -> Record:
    time = np.arange(round(1000.0 * seconds)) / 1000.0
    return Record(time, 0.0 * time, np.zeros(1), np.zeros(1))


def test_in_the_place_of_a_relaxing_spring_it_gives_the_motion_of_a_decay() -> None:
    model = plant() + RelaxingSpring(BEHIND * TIME, TIME)
    expected = simulate(model, decay(), PULLED, 0.0).position
    found = SettlingSensor.in_place_of(model.effect("relaxing_spring"), model)
    assert found is not None and found.stiffness == pytest.approx(STIFFNESS + BEHIND)
    way = PULLED * BEHIND / found.stiffness  # how far the place of rest moves
    # what the relaxing damper takes out of a swing far quicker than it relaxes
    damping = model.damping + BEHIND / (TIME * found.stiffness / MASS)
    settling = found.with_values({"sensor_settling": -way, "damping": damping})
    time = found["sensor_settling_time"]
    reading = way + simulate(settling, decay(), PULLED - way, way / time).position
    assert np.max(np.abs(reading - expected)) < 1e-3 * PULLED
    without = simulate(plant(), decay(), PULLED, 0.0).position
    assert np.max(np.abs(without - expected)) > 0.02 * PULLED


def test_it_stands_for_no_other_law_and_for_no_spring_beside_none() -> None:
    model = plant() + RelaxingSpring(1.0, 0.5) + CoulombFriction(0.1)
    assert SettlingSensor.in_place_of(model.effect("coulomb_friction"), model) is None
    loose = replace(model, stiffness=0.0)
    assert SettlingSensor.in_place_of(loose.effect("relaxing_spring"), loose) is None


def test_it_takes_the_place_of_a_steady_drift_too() -> None:
    model = plant() + RelaxingSpring(1.0, 0.5) + SensorDrift(1e-4)
    found = SettlingSensor.in_place_of(model.effect("relaxing_spring"), model)
    assert found is not None and found.effect_names == ("settling_sensor",)
    second = plant() + SettlingSensor(1e-3, 0.5) + SecondMode(0.2, 800.0)
    assert RelaxingSpring.in_place_of(second.effect("settling_sensor"), second) is None  # one second state at most
    assert RelaxingSpring.moving_as(second.effect("settling_sensor"), second) is None


#: What moves the place of rest of a decay, and what shortens its swings.
ASKED = ("settling_sensor", "relaxing_spring", "sensor_drift", "stiffness_drift", "coulomb_friction", "second_mode")


@pytest.mark.usefixtures("without_copies")
def test_over_one_decay_a_sensor_that_settles_is_not_surely_a_relaxing_spring(
    asking_about: Callable[..., None],
) -> None:
    """No decay tells: neither is certain, and the interval of k/m holds the plant."""
    asking_about(*ASKED)
    settling = plant() + SettlingSensor(-4e-4, 1.2)
    released = decay(4.0)
    noise = np.random.default_rng(3).normal(0.0, 5e-6, released.samples)
    read = replace(released, position=simulate(settling, released, PULLED, 0.0).position + noise)
    found = pipeline.diagnose([read])
    assert [cause.name for cause in found.causes] == ["settling_sensor"] and found.causes[0].probability <= 0.5
    assert found.causes[0].tied_with == ("relaxing_spring",)
    assert "relaxing_spring" in {name for rival in found.rivals for name in rival.causes}
    stiffness = found.extended.quantities["stiffness"]
    assert abs(stiffness.value / STIFFNESS * MASS - 1.0) < 2.0 * stiffness.std / stiffness.value + 1e-4


@pytest.mark.usefixtures("without_copies")
def test_a_sensor_that_settles_the_other_way_is_no_relaxing_spring(asking_about: Callable[..., None]) -> None:
    """A spring that relaxes draws the place of rest to where the cart was held, never beyond the other side."""
    asking_about(*ASKED)
    settling = plant() + SettlingSensor(4e-4, 1.2)
    released = decay(4.0)
    noise = np.random.default_rng(3).normal(0.0, 5e-6, released.samples)
    read = replace(released, position=simulate(settling, released, PULLED, 0.0).position + noise)
    found = pipeline.diagnose([read])
    assert [cause.name for cause in found.causes] == ["settling_sensor"] and not found.causes[0].tied_with
    assert found.causes[0].probability > 0.5
