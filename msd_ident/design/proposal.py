"""The proposed experiment with its reasons, for the user and the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.design import deciding_measurements as measurements
from msd_ident.design import profile_search, safety
from msd_ident.design.deciding_measurements import IN_VAIN
from msd_ident.design.evaluation import Option, Question, exciting, family_of
from msd_ident.design.hidden_effects import hidden
from msd_ident.design.library import why
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import sensing
from msd_ident.design.profile import Profile
from msd_ident.design.profile_file import to_tree
from msd_ident.design.profile_search import HOPELESS
from msd_ident.design.rival_refits import Refitted
from msd_ident.design.rivals import names, rivals, shares
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import UsageError
from msd_ident.estimate import opposite_signs
from msd_ident.estimate.levels import ALIKE
from msd_ident.estimate.result import scale_known


@dataclass(frozen=True)
class Proposal:
    """A designed experiment.

    Attributes:
        profile: to be played; the best that was found, where none is worth playing (``IN_VAIN``).
        names: what each rival is called.
        probability: that it decides, if one of the rivals is true.
        decided: (r,) the same for each rival.
        travel: least and greatest reading from the start [m], whichever rival is right.
        peak_speed: [m/s], likewise.
        time: (n,) instants [s] of the predictions.
        predictions: (r, n) readings that each rival predicts [m].
        difference: (n,) what the two closest rivals still differ by after a refit [m].
        pair: their indices.
        noise: of a reading [m].
        considered: (name, duration [s], probability) of every profile that was looked at, the best first.
        sentence: what to do and why; where no profile is worth playing, what to do instead.
        measurements: what distinguishes rivals that no profile distinguishes.
        unit, length: of force and position.
    """

    profile: Profile
    names: tuple[str, ...]
    probability: float
    decided: FloatArray
    travel: tuple[float, float]
    peak_speed: float
    time: FloatArray
    predictions: FloatArray
    difference: FloatArray
    pair: tuple[int, int]
    noise: float
    considered: tuple[tuple[str, float, float], ...]
    sentence: str
    measurements: tuple[str, ...]
    unit: str = "N"
    length: str = "m"

    def to_json_dict(self) -> dict[str, Any]:
        """``next_experiment`` of the JSON contract."""
        return {
            "sentence": self.sentence,
            "duration_s": self.profile.duration,
            "probability_of_decision": self.probability,
            "separates": list(self.names),
            "decided": dict(zip(self.names, map(float, self.decided), strict=True)),
            "travel_m": list(self.travel),
            "peak_speed_m_s": self.peak_speed,
            "peak_force": max(map(abs, self.profile.extremes)),
            "profile": to_tree(self.profile),
            "measurements": list(self.measurements),
        }


def design(diagnosis: Diagnosis, limits: Limits) -> Proposal | None:
    """The shortest profile that decides between the tied explanations of a diagnosis; ``None`` without a tie.

    Args:
        diagnosis: with tied explanations, or an ambiguous one.
        limits: what the rig allows.

    Raises:
        UsageError: no experiment of the family has room within the limits.
    """
    chosen = rivals(diagnosis)
    if len(chosen) < 2:
        return None
    seen = replace(sensing(diagnosis.records, diagnosis.noise_floor), variance=chosen[0].variance)
    question = Question.of(chosen, shares(chosen), seen, limits, diagnosis.records)
    return _proposed(question, diagnosis, names(chosen), "parts")


def check(diagnosis: Diagnosis, limits: Limits) -> Proposal | None:
    """The profile that best reveals causes which the data cannot show yet; ``None`` if none can be hidden.

    Args:
        diagnosis: of any verdict.
        limits: what the rig allows.

    Raises:
        UsageError: no experiment of the family has room within the limits.
    """
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    chosen = hidden(diagnosis, seen)
    if len(chosen) < 2:
        return None
    hiding, seen = len(chosen) - 1, replace(seen, variance=chosen[0].variance)
    question = Question.of(chosen, [0.5, *[0.5 / hiding] * hiding], seen, limits, diagnosis.records)
    return _proposed(question, diagnosis, names(chosen), "shows")


def proposing(diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis with the next experiment in it, where its verdict is ambiguous.

    The limits are those that its records suggest: the force and the travel that they had.
    """
    if diagnosis.verdict != "ambiguous":
        return diagnosis
    try:
        check_predictable(diagnosis)
        limits = default_limits(diagnosis)
        found = design(diagnosis, limits)
    except UsageError:
        return diagnosis  # nothing pushes or moves, how far is unknown, or there is no room
    if found is None:
        return diagnosis
    return replace(diagnosis, next_experiment=with_limits(found.to_json_dict(), limits))


