"""Verdicts: the rules in their order, no cause named below its rival, and words that say both halves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import pytest

from msd_ident.diagnosis import verdict
from msd_ident.diagnosis.result import Cause
from msd_ident.residuals.unexplained import Remainder, Remainders
from msd_ident.selection import naming
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import DECISIVE, Ranking

NAMES = ("backlash", "cogging", "coulomb_friction", "hysteresis", "quadratic_drag")
GAIN = HeldOut(1.0, 0.1, 90.0, (80.0, 95.0))


@dataclass(frozen=True, eq=False)
class Set:
    """What a ranking asks of a fitted set."""

    causes: frozenset[str]


def ranking(probabilities: Mapping[tuple[str, ...], float], first: tuple[str, ...] | None = None) -> Ranking:
    """Sets with given probabilities; as ``ranking.rank`` has it, ``first`` leads, the others by falling evidence."""
    order = sorted(probabilities, key=lambda causes: (causes != first, -probabilities[causes]))
    total = sum(probabilities.values())
    chances = tuple(probabilities[causes] / total for causes in order)
    sets = tuple(cast(Hypothesis, Set(frozenset(causes))) for causes in order)
    return Ranking(sets, tuple(np.log(chances).tolist()), chances)


def drawn(seed: int) -> Ranking:
    """Sets of one to three causes with any evidence; the simplest of those near the best leads."""
    rng = np.random.default_rng(seed)
    sets: dict[tuple[str, ...], float] = {}
    for _ in range(rng.integers(1, 9)):
        causes = tuple(sorted(rng.choice(NAMES, size=rng.integers(1, 4), replace=False).tolist()))
        sets[causes] = float(np.exp(-rng.exponential(3.0)))
    near = [causes for causes, p in sets.items() if p >= max(sets.values()) * np.exp(-DECISIVE)]
    return ranking(sets, min(near, key=len))


def left(motion: float, seen: bool = True, tolerance: float = 1.0) -> Remainders:
    base = Remainder(0.1, (0.08, 0.12), 5.0, 7.0, True)
    extended = Remainder(0.012, (0.01 if seen else 0.0, 0.015), 0.8, motion, seen)
    return Remainders(base, extended, "applied force", 2.0, "N", 0.01, 0.05, tolerance)


def cause(probability: float, tied: tuple[str, ...] = (), name: str = "coulomb_friction") -> Cause:
    return Cause(name, probability, {}, tied)


@pytest.mark.parametrize(
    ("causes", "remainder", "expected"),
    [
        ((), left(0.5), "adequate"),
        ((), left(30.0, seen=False), "adequate"),
        ((), left(1.5), "unexplained"),
        ((), left(1.5, tolerance=2.0), "adequate"),
        ((cause(0.99),), left(0.5), "explained"),
        ((cause(0.99),), left(30.0, seen=False), "explained"),
        ((cause(0.99),), left(1.5), "mostly_explained"),
        ((cause(0.9), cause(0.99, (), "cogging")), left(1.5), "mostly_explained"),
        ((cause(0.89), cause(0.99, (), "cogging")), left(1.5), "ambiguous"),
        ((cause(0.89),), left(0.5), "ambiguous"),
        ((cause(0.99, ("hysteresis",)),), left(0.5), "ambiguous"),
        ((cause(0.99, ("hysteresis",)),), left(90.0), "ambiguous"),
    ],
)
def test_the_rules_in_their_order(causes: tuple[Cause, ...], remainder: Remainders, expected: str) -> None:
    assert verdict.decide(causes, remainder) == expected


@pytest.mark.parametrize("seed", range(300))
def test_no_cause_is_named_with_less_probability_than_one_left_out(seed: int) -> None:
    """But where every explanation does so, and then the one left out stands beside it, tied."""
    given = drawn(seed)
    found = naming.leading(given)
    named = found.best.causes
    others = {name for one in found.sets for name in one.causes} - named
    near = [
        one.causes
        for one, value in zip(given.sets, given.evidence, strict=True)
        if value >= max(given.evidence) - DECISIVE
    ]
    assert named in near
    for name in named:
        above = {other for other in others if found.of_cause(other) > found.of_cause(name) + 1e-9}
        assert above <= set(naming.tied(found, name))
        if above:
            assert all(naming.margin(given, causes) < 0.0 for causes in near)
    if naming.margin(given, given.best.causes) >= 0.0:
        assert found.best is given.best


def test_the_simplest_leads_no_more_where_a_rival_is_likelier() -> None:
    given = ranking({("coulomb_friction",): 0.15, ("cogging", "hysteresis"): 0.85}, ("coulomb_friction",))
    found = naming.leading(given)
    assert found.best.causes == {"cogging", "hysteresis"}
    assert naming.tied(found, "cogging") == ("coulomb_friction",)


def test_a_set_that_predicts_nothing_takes_its_probability_with_it() -> None:
    given = ranking({("cogging",): 0.9, ("hysteresis",): 0.08, ("backlash",): 0.02})
    found = naming.without(given, given.best)
    assert found.best.causes == {"hysteresis"}
    assert found.of_cause("hysteresis") == pytest.approx(0.8) and found.of_cause("cogging") == 0.0


@pytest.mark.parametrize(
    ("name", "causes", "remainder", "words"),
    [
        ("explained", [cause(0.98)], left(0.4), ["The model lacks Coulomb friction (probability 0.98). With it, 0.4 % "
          "of the motion is still unexplained, less than the tolerance of 1 %: a missing force of 0.012 N rms (0.01 to "
          "0.015), 0.8 % of the applied force.", "The noise is 0.05 % of the motion.",
          "Without it, 7 % of the motion is unexplained; left-out data is predicted 90 % better (80 to 95 %)."]),
        ("explained", [cause(0.98)], left(0.4, seen=False), ["With it, the residual is consistent with noise: "
          "any slow missing force is below 0.015 N rms, 0.8 % of the applied force."]),
        ("mostly_explained", [cause(0.98), cause(0.95, (), "cogging")], left(4.0), ["Coulomb friction (probability "
          "0.98) and cogging (probability 0.95).", "With them, 4 % of the motion is still unexplained, more than the "
          "tolerance of 1 %", "DEPENDS"]),
        ("ambiguous", [cause(0.6, ("hysteresis",))], left(0.4), ["but this data cannot tell Coulomb friction from "
          "hysteresis."]),
        ("ambiguous", [cause(0.6)], left(0.4), ["Whether Coulomb friction acts at all is not certain."]),
        ("unexplained", [], left(4.0), ["Something is missing that no cause of the library explains.", "DEPENDS"]),
        ("adequate", [], left(0.0, seen=False), ["Mass, damping and stiffness are enough.", "consistent with noise"]),
    ],
)  # fmt: skip
def test_the_words(name: Any, causes: list[Cause], remainder: Remainders, words: list[str]) -> None:
    said = verdict.summary(name, causes, remainder, GAIN, "DEPENDS")
    for part in words:
        assert part in said
    assert ("DEPENDS" in said) == ("DEPENDS" in words)


def test_what_may_be_another_form_is_told_with_its_part() -> None:
    one = ranking({("backlash", "cogging"): 1.0, ("backlash",): 1e-9})
    told = naming.other_forms(replace(one, further={frozenset({"backlash", "cogging"}): {"cogging": 0.084}}))
    assert told == (
        "Cogging explains 8 % of what backlash explains: another form of that law could do the same, so it is not "
        "certain that it is a cause of its own.",
    )
    assert naming.other_forms(one) == ()
