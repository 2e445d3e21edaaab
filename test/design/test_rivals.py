"""Which explanations a design must distinguish, and what they are called."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from designrigs import explanation, stepped
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.design.rivals import names, rivals, shares
from msd_ident.estimate.levels import NEGLIGIBLE
from msd_ident.model import Plant
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.ranking import DECISIVE

PLAIN = explanation(Plant(0.94, 3.9, 694.0))


def called(causes: Sequence[str], evidence: float = 0.0, probability: float = 0.0) -> CandidateModel:
    return replace(PLAIN, causes=tuple(sorted(causes)), evidence=evidence, probability=probability)


def chosen(*standing: CandidateModel) -> list[tuple[str, ...]]:
    """Causes of the rivals where these explanations stand."""
    return [one.causes for one in rivals(replace(stepped("", "", 0.0), contenders=standing))]


def test_rivals_are_near_or_not_improbable() -> None:
    lead = called(["cogging"], 10.0, 0.9)
    near, far = called(["backlash"], 10.0 - 0.9 * DECISIVE), called(["hysteresis"], 10.0 - 1.1 * DECISIVE)
    assert chosen(lead, near, far) == [("cogging",), ("backlash",)]
    likely = replace(far, probability=1.1 * NEGLIGIBLE)
    assert chosen(lead, near, likely) == [("cogging",), ("backlash",), ("hysteresis",)]


def test_what_holds_all_of_a_likelier_one_and_more_is_no_rival() -> None:
    simple, richer = called(["cogging"], 10.0), called(["cogging", "backlash"], 9.0)
    assert chosen(simple, richer) == [("cogging",)]
    assert chosen(simple, replace(richer, evidence=10.0 + 1.1 * DECISIVE)) == [("cogging",), ("backlash", "cogging")]


def test_the_leading_one_is_always_among_them_and_the_first() -> None:
    lead = called(["cogging"], -50.0)
    others = [called([name], 0.0) for name in "abcdefgh"]
    found = chosen(lead, *others)
    assert found[0] == ("cogging",) and len(found) == 1 + len(others)
    assert chosen() == [] and chosen(lead) == [("cogging",)]


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6))
def test_shares_add_up_and_keep_their_ratios(probabilities: list[float]) -> None:
    found = shares([called(["cogging"], probability=p) for p in probabilities])
    assert sum(found) == pytest.approx(1.0)
    total = sum(probabilities)
    expected = [p / total for p in probabilities] if total > 0.0 else [1.0 / len(found)] * len(found)
    assert found == pytest.approx(expected)


def test_a_rival_is_called_by_what_the_others_lack() -> None:
    common = ["coulomb_friction"]
    assert names([called([*common, "cogging"]), called([*common, "backlash", "hysteresis"])]) == [
        "cogging", "backlash + hysteresis",
    ]  # fmt: skip
    assert names([called(common), called([*common, "cogging"])]) == ["none of them", "cogging"]
    assert names([called([]), called(["cogging"])]) == ["no cause", "cogging"]
    assert names([]) == []