def check_predictable(diagnosis: Diagnosis) -> None:
    """Refuse records that do not show how far a force moves the rig, or whose fitted values may be of another one.

    Raises:
        UsageError: mass, damping and stiffness of the diagnosed model are all open, no force acts, so that they are
            those of an assumed mass, or a regression gives mass and stiffness of opposite signs (``signs_doubt``).
    """
    if not any(np.any(record.force) for record in diagnosis.records):
        raise UsageError(
            "no force acts in these records, so how far a force moves the rig is unknown and no experiment can be "
            "designed; expected a record with a force: record a step, and give both"
        )
    if not scale_known(diagnosis.extended.quantities):
        raise UsageError(
            "these records do not show how far a force moves the rig, so no experiment can be designed; expected a "
            "record whose motion the force makes: push harder or longer, or cut it with --start and --end"
        )
    if said := signs_doubt(diagnosis):
        raise UsageError(
            f"no experiment can be designed from these records: {said[0].lower()}{said[1:]}; expected a record of a "
            "stable rig with the force that acts on it"
        )


def signs_doubt(diagnosis: Diagnosis) -> str:
    """A sentence where mass and stiffness have opposite signs and more than the tolerance is left, else an empty one.

    Without its controller such a rig might not survive an experiment.
    """
    return opposite_signs.warning(diagnosis.records) if diagnosis.left.exceeds else ""


def default_limits(diagnosis: Diagnosis) -> Limits:
    """Limits that a record suggests: the force that it had, either way, the travel that it had, 20 s.

    Raises:
        UsageError: no force acts in it, or nothing moves.
    """
    force = max(float(np.max(np.abs(record.force))) for record in diagnosis.records)
    travel = max(float(np.max(np.abs(record.position - record.position[0]))) for record in diagnosis.records)
    return Limits((-force, force), (-travel, travel), 20.0)


def _proposed(question: Question, diagnosis: Diagnosis, called: Sequence[str], verb: str) -> Proposal:
    unit, length = diagnosis.records[0].force_unit, diagnosis.records[0].position_unit
    rich, plain = exciting(question, family_of(question, unit), diagnosis.records)
    if verb == "parts":
        found = profile_search.search(question, [*rich, *plain])
    else:
        found = profile_search.search(question, rich) or profile_search.search(question, plain)
    if found is None:
        raise question.limits.no_room(unit, length)
    option, refits = found.best, found.refits
    apart = _hopeless(question, found.all, called, length)
    pair = _closest_pair(option)
    left = refits[pair[0]][pair[1]]
    assert left is not None
    beyond = diagnosis.adequacy.ratio
    hardest = _hardest(option, (called[pair[0]], called[pair[1]]), left, (question.sensing.noise, beyond))
    low, high, speed = safety.extremes(question.predictors, option.grid.record)
    sentence = f"{_sentence(option, called, verb, unit, beyond)} {hardest} {_moved((low, high), speed, length)}"
    likely = option.probability if verb == "parts" else _shown(option, called)[0]
    if (likely if verb == "parts" else float(np.max(option.parting.decided[1:]))) < IN_VAIN:
        sentence = _instead(called, verb, [what for *_, what in apart])
    looked = sorted(found.all, key=lambda one: -one.probability)
    return Proposal(
        profile=option.profile,
        names=tuple(called),
        probability=likely,
        decided=option.parting.decided,
        travel=(low, high),
        peak_speed=speed,
        time=option.grid.record.time,
        predictions=np.stack([one.position for one in option.predictions]),
        difference=left.difference,
        pair=pair,
        noise=question.sensing.noise,
        considered=tuple((one.profile.name, one.profile.duration, one.probability) for one in looked),
        sentence=sentence,
        measurements=measurements.between(apart),
        unit=unit,
        length=length,
    )


def _closest_pair(option: Option) -> tuple[int, int]:
    """The two rivals that are hardest to tell apart: (true, refitted).

    A law that is a special case of another one is found again by its refit, whatever is played: simplicity decides
    then. What a profile shows of a pair is what is left when the richer one of them is true.
    """
    chi = option.parting.chi
    told = option.parting.decided >= HOPELESS
    true = [a for a in range(len(chi)) if told[a] or not told.any()]
    shown: dict[frozenset[int], tuple[int, int]] = {}
    for a in true:
        for b in range(len(chi)):
            other = shown.get(frozenset({a, b}))
            if a != b and (other is None or chi[a, b] > chi[other]):
                shown[frozenset({a, b})] = (a, b)
    return min(shown.values(), key=lambda pair: float(chi[pair]))


