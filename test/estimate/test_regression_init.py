"""Regression start: within 1.5 % of the truth without any simulation."""

from __future__ import annotations

import numpy as np
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured, wrong

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import regression_start
from msd_ident.model import Model, Plant
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_sim.api import simulate


def _worst(found: Model, truth: Model, *names: str) -> float:
    return max(abs(found[name] / truth[name] - 1.0) for name in names or truth.names)


def test_demo_rig_within_one_and_a_half_per_cent() -> None:
    assert _worst(regression_start(demo_record(), wrong(DEMO)), DEMO) < 0.015


def test_with_noise_of_a_tenth_of_a_per_cent() -> None:
    record = demo_record(encoder={"counts_per_metre": COUNTS_PER_METRE, "noise": 1.5e-5}, seed=1)
    found = regression_start(record, wrong(DEMO))
    assert _worst(found, DEMO, "mass", "damping", "stiffness") < 0.015
    assert _worst(found, DEMO, "coulomb_force") < 0.1


def test_a_zero_somewhere_else_changes_nothing() -> None:
    here = regression_start(demo_record(), wrong(DEMO))
    there = regression_start(measured(DEMO, {"name": "paper"}, zero=0.12, rate=1000.0), wrong(DEMO))
    assert _worst(there, here, "mass", "stiffness") < 0.005


def test_one_step_under_constant_force_starts_from_rest() -> None:
    record = measured(DEMO, {"name": "step"}, zero=-0.05, rate=1000.0)
    assert _worst(regression_start(record, wrong(DEMO)), DEMO, "mass", "damping", "stiffness") < 0.015


def test_free_decay_gives_the_ratios_to_the_given_mass() -> None:
    record = measured(DEMO, {"name": "release", "position": 0.02}, rate=1000.0)
    found = regression_start(record, DEMO)
    assert found["mass"] == DEMO["mass"]
    assert _worst(found, DEMO) < 0.015


def test_irregular_samples() -> None:
    rng = np.random.default_rng(5)
    time = np.cumsum(rng.uniform(0.5e-3, 1.5e-3, 6000))
    record = measured(DEMO, {"name": "paper"}, time=time)
    assert _worst(regression_start(record, wrong(DEMO)), DEMO, "mass", "damping", "stiffness") < 0.015


def test_force_linear_between_samples() -> None:
    instants = np.arange(0.0, 6.0, 0.004)
    force = 8.0 * np.sin(15.0 * instants + 3.0 * instants**2)
    record = _driven(instants, force)
    assert _worst(regression_start(record, wrong(DEMO)), DEMO, "mass", "damping", "stiffness") < 0.015


def _driven(instants: FloatArray, force: FloatArray) -> Record:
    effects = {"coulomb_friction": {"coulomb_force": DEMO["coulomb_force"]}}
    made = simulate(
        {"mass": DEMO["mass"], "damping": DEMO["damping"], "stiffness": DEMO["stiffness"], "effects": effects,
         "time": instants, "force_time": instants, "force": force, "hold": "linear"}
    )  # fmt: skip
    return Record(made.time, made.position, made.force_time, made.force, hold="linear")


def test_offset_and_drag_are_linear_too() -> None:
    truth = Plant(1.2, 4.0, 500.0) + CoulombFriction(0.2) + QuadraticDrag(6.0) + ForceOffset(0.8)
    record = measured(truth, {"name": "steps", "force": 12.0, "hold": 2.0}, rate=1000.0)
    assert _worst(regression_start(record, wrong(truth)), truth) < 0.05


def test_fixed_parameters_stay() -> None:
    found = regression_start(demo_record(), DEMO.with_values({"damping": 3.0}), fixed=["damping"])
    assert found["damping"] == 3.0


def test_a_record_that_says_nothing_keeps_the_given_values() -> None:
    time = np.arange(200) * 1e-3
    still = Record(time, np.zeros(200), time, np.zeros(200))
    assert regression_start(still, DEMO) == DEMO


def test_no_spring() -> None:
    truth = Plant(2.0, 15.0, 0.0) + CoulombFriction(1.0) + ForceOffset(0.3)
    record = measured(truth, {"name": "random_steps", "force": 8.0, "duration": 6.0}, rate=1000.0)
    found = regression_start(record, wrong(truth).with_values({"stiffness": 0.0}), fixed=["stiffness"])
    assert _worst(found, truth, "mass", "damping", "coulomb_force") < 0.03


def test_a_ripple_whose_phase_counts_from_the_relaxed_spring_keeps_its_force() -> None:
    """The regression counts from reading 0: half a pitch off, it would find the ripple with the other sign."""
    rig = Plant(1.2, 6.0, 620.0) + Cogging(1.0, 3e-3, 0.4)
    record = measured(rig, {"name": "steps", "force": 8.0, "hold": 0.6}, rate=250.0, zero=1.5e-3)
    assert regression_start(record, rig)["cogging_amplitude"] == 1.0
