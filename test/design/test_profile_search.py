"""The search through the family: the first profile that decides well enough, or the best."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from designrigs import LIMITS, SEEN, explanation

from msd_ident import cancellation
from msd_ident.design import profile_search, rival_refits
from msd_ident.design.evaluation import ENOUGH, Question, family_of
from msd_ident.design.profile_search import HOPELESS, Found, search
from msd_ident.model import Model, Plant
from msd_ident.selection.ranking import LEADERS

PLANT = Plant(0.94, 3.9, 694.0)


def asking(*models: Model, known: float = 0.01) -> Question:
    rivals = [explanation(model, probability=1.0 / len(models), known=known) for model in models]
    return Question.of(rivals, [1.0 / len(models)] * len(models), SEEN, LIMITS)


@cache
def found(stiffness: float) -> Found:
    """Which of two plants it is, by the first dozen of the family."""
    question = asking(PLANT, PLANT.with_values({"stiffness": stiffness}))
    result = search(question, family_of(question)[: LEADERS + 4])
    assert result is not None
    return result


def test_a_search_ends_with_the_first_profiles_that_decide() -> None:
    result = found(900.0)
    assert result.best.probability >= ENOUGH
    assert 0 < len(result.all) <= LEADERS, "the rest is not looked at"
    good = [one.profile.duration for one in result.all if one.probability >= ENOUGH]
    assert result.best.profile.duration == min(good)
    position = result.best.predictions[0].position
    low, high = float(position.min() - position[0]), float(position.max() - position[0])
    assert LIMITS.travel[0] <= low < high <= LIMITS.travel[1]
    LIMITS.check(result.best.profile)


def test_where_nothing_decides_the_best_of_all_is_told() -> None:
    """Twins: the closer looks cost their work, and all profiles are looked at."""
    result = found(PLANT.stiffness)
    assert len(result.all) > LEADERS
    assert result.best.probability < HOPELESS
    assert result.best.profile.name in {one.profile.name for one in result.all}


def test_refits_are_those_of_the_rivals_to_each_other() -> None:
    for result in (found(900.0), found(PLANT.stiffness)):
        assert [[one is None for one in row] for row in result.refits] == [[True, False], [False, True]]
        assert np.all(np.diag(result.best.shares) == 1.0)


def test_costly_refits_end_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Twins ask for three closer looks; with a budget that the first one uses up, there is one."""
    looks: list[int] = []
    shares = rival_refits.shares

    def looked(*asked: Any) -> Any:
        kept, refits = shares(*asked)
        looks.append(sum(one.simulated for row in refits for one in row if one is not None))
        return kept, refits

    monkeypatch.setattr(rival_refits, "shares", looked)
    question = asking(PLANT, PLANT)
    profiles = family_of(question)[:LEADERS]
    assert search(question, profiles) is not None and len(looks) > 1
    screened = sum(question.work(profile) for profile in profiles)
    monkeypatch.setattr(profile_search, "_SCREENING", (screened + 0.5 * looks[0]) / 1.5)
    del looks[1:]
    assert search(question, profiles) is not None and len(looks) == 2, "the first of before, and the one of now"


def test_no_profile_no_result() -> None:
    question = asking(PLANT, PLANT.with_values({"stiffness": 900.0}))
    assert search(question, []) is None


def test_a_search_stops_when_it_is_asked_to() -> None:
    question = asking(PLANT, PLANT.with_values({"stiffness": 900.0}))
    with cancellation.cancel_when(lambda: True), pytest.raises(cancellation.Cancelled):
        search(question, family_of(question))
