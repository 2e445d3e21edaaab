"""How hard a profile may push: safe under what no rival knows of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from designrigs import ECP, LIMITS, STEP, Rig

from msd_ident.data.record import Record
from msd_ident.design import Limits
from msd_ident.design.evaluation import Question, family_of, options
from msd_ident.design.prediction import sensing
from msd_ident.design.safety import worst_case_actuator
from msd_ident.diagnosis import Diagnosis
from msd_ident.workflow import pipeline

LARGEST = max(map(abs, STEP.extremes))


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


def test_smaller_forces_that_were_measured_need_no_caution() -> None:
    rig = Rig()
    found = pipeline.diagnose([rig.play(STEP, LIMITS).record])
    lead = found.contenders[0]
    one = worst_case_actuator(lead, found.records)
    assert one is not None and one.model["force_limit"] == pytest.approx(0.5 * LARGEST)
    assert one.model.stiffness == pytest.approx(0.5 * lead.model.stiffness)
    smaller = rig.play(STEP.scaled(0.3), LIMITS).record
    assert worst_case_actuator(lead, (*found.records, smaller)) is None
