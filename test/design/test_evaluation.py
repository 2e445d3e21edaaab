"""Designs: they keep to the limits, find what hides, predict what comes, and say what no profile can part."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from designrigs import LIMITS, Rig, stepped

from msd_ident.design import Limits, Profile, Proposal, Segment, check, design
from msd_ident.design.evaluation import Question, judge
from msd_ident.design.hidden_effects import hidden
from msd_ident.design.parameter_design import compared, sharpen
from msd_ident.design.prediction import sensing
from msd_ident.errors import UsageError
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.workflow import pipeline


@pytest.fixture(scope="module")
def proposal() -> Proposal:
    """What to do after one step of a rig whose actuator's gain bends, which the step does not show."""
    diagnosis = stepped("force_gain_nonlinearity", "gain_slope", 0.006)
    assert diagnosis.verdict == "adequate"
    found = check(diagnosis, LIMITS)
    assert found is not None
    return found


def test_what_hides_behind_a_perfect_fit_is_looked_for_and_found(proposal: Proposal) -> None:
    assert "force_gain_nonlinearity" in proposal.names
    assert proposal.decided[proposal.names.index("force_gain_nonlinearity")] > 0.9
    rig = Rig(force_gain_nonlinearity={"gain_slope": 0.006})
    first = stepped("force_gain_nonlinearity", "gain_slope", 0.006).records[0]
    together = pipeline.diagnose([first, rig.play(proposal.profile, LIMITS).record])
    assert [cause.name for cause in together.causes] == ["force_gain_nonlinearity"]
    assert together.verdict == "explained"


def test_the_motion_is_the_one_that_was_promised(proposal: Proposal) -> None:
    record = Rig(force_gain_nonlinearity={"gain_slope": 0.006}).play(proposal.profile, LIMITS).record
    low, high = proposal.travel
    moved = record.position - record.position[0]
    assert LIMITS.travel[0] <= low and high <= LIMITS.travel[1]
    assert low * 1.1 - 1e-4 < moved.min() and moved.max() < high * 1.1 + 1e-4
    assert high - low == pytest.approx(np.ptp(moved), rel=0.35)
    assert max(map(abs, proposal.profile.extremes)) <= 10.0 * (1.0 + 1e-12)
    assert proposal.profile.duration <= 20.0


def test_the_contract(proposal: Proposal) -> None:
    found = proposal.to_json_dict()
    assert {
        "sentence", "duration_s", "probability_of_decision", "profile", "travel_m", "peak_speed_m_s", "separates",
    } <= set(found)  # fmt: skip
    assert found["separates"][0] == "no cause"
    assert "with probability" in found["sentence"] and "\n" not in found["sentence"]
    assert 0.0 <= found["probability_of_decision"] <= 1.0


def test_no_tie_no_design() -> None:
    assert design(stepped("", "", 0.0), LIMITS) is None


def test_what_no_profile_parts_gets_a_measurement() -> None:
    """A force offset of a linear rig is a shifted zero: an identity."""
    found = check(stepped("", "", 0.0), LIMITS)
    assert found is not None and "force_offset" in found.names
    assert any("force_offset" in said and "tilt the rig" in said for said in found.measurements)


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


def test_limits_without_room() -> None:
    with pytest.raises(UsageError, match="no experiment has room within these limits; expected more force"):
        check(stepped("", "", 0.0), Limits((-10.0, 10.0), (-0.03, 0.03), 0.05))


@pytest.mark.parametrize(
    ("counts", "half_width"),
    [(42e3, 1e-4), *(pytest.param(*rig, marks=pytest.mark.long) for rig in ((42e3, 3e-4), (80e3, 1.5e-4)))],
)
def test_a_play_in_which_the_cart_began_hides_at_its_very_size(counts: float, half_width: float) -> None:
    """A step ends beyond the play: a softer plain spring fits as well. Smaller plays than the true one fit worse."""
    rig = Rig({"counts_per_metre": counts}, backlash={"backlash_half_width": half_width})
    first = Profile((Segment("hold", 0.3), Segment("step", 2.7, force=8.0)), "one step")
    diagnosis = pipeline.diagnose([rig.play(first, LIMITS).record])
    assert diagnosis.verdict == "adequate"
    lead, *hiding = hidden(diagnosis, sensing(diagnosis.records, diagnosis.noise_floor))
    assert lead.causes == ()
    (play,) = [rival for rival in hiding if rival.causes == ("backlash",)]
    assert play.model["backlash_half_width"] > 0.5 * half_width
    proposal = check(diagnosis, LIMITS)
    assert proposal is not None
    together = pipeline.diagnose([*diagnosis.records, rig.play(proposal.profile, LIMITS).record])
    assert together.verdict == "explained" and [cause.name for cause in together.causes] == ["backlash"]


def test_sharpened_intervals_come_true() -> None:
    """µ after the designed experiment: as narrow as promised, and half of what a single step as long gives."""
    size = 0.05
    diagnosis = stepped("coulomb_friction", "coulomb_force", size)
    found = sharpen(diagnosis, ["friction_coefficient"], LIMITS)
    rig = Rig(coulomb_friction={"coulomb_force": size})
    step = compared(found.profile.duration, 0.23)[0].scaled(8.0)
    widths = []
    for profile in (found.profile, step):
        record = rig.play(profile, LIMITS).record
        fitted = fit(Plant(0.94, 3.9, 694.0) + CoulombFriction(size), record)
        mu = fitted.derived(lambda p: p["coulomb_force"] / (p["mass"] * 9.80665), "1")
        assert abs(mu.value - size / (0.94 * 9.80665)) < 5.0 * mu.std
        widths.append(1.96 * mu.std)
    assert widths[0] <= 0.5 * widths[1]
    assert found.after["friction_coefficient"] == pytest.approx(widths[0], rel=0.5)
    assert found.after["friction_coefficient"] < found.random["friction_coefficient"]
    assert found.after["friction_coefficient"] < 0.7 * found.step["friction_coefficient"]


def test_unknown_targets() -> None:
    with pytest.raises(UsageError, match="no parameter 'colour' to sharpen; this model has mass, damping, stiffness"):
        sharpen(stepped("", "", 0.0), ["colour"], LIMITS)
