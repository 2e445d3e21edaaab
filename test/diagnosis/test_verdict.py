"""Verdicts: the rules in their order, and words that say both halves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from msd_ident.diagnosis import verdict
from msd_ident.diagnosis.result import Cause
from msd_ident.residuals.unexplained import Remainder, Remainders
from msd_ident.selection.cross_validation import HeldOut

GAIN = HeldOut(1.0, 0.1, 90.0, (80.0, 95.0))


def left(motion: float, seen: bool = True, tolerance: float = 1.0) -> Remainders:
    base = Remainder(0.1, (0.08, 0.12), 5.0, 7.0, True)
    extended = Remainder(0.012, (0.01 if seen else 0.0, 0.015), 0.8, motion, seen)
    return Remainders(base, extended, "applied force", 2.0, "N", 0.01, 0.05, tolerance)


def cause(probability: float, tied: tuple[str, ...] = (), name: str = "coulomb_friction") -> Cause:
    return Cause(name, probability, {}, tied, 0.97 if tied else probability)


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
        ((cause(0.91), cause(0.99, (), "cogging")), left(1.5), "mostly_explained"),
        ((cause(0.9), cause(0.99, (), "cogging")), left(1.5), "ambiguous"),
        ((cause(0.89),), left(0.5), "ambiguous"),
        ((cause(0.99, ("hysteresis",)),), left(0.5), "ambiguous"),
        ((cause(0.99, ("hysteresis",)),), left(90.0), "ambiguous"),
    ],
)
def test_the_rules_in_their_order(causes: tuple[Cause, ...], remainder: Remainders, expected: str) -> None:
    assert verdict.decide(causes, remainder) == expected


@pytest.mark.parametrize(
    ("name", "causes", "remainder", "words"),
    [
        ("explained", [cause(0.98)], left(0.4), ["The model lacks Coulomb friction (probability 98.0 %). With it, "
          "0.4 % of the motion is still unexplained, less than the tolerance of 1 %: a missing force of 0.012 N rms "
          "(0.01 to 0.015), 0.8 % of the applied force.", "The noise is 0.05 % of the motion.",
          "Without it, 7 % of the motion is unexplained; left-out data is predicted 90 % better (80 to 95 %)."]),
        ("explained", [cause(0.98)], left(0.4, seen=False), ["With it, the residual is consistent with noise: "
          "any slow missing force is below 0.015 N rms, 0.8 % of the applied force."]),
        ("mostly_explained", [cause(0.98), cause(0.95, (), "cogging")], left(4.0), ["Coulomb friction (probability "
          "98.0 %) and cogging (probability 95.0 %).", "With them, 4 % of the motion is still unexplained, more "
          "than the tolerance of 1 %", "DEPENDS"]),
        ("ambiguous", [cause(0.6, ("hysteresis",))], left(0.4), ["but this data cannot tell Coulomb friction from "
          "hysteresis (one of them acts: probability 97.0 %)."]),
        ("ambiguous", [cause(0.025, ("hysteresis",))], left(0.4), ["The model lacks Coulomb friction (probability "
          "2.5 %) or a cause that looks like it, but this data cannot tell Coulomb friction from hysteresis (one of"]),
        ("ambiguous", [cause(0.6)], left(0.4), ["Whether Coulomb friction acts at all is not certain."]),
        ("ambiguous", [cause(0.6), cause(0.7, (), "bouc_wen")], left(0.4), ["Whether Coulomb friction and Bouc-Wen act "
          "at all is not certain."]),
        ("ambiguous", [cause(0.4, (), "cogging")], left(0.4), ["The model may lack cogging (probability 40.0 %)."]),
        ("ambiguous", [cause(0.7), cause(0.4, (), "cogging"), cause(0.3, (), "bouc_wen")], left(0.4), [
          "The model lacks Coulomb friction (probability 70.0 %), and may lack cogging (probability 40.0 %) and "
          "Bouc-Wen (probability 30.0 %)."]),
        ("explained", [cause(0.98, (), "relaxing_spring")], left(0.4), ["The relaxing spring may also be a drive that "
          "gives way and lags (a motor's back-EMF behind its inductance, air in a cylinder): no record tells them "
          "apart."]),
        ("explained", [replace(cause(0.96, (), "bouc_wen"), in_any_law=True)], left(0.4), ["The model lacks Bouc-Wen "
          "(probability 96.0 %, in whatever law). With it,"]),
        ("unexplained", [], left(1.004), ["1.004 % of the motion is still unexplained, more than the tolerance of 1 %",
          "DEPENDS"]),
        ("explained", [cause(0.98)], left(0.996), ["0.996 % of the motion is still unexplained, less than the"]),
        ("unexplained", [], left(4.0), ["Something is missing that no cause of the library explains.", "DEPENDS"]),
        ("unexplained", [], left(0.04), ["What is left is less than the noise but not noise alone, and no cause of the "
          "library explains it.", "DEPENDS"]),
        ("adequate", [], left(0.0, seen=False), ["Mass, damping and stiffness are enough.", "consistent with noise"]),
    ],
)  # fmt: skip
def test_the_words(name: Any, causes: list[Cause], remainder: Remainders, words: list[str]) -> None:
    said = verdict.summary(name, causes, remainder, GAIN, ("DEPENDS", ""))
    for part in words:
        assert part in said
    assert ("DEPENDS" in said) == ("DEPENDS" in words)


def test_a_missing_force_without_a_scale_is_of_unknown_size() -> None:
    noise = left(0.0, seen=False)
    noise = replace(noise, extended=replace(noise.extended, force=math.nan, force_percent=math.nan))
    said = verdict.summary("adequate", [], noise, GAIN, ("", ""))
    assert said.endswith("consistent with noise: any slow missing force is of unknown size.")


def test_of_a_missing_force_that_is_hardly_known_the_interval_is_told() -> None:
    """ "1 A rms (0.041 to 1), 173 % of the applied force" was told, and a regression on the motion left 0.21 A."""
    found = left(4.0)
    wide = replace(found, extended=replace(found.extended, force_interval=(0.001, 0.012)))
    said = verdict.summary("unexplained", [], wide, GAIN, ("", ""))
    assert ": a missing force of 0.001 to 0.012 N rms, up to 0.8 % of the applied force." in said
    none = replace(wide, extended=replace(wide.extended, force=0.0, force_interval=(0.0, 1.0)))
    assert ": a missing force of 0 to 1 N rms" in verdict.summary("unexplained", [], none, GAIN, ("", ""))
    endless = replace(wide, extended=replace(wide.extended, force_interval=(0.001, math.inf)))
    assert "inf %" not in verdict.summary("unexplained", [], endless, GAIN, ("", ""))
    assert "0.012 N rms (0.01 to 0.015), 0.8 %" in verdict.summary("unexplained", [], found, GAIN, ("", ""))


def test_a_leading_explanation_that_is_not_named_is_said_with_the_reason() -> None:
    said = verdict.unpredicted(frozenset(), frozenset({"coulomb_friction", "bouc_wen"}), frozenset())
    assert said.startswith("The leading explanation, Bouc-Wen and Coulomb friction, is not named: it predicts left-out")
    named = frozenset({"cogging"})
    assert verdict.unpredicted(named, named, [named]) == verdict.unpredicted(frozenset(), frozenset(), []) == ""
    said = verdict.unpredicted(frozenset(), frozenset(), [frozenset({"two_tone_disturbance"})])
    assert said.startswith("Two tone disturbance would leave less than half of the error above the noise, but is")
    said = verdict.unpredicted(frozenset(), frozenset(), [frozenset({"cogging"}), frozenset({"bouc_wen", "gravity"})])
    assert "above the noise: cogging; Bouc-Wen and gravity. None is named: the evidence does not call" in said


@pytest.mark.parametrize(("percent", "lead"), [(4.0, "Something is missing, and"), (0.04, "not noise alone, and")])
def test_it_is_not_said_that_no_cause_explains_what_some_would(percent: float, lead: str) -> None:
    """A mass on a spring (public record) leaves 1.5 noise floors, and 1.05 with a spring that stiffens."""
    said = verdict.summary("unexplained", [], left(percent), GAIN, ("", "COGGING WOULD"))
    assert f"{lead} this record does not show what it is." in said and said.endswith("COGGING WOULD")
    assert "no cause of the library explains" not in said
