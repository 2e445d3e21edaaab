"""Designs: they keep to the limits, find what hides, predict what comes, and say what no profile can part."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from designrigs import BENT, LIMITS, Rig, checked, stepped

from msd_ident.data.record import Record
from msd_ident.design import (
    Limits,
    Profile,
    Proposal,
    Segment,
    check,
    check_predictable,
    default_limits,
    design,
    proposing,
    signs_doubt,
)
from msd_ident.design import proposal as proposals
from msd_ident.design.discrimination import Discrimination
from msd_ident.design.evaluation import Option
from msd_ident.design.parameter_design import sharpen
from msd_ident.design.prediction import Grid
from msd_ident.design.proposal import _closest_pair, _hardest, _instead, _moved, _sentence
from msd_ident.design.rival_refits import Refitted
from msd_ident.errors import UsageError
from msd_ident.estimate import opposite_signs
from msd_ident.workflow import pipeline

pytestmark = pytest.mark.xdist_group("bent gain")


@pytest.fixture(scope="module")
def proposal() -> Proposal:
    """What to do after one step of a rig whose actuator's gain bends, which the step does not show."""
    return checked()


def test_what_hides_behind_a_perfect_fit_is_looked_for_and_found(proposal: Proposal) -> None:
    assert "force_gain_nonlinearity" in proposal.names
    assert proposal.decided[proposal.names.index("force_gain_nonlinearity")] > 0.9
    rig = Rig(**BENT)
    first = stepped("force_gain_nonlinearity", "gain_slope", 0.006).records[0]
    together = pipeline.diagnose([first, rig.play(proposal.profile, LIMITS).record])
    assert [cause.name for cause in together.causes] == ["force_gain_nonlinearity"]
    assert together.verdict == "explained"


def test_the_motion_is_the_one_that_was_promised(proposal: Proposal) -> None:
    record = Rig(**BENT).play(proposal.profile, LIMITS).record
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


def test_what_no_profile_parts_gets_a_measurement(looking_for: Callable[..., None]) -> None:
    """A force offset of a linear rig is a shifted zero: an identity."""
    looking_for("force_offset", "coulomb_friction", "quadratic_drag", "actuator_lag")
    found = check(stepped("", "", 0.0), LIMITS)
    assert found is not None and "force_offset" in found.names
    assert found.decided[found.names.index("force_offset")] < 0.01
    assert "is likely to show force_offset (the best one with a probability below" in found.sentence
    assert any("force_offset" in said and "tilt the rig" in said for said in found.measurements)


