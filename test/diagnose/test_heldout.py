"""Held-out prediction: cut at the steps, every sample predicted by a fit that did not see it."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.diagnose.candidates import Experiment, Fitted, refine
from msd_ident.diagnose.heldout import FOLDS, predict, segments
from msd_ident.diagnose.readings import prepare
from msd_ident.fit.problem import Initial
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.record import Record
from msd_sim.api import simulate

RIG = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0}


def experiment(**more: object) -> Experiment:
    spec = {**RIG, "encoder": {"counts_per_metre": 0.0, "noise": 2e-5}, "experiment": {"name": "steps", "hold": 0.5}}
    made = simulate({**spec, **more})
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), Plant(1.0, 2.0, 600.0), frozenset())


def base_of(data: Experiment) -> Fitted:
    return refine(data, frozenset(), Plant(1.0, 2.0, 600.0), (Initial(),))


def test_segments_run_from_step_to_step() -> None:
    record = experiment().records[0]
    cut = segments(record)
    assert np.unique(cut).size == 8
    assert np.flatnonzero(np.diff(cut))[0] == 499
    assert FOLDS <= 8


def test_the_right_cause_predicts_and_the_interval_says_so() -> None:
    data = experiment(effects={"coulomb_friction": {"coulomb_force": 0.3}})
    right = refine(data, frozenset({"coulomb_friction"}), Plant(1.0, 2.0, 600.0) + CoulombFriction(0.3), (Initial(),))
    found = predict(data, base_of(data), right)
    assert found.better
    assert found.interval_percent[0] > 80.0
    assert found.interval_percent[0] <= found.reduction_percent <= found.interval_percent[1]
    assert found.see_extended == pytest.approx(2e-5, rel=0.1)


def test_a_cause_that_is_not_there_gains_nothing() -> None:
    data = experiment()
    extra = refine(data, frozenset({"quadratic_drag"}), Plant(1.0, 2.0, 600.0) + QuadraticDrag(0.01), (Initial(),))
    found = predict(data, base_of(data), extra)
    assert abs(found.reduction_percent) < 1.0
    assert found.interval_percent[0] < 0.5