def _hopeless(
    question: Question, found: Sequence[Option], called: Sequence[str], length: str
) -> list[tuple[str, str, str]]:
    """Rivals that the best profile for them does not find out, each with the closest one and what to measure;
    ``length``: unit of the position.
    """
    best = np.max([option.parting.decided for option in found], axis=0)
    pairs = []
    for a in map(int, np.flatnonzero((best < HOPELESS) & (question.truths > 0.0))):
        chi = np.max([option.parting.chi[a] for option in found], axis=0)
        chi[a] = np.inf
        b = int(np.argmin(chi))
        what = measurements.measurement(question.contenders[a], question.contenders[b], length)
        pairs.append((called[a], called[b], what))
    return pairs


def _hardest(option: Option, pair: tuple[str, str], left: Refitted, floors: tuple[float, float]) -> str:
    """Which two rivals are hardest to tell apart, and what a refit leaves, in words; ``floors``: noise of a reading
    [m], and what the model leaves of the measured record, in such noise.
    """
    noise, model = floors
    worst = int(np.argmax(np.abs(left.difference)))
    levels = abs(float(left.difference[worst])) / noise
    shown = f"{levels:.0f}" if levels >= 100.0 else f"{levels:.3g}"
    beside = f" (the model leaves {model:.3g})" if model > ALIKE else ""
    return (
        f"The most difficult pair is {pair[0]} and {pair[1]}: even after a refit they differ by up to {shown} "
        f"noise levels{beside}, at {option.grid.record.time[worst]:.1f} s."
    )


def _instead(called: Sequence[str], verb: str, told: Sequence[str]) -> str:
    """What to do where no profile is worth playing, in words; ``told``: what to measure."""
    what = f"tell {' or '.join(called)}" if verb == "parts" else f"show {', '.join(called[1:])}"
    measure = f"Measure in place of it: {'; '.join(dict.fromkeys(told))}. Or allow" if told else "Allow"
    return (
        f"No experiment is proposed: no profile within the limits is likely to {what} (the best one with a probability "
        f"below {IN_VAIN:g}). {measure} more force, travel or time."
    )


def _sentence(option: Option, called: Sequence[str], verb: str, unit: str, beyond: float = 1.0) -> str:
    """What to do and why, in words; ``unit`` of the force, ``beyond``: noise floors that the model leaves."""
    profile = option.profile
    low, high = profile.extremes
    force = f"with {low:.3g} to {high:.3g} {unit}" if low < high else "without force"
    what = "tell" if verb == "parts" else "show"
    aim = " or ".join(called) if verb == "parts" else ", ".join(called[1:])
    likely = option.probability
    if verb != "parts":
        likely, aim = _shown(option, called)
    chance = f"{likely:.2f}" if likely < 1.0 - IN_VAIN else "above 0.99"
    promise = f"It should {what} {aim} with probability {chance}"
    if likely < HOPELESS:
        promise = f"No profile within the limits is likely to {what} {aim}; this one does with probability {chance}"
    promise += ", if one of these is the law of the rig." if verb == "parts" and beyond > ALIKE else "."
    return f"Play {profile.name!r} for {profile.duration:.1f} s {force}: {why(profile.name)}. {promise}"


def _shown(option: Option, called: Sequence[str]) -> tuple[float, str]:
    """The least probability with which a profile shows what it is likely to show, and the names of that; of all that
    may be hidden, with the mean, where it is likely to show none of them.
    """
    hidden = option.parting.decided[1:]
    seen = hidden >= HOPELESS
    if not seen.any():
        return float(np.mean(hidden)), ", ".join(called[1:])
    names = [name for name, one in zip(called[1:], seen, strict=True) if one]
    return float(np.min(hidden[seen])), ", ".join(names)


def _moved(travel: tuple[float, float], speed: float, unit: str) -> str:
    """How far the rig will move, and how fast, in words; ``unit`` of the position."""
    moves = "joint will turn" if unit == "rad" else "cart will move"
    return (
        f"The {moves} {travel[0]:.3g} to {travel[1]:.3g} {unit} from its start, at {speed:.3g} {unit}/s at most, "
        "whichever of them is true."
    )


def with_limits(found: Mapping[str, Any], limits: Limits) -> dict[str, Any]:
    """``next_experiment`` of the JSON contract, with the limits that it was designed for.

    Args:
        found: result of ``Proposal.to_json_dict``.
        limits: the limits.
    """
    return {**found, "limits": limits.to_dict()}
