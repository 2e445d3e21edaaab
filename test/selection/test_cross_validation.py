"""Held-out prediction: cut at the steps, every sample predicted by a fit that did not see it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from bench import held_out
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.broyden import step
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.cross_validation import FOLDS, _blocks, predict, refitted, segments, training
from msd_ident.selection.experiment import Experiment, weigh
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_sim.api import simulate

RIG = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0}

#: One push and a long rest.
PUSH = {"damping": 8.0, "experiment": {"name": "step", "start": 0.1, "hold": 8.0}}


def experiment(**more: object) -> Experiment:
    spec = {**RIG, "encoder": {"counts_per_metre": 0.0, "noise": 2e-5}, "experiment": {"name": "steps", "hold": 0.5}}
    made = simulate({**spec, **more})
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), Plant(1.0, 2.0, 600.0), frozenset())


def base_of(data: Experiment) -> Hypothesis:
    return refine(data, frozenset(), Plant(1.0, 2.0, 600.0), (Initial(),))


def test_segments_run_from_step_to_step() -> None:
    record = experiment().records[0]
    cut = segments(record)
    assert np.unique(cut).size == 8
    assert np.flatnonzero(np.diff(cut))[0] == 499
    assert FOLDS <= 8


def test_without_steps_each_segment_has_its_part_of_motion_and_rest() -> None:
    """Of equal times of one push and a long rest, the first would hold all that there is to fit."""
    record = experiment(**PUSH, encoder={"counts_per_metre": 0.0, "noise": 0.0}).records[0]
    cut = segments(record)
    assert list(np.unique(cut)) == list(range(8)) and np.all(np.diff(cut) >= 0)
    travel = np.abs(np.diff(record.position))
    way = np.array([travel[cut[1:] == number].sum() for number in range(8)]) / travel.sum()
    time = np.bincount(cut) / record.samples
    assert 0.5 * (way + time) == pytest.approx(np.full(8, 0.125), abs=0.03)
    assert way[:4].min() > 0.1 and time[4:].min() > 0.1
    still = replace(record, position=np.zeros(record.samples))
    assert np.all(np.diff(segments(still)) >= 0)


def test_friction_that_one_push_shows_predicts_the_motion_that_was_left_out() -> None:
    data = experiment(**PUSH, effects={"coulomb_friction": {"coulomb_force": 1.0}})
    right = refine(data, frozenset({"coulomb_friction"}), Plant(1.0, 8.0, 600.0) + CoulombFriction(1.0), (Initial(),))
    found = predict(data, base_of(data), right)
    assert found.better and found.interval_percent[0] > 80.0
    assert found.see_extended < 2.0 * 2e-5


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
    assert found.interval_percent[0] < 0.0 < found.interval_percent[1]
    assert not found.better


def test_every_fold_moves_every_parameter_of_both_models() -> None:
    data = experiment(effects={"coulomb_friction": {"coulomb_force": 0.3}})
    right = refine(data, frozenset({"coulomb_friction"}), Plant(1.0, 2.0, 600.0) + CoulombFriction(0.3), (Initial(),))
    cuts = [segments(record) for record in data.records]
    for fitted in (base_of(data), right):
        for fold in range(FOLDS):
            masks = [training(cut, fold) for cut in cuts]
            point = refitted(data, fitted, masks)
            free = len(fitted.problem.free)
            assert np.all(point[:free] != fitted.point[:free])
            assert _promised(data, fitted, point, masks) < 0.05 * max(fitted.chi / data.evidence, 1.0)


def _promised(data: Experiment, fitted: Hypothesis, point: FloatArray, masks: list[FloatArray]) -> float:
    """Fall of the training data's chi² that a last full step still promises."""
    weighting = weigh(fitted.problem, data.readings, masks)
    return step(fitted.problem, weighting.exact(point, weighting.steps(None)), 1e-9)[1]


@pytest.mark.parametrize(("rigs", "better", "no_gain"), [(6, 0, 4), pytest.param(30, 2, 20, marks=pytest.mark.long)])
def test_useless_effects_lose(rigs: int, better: int, no_gain: int) -> None:
    trials = list(held_out.useless(range(rigs)))
    assert len(trials) == 2 * rigs
    assert sum(trial.held.better for trial in trials) <= better
    assert sum(trial.held.reduction_percent <= 0.0 for trial in trials) >= no_gain


@pytest.mark.parametrize("fall", [100.0, np.inf])
@pytest.mark.parametrize(("rigs", "visible", "lost"), [(9, 7, 1), pytest.param(18, 14, 2, marks=pytest.mark.long)])
def test_true_effects_win_also_when_they_are_faint(rigs: int, visible: int, lost: int, fall: float) -> None:
    trials = list(held_out.true(range(100, 100 + rigs), fall=fall))
    assert len(trials) >= visible
    assert sum(not trial.held.better for trial in trials) <= (lost if fall < np.inf else 0)


def test_errors_without_end_are_no_gain() -> None:
    data = experiment()
    extra = refine(data, frozenset({"quadratic_drag"}), Plant(1.0, 2.0, 600.0) + QuadraticDrag(0.01), (Initial(),))
    lost = replace(extra, state=replace(extra.state, point=extra.point * 0.0 + extra.problem.upper.clip(max=1e9)))
    found = predict(data, base_of(data), lost)
    assert not found.better and np.isfinite(found.interval_percent).all()


def test_a_model_is_not_better_than_itself() -> None:
    data = experiment()
    base = base_of(data)
    found = predict(data, base, base)
    assert (found.reduction_percent, *found.interval_percent) == (0.0, 0.0, 0.0) and not found.better
    assert all(math.copysign(1.0, end) == 1.0 for end in found.interval_percent)


def test_a_cart_that_seems_to_have_no_mass_forgets_no_faster_than_it_is_read() -> None:
    """Its memory is next to nothing, and blocks of errors as short would be more than fit into the memory."""
    data = experiment()
    samples = data.records[0].samples
    errors, cuts = (np.ones(samples),), [segments(data.records[0])]
    found = _blocks(data, Plant(1e-12, 1.0, 0.0), (errors, errors), cuts)
    assert found.base.size <= samples and found.base.sum() == samples