def test_where_no_profile_is_worth_playing_none_is_proposed(
    looking_for: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    looking_for("force_offset", "coulomb_friction", "quadratic_drag", "actuator_lag")
    monkeypatch.setattr(proposals, "IN_VAIN", 2.0)
    found = check(stepped("", "", 0.0), LIMITS)
    assert found is not None and found.sentence.startswith("No experiment is proposed: no profile within the limits")
    assert "Measure in place of it: tilt the rig" in found.sentence
    assert not any(word in found.sentence for word in ("Play", "will move", "most difficult"))


def test_what_is_in_vain_names_measurements_once_and_limits() -> None:
    said = _instead(("A", "B", "C"), "parts", ["hold it", "weigh it", "hold it"])
    assert said == (
        "No experiment is proposed: no profile within the limits is likely to tell A or B or C (the best one with a "
        "probability below 0.005). Measure in place of it: hold it; weigh it. Or allow more force, travel or time."
    )
    assert _instead(("no cause", "B"), "shows", []).endswith(
        "likely to show B (the best one with a probability below 0.005). Allow more force, travel or time."
    )


def test_limits_without_room() -> None:
    with pytest.raises(UsageError, match="no experiment has room within these limits; expected more force"):
        check(stepped("", "", 0.0), Limits((-10.0, 10.0), (-0.03, 0.03), 0.05))


def test_limits_without_room_are_told_with_the_units_of_the_records() -> None:
    """A rig in counts: the travel of 0.03 m was read as 0.03 counts, without a word."""
    told = stepped("", "", 0.0)
    counted = replace(told, records=tuple(replace(one, position_unit="count") for one in told.records))
    tight = Limits((-10.0, 10.0), (-0.03, 0.03), 0.05)
    for call in (lambda: check(counted, tight), lambda: sharpen(counted, ["mass"], tight)):
        with pytest.raises(UsageError, match=r"the units of the records: force -10 to 10 N, travel -0.03 to 0.03 cou"):
            call()


def test_nothing_is_designed_where_no_force_acts() -> None:
    """A free decay says nothing of how far a force moves the rig: the limits were said to be too tight."""
    told = stepped("", "", 0.0)
    still = replace(told, records=tuple(replace(one, force=0.0 * one.force) for one in told.records))
    with pytest.raises(UsageError, match="no force acts in these records, .* expected a record with a force: record"):
        check_predictable(still)


def test_without_limits_a_design_asks_for_no_more_than_was_measured() -> None:
    diagnosis = stepped("", "", 0.0)
    (record,) = diagnosis.records
    limits = default_limits(diagnosis)
    assert limits.force == (-8.0, 8.0) and limits.duration == 20.0
    assert limits.travel[1] == -limits.travel[0] == np.max(np.abs(record.position - record.position[0]))
    still = replace(record, force=0.0 * record.force)
    with pytest.raises(UsageError, match="limits: force from -?0 to 0; expected one number above 0"):
        default_limits(replace(diagnosis, records=(still,)))


def test_a_verdict_that_is_not_ambiguous_needs_no_proposal() -> None:
    diagnosis = stepped("", "", 0.0)
    assert proposing(diagnosis) is diagnosis
    alone = replace(diagnosis, verdict="ambiguous")
    assert proposing(alone) is alone, "nothing is tied"


def test_nothing_is_proposed_where_no_record_shows_what_a_force_does(
    proposal: Proposal, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hand moved the cart: mass, damping and stiffness are open, so how far a profile would move it is unknown."""
    tied = replace(stepped("", "", 0.0), verdict="ambiguous")
    monkeypatch.setattr(proposals, "design", lambda diagnosis, limits: proposal)
    assert proposing(tied).next_experiment is not None
    opened = {name: replace(one, std=math.nan) for name, one in tied.extended.quantities.items()}
    blind = replace(tied, extended=replace(tied.extended, quantities=opened))
    assert proposing(blind) is blind
    with pytest.raises(UsageError, match="do not show how far a force moves the rig, .* push harder or longer"):
        check_predictable(blind)


def test_nothing_is_designed_where_mass_and_stiffness_have_opposite_signs(
    proposal: Proposal, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A magnet in the air: the fitted values are not those of the rig, and no controller holds it in an experiment."""
    told = stepped("", "", 0.0)
    left = replace(told.left, extended=replace(told.left.extended, seen=True, motion_percent=5.0))
    tied = replace(told, verdict="ambiguous", left=left)
    monkeypatch.setattr(proposals, "design", lambda diagnosis, limits: proposal)
    monkeypatch.setattr(opposite_signs, "warning", lambda records: "A regression gives opposite signs")
    assert signs_doubt(tied) and proposing(tied) is tied
    with pytest.raises(
        UsageError, match="no experiment can be designed .*: a regression .* signs; expected a record of"
    ):
        check_predictable(tied)
    held = replace(tied, left=replace(left, tolerance_percent=10.0))
    assert signs_doubt(held) == "" and proposing(held).next_experiment is not None, "what is left is tolerated"


def parted(chi: list[list[float]], decided: list[float]) -> Option:
    """An option of which nothing else is asked."""
    on = Grid(Record(np.arange(20.0), np.zeros(20), np.zeros(1), np.zeros(1)), 1.0)
    parting = Discrimination(np.array(chi), np.array(decided), float(np.mean(decided)))
    return Option(Profile((Segment("step", 2.0, force=8.0),), "one step"), on, (), parting, np.ones(2))


def test_the_hardest_pair_is_seen_with_the_richer_law_true() -> None:
    """Refitted, the richer one becomes the simpler one: that they differ by nothing then says nothing."""
    assert _closest_pair(parted([[0.0, 900.0], [0.01, 0.0]], [1.0, 1.0])) == (0, 1)
    assert _closest_pair(parted([[0.0, 900.0], [0.01, 0.0]], [0.1, 1.0])) == (1, 0), "the other one is not found out"
    three = [[0.0, 900.0, 800.0], [0.01, 0.0, 70.0], [0.02, 50.0, 0.0]]
    assert _closest_pair(parted(three, [1.0, 1.0, 1.0])) == (1, 2)
    assert _closest_pair(parted(three, [0.0, 0.0, 0.0])) == (1, 2)


def test_a_measurement_that_cannot_tell_promises_nothing() -> None:
    left = Refitted(1.0, 2e-3 * np.eye(20)[1], np.zeros(20), 0)
    for probability, words in (
        (0.9, "It should tell A or B with probability 0.90."),
        (0.2, "is likely to tell A or B;"),
    ):
        option = parted([[0.0, 9.0], [9.0, 0.0]], [probability, probability])
        said = _sentence(option, ("A", "B"), "parts", "N")
        assert words in said and ("It should" in said) == (probability > 0.5)
        hardest = _hardest(option, ("A", "B"), left, (1e-5, 50.0))
        assert "they differ by up to 200 noise levels (the model leaves 50), at 1.0 s." in hardest
    sure = parted([[0.0, 9.0], [9.0, 0.0]], [1.0, 0.999])
    assert _sentence(sure, ("A", "B"), "parts", "N").endswith("A or B with probability above 0.99.")
    beyond = _sentence(sure, ("A", "B"), "parts", "N", 2.0)
    assert beyond.endswith("with probability above 0.99, if one of these is the law of the rig.")
    assert _moved((-1.0, 2.0), 3.0, "rad").startswith("The joint will turn -1 to 2 rad from its start, at 3 rad/s at")
