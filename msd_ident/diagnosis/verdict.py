"""The verdict and its sentences: which causes act, with which probability; how much is left, compared with the
tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from msd_ident.diagnosis.result import Cause, Verdict
from msd_ident.estimate.levels import MOST_OF
from msd_ident.model.effects import by_name, spoken
from msd_ident.quantity import probability
from msd_ident.residuals.unexplained import Remainder, Remainders
from msd_ident.selection.certainty import certain
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.hypothesis import Causes


def decide(causes: Sequence[Cause], left: Remainders) -> Verdict:
    """The verdict, by the first rule that holds.

    1. No cause is named: ``unexplained`` where more than the tolerance is left, else ``adequate``.
    2. A named cause is tied, or has at most the probability ``CERTAIN``: ``ambiguous``, whatever is left.
    3. More than the tolerance is left: ``mostly_explained``. Else ``explained``.

    Args:
        causes: named causes with their probabilities and ties.
        left: unexplained motion of base and extended model.
    """
    if not causes:
        return "unexplained" if left.exceeds else "adequate"
    if any(cause.tied_with or not certain(cause.probability) for cause in causes):
        return "ambiguous"
    return "mostly_explained" if left.exceeds else "explained"


def summary(
    verdict: Verdict, causes: Sequence[Cause], left: Remainders, heldout: HeldOut, after: tuple[str, str]
) -> str:
    """The verdict in sentences.

    Args:
        verdict: as ``decide`` gives it.
        causes: named causes, strongest first.
        left: missing force and unexplained motion of base and extended model.
        heldout: prediction of left-out data.
        after: what follows on what is left, each empty where there is nothing to say: the signals that the remaining
            force depends on, and why explanations are not named that leave much less (``unpredicted``).
    """
    depends, unnamed = after
    if verdict == "adequate":
        return f"Mass, damping and stiffness are enough. {_left('With them', left)}"
    if verdict == "unexplained":
        faint = left.extended.motion_percent < left.noise_percent
        lead = "What is left is less than the noise but not noise alone, and" if faint else "Something is missing"
        if unnamed:
            lead += " this record does not show what it is." if faint else ", and this record does not show what it is."
        else:
            lead += " no cause of the library explains it." if faint else " that no cause of the library explains."
        return " ".join(filter(None, (lead, _left("With m, b, k", left), depends, unnamed)))
    them = "it" if len(causes) == 1 else "them"
    said = [
        f"The model {_lacks(causes)}{_ties(causes)}.",
        *_doubts(causes),
        *_readings(causes),
        _left(f"With {them}", left),
    ]
    if left.exceeds and depends:
        said.append(depends)
    before = f"Without {them}, {percent(left.base.motion_percent)} of the motion is unexplained"
    said.append(
        f"{before}; left-out data is predicted {heldout.reduction_percent:.3g} % better "
        f"({heldout.interval_percent[0]:.3g} to {heldout.interval_percent[1]:.3g} %)."
    )
    return " ".join(said)


def unpredicted(named: Causes, leading: Causes, leaving_less: Sequence[Causes]) -> str:
    """Why explanations are not named that lead or leave much less, a sentence; empty if one is, or if none does.

    Args:
        named: causes that are named.
        leading: those of the set that leads the ranking.
        leaving_less: those of sets that leave less than half of the error, the likeliest first.
    """
    if named or not (leading or leaving_less):
        return ""
    if leading:
        return (
            f"The leading explanation, {_together(leading)}, is not named: it predicts left-out data no better than "
            "m, b, k."
        )
    few = "would leave less than half of the error above the noise"
    if len(leaving_less) == 1:
        them = _together(leaving_less[0])
        return f"{them[0].upper()}{them[1:]} {few}, but is not named: the evidence does not call for all its numbers."
    them = "; ".join(map(_together, leaving_less))
    return f"Each of these {few}: {them}. None is named: the evidence does not call for all its numbers."


def _together(causes: Causes) -> str:
    return " and ".join(spoken(name) for name in sorted(causes))


def force(left: Remainder, unit: str) -> str:
    """The missing force with its interval, e.g. ``0.012 N rms (0.010 to 0.015)``, or its bound if none is detected; the
    interval alone where it is wide, and ``unknown size`` where the scale of all forces is open.

    Args:
        left: of one model.
        unit: of the force.
    """
    low, high = left.force_interval
    if math.isnan(left.force):
        return "unknown size"
    if not left.seen:
        return f"below {high:.2g} {unit} rms"
    if is_wide(left):
        return f"{low:.2g} to {high:.2g} {unit} rms"
    return f"{left.force:.2g} {unit} rms ({low:.2g} to {high:.2g})"


def is_wide(left: Remainder) -> bool:
    """Whether the interval of a missing force says so little that a number in it would say too much."""
    low, high = left.force_interval
    return left.seen and low < MOST_OF**2 * high


def percent(value: float) -> str:
    """A percentage with two digits, never in powers of ten."""
    return f"{value:.0f} %" if value >= 10.0 else f"{value:.2g} %" if value >= 0.01 else "less than 0.01 %"


def _beside(value: float, limit: float) -> str:
    """A percentage with as many digits as tell it from a limit."""
    if percent(value) != percent(limit):
        return percent(value)
    texts = (f"{value:.{digits}g}" for digits in range(3, 10))
    return next((f"{text} %" for text in texts if float(text) != limit), percent(value))


def _left(lead: str, left: Remainders) -> str:
    """How much stays unexplained, and whether that is more than the tolerance."""
    found, part = left.extended, part_of_force(left)
    if not found.seen:
        of = "of " if math.isnan(found.force) else ""
        missing = f"any slow missing force is {of}{force(found, left.force_unit)}{part}"
        return f"{lead}, the residual is consistent with noise: {missing}."
    tolerance = f"{'more' if left.exceeds else 'less'} than the tolerance of {left.tolerance_percent:g} %"
    unexplained = _beside(found.motion_percent, left.tolerance_percent)
    return (
        f"{lead}, {unexplained} of the motion is still unexplained, {tolerance}: a missing force of "
        f"{force(found, left.force_unit)}{part}. The noise is {percent(left.noise_percent)} of the motion."
    )


def part_of_force(left: Remainders) -> str:
    """The missing force of the extended model as a part of another force, after a comma; nothing without one."""
    found, share = left.extended, left.extended.force_percent
    most = found.force_interval[1]
    if not (math.isfinite(share) and math.isfinite(most)):
        return ""
    if is_wide(found) and found.force > 0.0:
        return f", up to {percent(share * most / found.force)} of the {left.yardstick}"
    return f", {percent(share)} of the {left.yardstick}"


def likely(cause: Cause) -> bool:
    """Whether it is likelier than not that a cause, or one of those tied with it, acts."""
    return cause.tied_probability > 0.5


def _lacks(causes: Sequence[Cause]) -> str:
    """What the model lacks, and what it may lack: causes that are likelier than not, and the others."""
    sure, open_ = [one for one in causes if likely(one)], [one for one in causes if not likely(one)]
    parts = [f"{verb} {_named(some)}" for verb, some in (("lacks", sure), ("may lack", open_)) if some]
    return ", and ".join(parts)


def _named(causes: Sequence[Cause]) -> str:
    words = [
        f"{spoken(cause.name)} (probability {probability(cause.probability)}{', in whatever law' * cause.in_any_law})"
        f"{' or a cause that looks like it' * (likely(cause) and not cause.probability > 0.5)}"
        for cause in causes
    ]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1] if words else ""


def _ties(causes: Sequence[Cause]) -> str:
    """Causes that the data does not tell apart, with the probability that one of them acts."""
    ties = [
        f"{spoken(c.name)} from {' or '.join(map(spoken, c.tied_with))} ({one_acts(c)})" for c in causes if c.tied_with
    ]
    return f", but this data cannot tell {'; '.join(ties)}" if ties else ""


def one_acts(cause: Cause) -> str:
    """How probable it is that a cause or one of those tied with it acts, in words."""
    return f"one of them acts: probability {probability(cause.tied_probability)}"


def _doubts(causes: Sequence[Cause]) -> Sequence[str]:
    """A sentence if it is open whether a cause acts, although no other one replaces it."""
    doubts = [spoken(cause.name) for cause in causes if not cause.tied_with and not certain(cause.probability)]
    act = "acts" if len(doubts) == 1 else "act"
    return [f"Whether {' and '.join(doubts)} {act} at all is not certain."] if doubts else []


def _readings(causes: Sequence[Cause]) -> Sequence[str]:
    """What else than a named cause may move the readings so, a sentence each."""
    pairs = [(spoken(cause.name), by_name(cause.name).or_else) for cause in causes]
    return [f"The {name} may also be {other}: no record tells them apart." for name, other in pairs if other]


def spread_sentence(spread: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
    """Range of the parameters over explanations, and laws of one cause, that the data does not distinguish."""
    if not spread:
        return ()
    moved = ", ".join(f"{name} {low:.4g} to {high:.4g}" for name, (low, high) in spread.items())
    said = "The data does not distinguish between some explanations or laws of one cause; between them the parameters"
    return (f"{said} are {moved}.",)
