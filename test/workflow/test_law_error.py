"""Intervals of an identified model that lacks something."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import fit
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.workflow import pipeline
from msd_ident.workflow.law_error import widened

PLANT = Plant(1.0, 3.0, 400.0)


def random_steps(rig: Model, seed: int) -> Record:
    """A rig under random steps, read with noise of 10 µm."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 12.0, 0.004)
    asked = from_samples(time, np.repeat(rng.uniform(-8.0, 8.0, 20), 150), np.zeros(time.size))
    return replace(asked, position=simulate(rig, asked).position + 1e-5 * rng.standard_normal(time.size))


def test_a_model_that_leaves_only_noise_keeps_its_intervals() -> None:
    found = fit(Plant(0.8, 2.0, 300.0) + DryFriction(0.05), [random_steps(PLANT + DryFriction(0.2), 1)])
    assert widened(found) is found


def test_open_and_fixed_parameters_stay_so_and_correlations_too() -> None:
    found = fit(Plant(1.0, 2.0, 300.0), [random_steps(PLANT + CubicSpring(4e4), 1)], fixed={"mass": 1.0})
    wider = widened(found)
    assert wider.quantities["mass"].std == 0.0
    np.testing.assert_allclose(wider.correlation, found.correlation, atol=1e-12)
    for name in ("damping", "stiffness"):
        assert wider.quantities[name].std > 1.5 * found.quantities[name].std
        assert wider.quantities[name].value == found.quantities[name].value
    damping = replace(found.quantities["damping"], std=math.nan)
    opened = replace(found, quantities={**found.quantities, "damping": damping})
    assert not widened(opened).quantities["damping"].known


def test_the_truth_lies_within_the_interval_beside_a_law_that_is_missing() -> None:
    """With the residual as noise the mass was missed by more than two standard deviations in eight of ten records."""
    missed = {True: 0, False: 0}
    for seed in range(10):
        record = random_steps(PLANT + CubicSpring(4e4), seed)
        found = fit(Plant(0.9, 2.0, 380.0) + DryFriction(0.0), [record])
        for wide, one in ((False, found), (True, widened(found))):
            mass = one.quantities["mass"]
            missed[wide] += abs(mass.value - PLANT.mass) > 2.0 * mass.std
    assert missed[True] <= 1 and missed[False] >= 5


def test_identify_states_them() -> None:
    record = random_steps(PLANT + CubicSpring(4e4), 3)
    found = pipeline.identify([record])
    plain = fit(found.refined.model, [record], search="near", initial=found.refined.initial)
    assert found.refined.parameters["mass"].std > 1.5 * plain.quantities["mass"].std


def test_what_rest_at_the_start_tells_is_known_beside_a_law_that_is_missing() -> None:
    """Of one step only the rest before it tells the scale of all forces, but for what friction holds."""
    time = np.arange(0.0, 30.0, 0.005)
    plant = Plant(0.021, 0.002, 0.0874) + DryFriction(5e-4)
    asked = from_samples(time, np.where(time > 0.0, 0.018, 0.0), np.zeros(time.size))
    noise = 5e-4 * np.random.default_rng(1).standard_normal(time.size)
    moved = simulate(plant + QuadraticDrag(0.03), asked).position
    found = fit(plant.with_values({"mass": 0.03}), [replace(asked, position=moved + noise)])
    assert found.see > 3.0 * found.noise_floor
    before, after = found.quantities["stiffness"], widened(found).quantities["stiffness"]
    assert before.std < after.std < 3.0 * before.std < 0.1 * before.value
    assert abs(after.value - 0.0874) < 2.0 * after.std


@pytest.mark.parametrize(("cubic", "lacks"), [(0.0, False), (2e4, True)])
def test_noise_that_wanders_is_no_law_that_the_model_lacks(cubic: float, lacks: bool) -> None:
    """A diagnosis of the same record said "adequate"."""
    rng = np.random.default_rng(5)
    record = random_steps(PLANT + CubicSpring(cubic), 2)
    wander = scipy.signal.lfilter([math.sqrt(1.0 - 0.9**2)], [1.0, -0.9], rng.standard_normal(record.samples))
    found = pipeline.identify([replace(record, position=record.position + 5e-5 * wander)])
    assert any("the model lacks something" in said for said in found.warnings) is lacks
    if not lacks:
        assert found.noise_floor == pytest.approx(5.1e-5, rel=0.1) and found.noise_floor > 0.9 * found.refined.see
