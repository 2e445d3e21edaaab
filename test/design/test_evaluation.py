"""How well a profile tells rivals apart."""

from __future__ import annotations

import dataclasses

from designrigs import LIMITS, Rig, stepped

from msd_ident.design.evaluation import Question, exciting, family_of, judge
from msd_ident.design.parameter_design import compared
from msd_ident.design.prediction import sensing


def test_a_rival_with_the_same_readings_is_never_decided() -> None:
    """Two explanations that predict the same, with the same evidence: no profile may claim to part them."""
    diagnosis = stepped("", "", 0.0)
    lead = diagnosis.contenders[0]
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    twin = dataclasses.replace(lead, causes=("twin",))
    question = Question.of((lead, twin), (0.5, 0.5), seen, LIMITS)
    step, _ = compared(3.0, question.period)
    assert judge(question, step.scaled(8.0)).probability < 0.05


def test_another_plant_is_decided_at_once() -> None:
    diagnosis = stepped("", "", 0.0)
    lead = diagnosis.contenders[0]
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    other = dataclasses.replace(lead, causes=("other",), model=lead.model.with_values({"mass": 1.05 * lead.model.mass}))
    question = Question.of((lead, other), (0.5, 0.5), seen, LIMITS)
    step, _ = compared(3.0, question.period)
    assert judge(question, step.scaled(8.0)).probability > 0.99


def test_profiles_that_excite_more_than_one_kind_of_motion_are_told_from_others() -> None:
    """One step was measured: another step excites nothing new, steps both ways do, and so does a sweep."""
    diagnosis = stepped("", "", 0.0)
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    question = Question.of(diagnosis.contenders[:1], (1.0,), seen, LIMITS)
    rich, plain = exciting(question, profiles := family_of(question), diagnosis.records)
    assert sorted((*rich, *plain), key=profiles.index) == profiles and rich == sorted(rich, key=profiles.index)
    names = {one.name for one in rich}
    assert "steps both ways, 3 periods" in names and any("sweep" in name for name in names)
    assert {"step, 3 periods", "release", "rest"} <= {one.name for one in plain}
    again, none = exciting(question, profiles, (*diagnosis.records, Rig().play(rich[0].scaled(2.0), LIMITS).record))
    assert again == profiles and none == []
