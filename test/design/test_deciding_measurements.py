"""What to measure where no force profile decides."""

from __future__ import annotations

from dataclasses import replace

from designrigs import explanation
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.design.deciding_measurements import between, measurement
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.selection.candidate_models import CandidateModel

PLAIN = explanation(Plant(1.0, 2.0, 400.0))
causes = st.sets(st.sampled_from([effect.name for effect in LIBRARY]), max_size=3)


def called(*names: str) -> CandidateModel:
    return replace(PLAIN, causes=tuple(sorted(names)))


@given(causes, causes, causes)
def test_only_what_they_differ_in_counts_and_not_which_comes_first(
    one: set[str], other: set[str], both: set[str]
) -> None:
    apart = one ^ other
    told = measurement(called(*(one | both)), called(*(other | both)))
    assert told == measurement(called(*(other | both)), called(*(one | both)))
    if not apart & both:
        assert told == measurement(called(*one), called(*other))
    known = {by_name(name).measured_by for name in apart - both} - {""}
    assert told in known or (not known and told == "weigh the cart, and read the force at rest")


def test_an_offset_is_measured_first() -> None:
    """It is a shifted zero, which nothing else shows."""
    assert "tilt the rig" in measurement(called("backlash", "force_offset"), called())
    assert "by hand within the play" in measurement(called("backlash"), called("coulomb_friction"))


def test_a_joint_is_measured_with_torques() -> None:
    told = measurement(called("coulomb_friction"), called(), "rad")
    assert told.startswith("turn the joint slowly with a spring balance on a lever of known length and read the torque")
    assert "weigh" in measurement(called(), called()) and "inertia" in measurement(called(), called(), "rad")


def test_a_sentence_for_each_pair() -> None:
    assert between([("play", "no cause", "move it"), ("lag", "delay", "hold it")]) == (
        "No profile within these limits decides between play and no cause: move it.",
        "No profile within these limits decides between lag and delay: hold it.",
    )
    assert between([]) == ()
