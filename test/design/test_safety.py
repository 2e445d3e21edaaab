"""How hard a profile may push: safe under what no rival knows of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from designrigs import ECP, LIMITS, SEEN, STEP, Rig, explanation

from msd_ident.data.record import Record
from msd_ident.design import Limits, Profile, Segment
from msd_ident.design.evaluation import Question, family_of, options
from msd_ident.design.prediction import DRAWS, Predictor, sensing
from msd_ident.design.safety import fitted_in, worst_case_actuator
from msd_ident.diagnosis import Diagnosis
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant
from msd_ident.selection.ranking import LEADERS
from msd_ident.workflow import pipeline

LARGEST = max(map(abs, STEP.extremes))
#: A rig whose stiffness is known to a fifth: how far a force moves it is not known better.
SOFT = Plant(0.94, 3.9, 694.0)


def parts(rig: Rig, found: Diagnosis, limits: Limits, records: Sequence[Record]) -> Iterator[float]:
    """Of the travel, which each profile of the family really uses."""
    question = Question.of(found.contenders[:1], (1.0,), sensing(found.records, found.noise_floor), limits, records)
    offered = options(question, family_of(question))
    assert len(offered) > 8
    for one in offered:
        position = rig.play(one.profile, limits).record.position
        yield float(np.max(np.abs(position - position[0]))) / limits.travel[1]


def test_an_actuator_that_was_at_its_limit_is_stronger_below_and_the_travel_is_kept() -> None:
    """One step cannot tell: the plant seems heavier and stiffer than it is by what the actuator lacked."""
    rig = Rig(force_gain_nonlinearity={"gain_slope": 0.0, "force_limit": 0.6 * LARGEST})
    found = pipeline.diagnose([rig.play(STEP, LIMITS).record])
    assert not found.causes
    assert found.extended.model.stiffness == pytest.approx(ECP["stiffness"] / 0.6, rel=0.02)
    limits = Limits((-LARGEST, LARGEST), (-0.016, 0.016), 6.0)
    assert any(part > 1.05 for part in parts(rig, found, limits, ()))
    assert all(part <= 1.0 for part in parts(rig, found, limits, found.records))


@pytest.mark.parametrize("known", [0.001, 0.2])
def test_the_limits_hold_for_all_that_the_data_leaves_of_the_parameters(known: float) -> None:
    """Five of nine proposals on public records left the travel that they were designed for, by up to six times."""
    limits = Limits((-10.0, 10.0), (-0.008, 0.008), 6.0, 0.12)
    question = Question.of([explanation(SOFT, known=known)], (1.0,), SEEN, limits)
    offered = options(question, family_of(question))
    assert len(offered) > 8
    nominal, beyond = [], []
    for one in offered:
        rows = question.predictors[0].drawn(one.grid.record, DRAWS)
        rows -= rows[:, :1]
        fast = np.max(np.abs(np.gradient(rows, one.grid.record.time, axis=1)), axis=1) / 0.12
        reached = np.maximum(np.max(np.abs(rows), axis=1) / 0.008, fast)
        nominal.append(float(reached[0]))
        beyond += reached[1 + LEADERS :].tolist()  # draws that it was not scaled with
    assert max(nominal) <= 0.8 + 1e-9 and max(nominal) > 0.5
    assert np.mean(np.array(beyond) > 1.0) <= 0.02 and max(beyond) < 1.4
    assert known < 0.1 or np.mean(nominal) < 0.7, "what is not known costs amplitude"


@pytest.mark.parametrize(("travel", "fits"), [(0.02, True), (0.005, False)])
def test_a_release_without_a_force_stays_within_the_travel_too(travel: float, fits: bool) -> None:
    limits = Limits((-10.0, 10.0), (-travel, travel), 6.0)
    aside = replace(explanation(SOFT), initial=(Initial(0.01),))
    rest = Profile((Segment("hold", 2.0),), "rest")
    found = fitted_in(rest, (Predictor(aside, 1e-4),), limits, 0.23, SEEN)
    assert (found is rest) is fits


def test_smaller_forces_that_were_measured_need_no_caution() -> None:
    rig = Rig()
    found = pipeline.diagnose([rig.play(STEP, LIMITS).record])
    lead = found.contenders[0]
    one = worst_case_actuator(lead, found.records)
    assert one is not None and one.model["force_limit"] == pytest.approx(0.5 * LARGEST)
    assert one.model.stiffness == pytest.approx(0.5 * lead.model.stiffness)
    smaller = rig.play(STEP.scaled(0.3), LIMITS).record
    assert worst_case_actuator(lead, (*found.records, smaller)) is None
