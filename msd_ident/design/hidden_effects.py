"""Effects that the measured data would not show, as rivals of the leading explanation.

A step of one amplitude is fitted perfectly although the actuator's gain is nonlinear, the spring has play or a force
offset acts: the plant's parameters take up the difference. For each effect of the library this looks for a size that
the data just does not contradict, with the plant refitted. Effects that may have a size worth knowing become rivals.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.design.discrimination import occam
from msd_ident.design.nearest_rival import SILENT, Measured, Moving, nearest
from msd_ident.design.prediction import Predictor, Sensing, sensing
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import UsageError
from msd_ident.estimate.effort import SAMPLES
from msd_ident.estimate.levels import NEGLIGIBLE, TENTH
from msd_ident.estimate.parameter_units import in_force_unit, magnitudes
from msd_ident.model import Effect, Model
from msd_ident.model.effects import LIBRARY
from msd_ident.parallel import each
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.evidence import log_prior

#: Sizes of a play that are tried, in parts of the least guess, halved each time: what it hides is no even function of
#: them.
_PLAYS = tuple(0.5**n for n in range(1 + int(-math.log2(TENTH))))
#: Rise of which a silent one is nothing at the smallest size of an effect either: chi² grows with the square of it.
_HOPELESS = SILENT / (NEGLIGIBLE * TENTH**2)


def hidden(diagnosis: Diagnosis, seen: Sensing) -> tuple[CandidateModel, ...]:
    """The leading explanation, then one rival for each effect that the data may hide.

    Args:
        diagnosis: its first contender is the leading explanation; the result is empty without contenders.
        seen: noise, encoder step and sample period of the rig.
    """
    if not diagnosis.contenders:
        return ()
    lead = diagnosis.contenders[0]
    data = _measured(diagnosis, seen)
    found = each(lambda kind: _hiding(kind, lead, data), tuple(LIBRARY))
    return (lead, *(rival for rival in found if rival is not None))


def beside(diagnosis: Diagnosis, effect: Effect) -> CandidateModel:
    """The leading explanation with one more effect of given size, its other parameters refitted.

    The readings of the leading explanation stand for the data.

    Args:
        diagnosis: its first contender is the leading explanation.
        effect: with its values, which are kept.

    Raises:
        UsageError: the effect does not go with the explanation.
    """
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    return _refitted(diagnosis.contenders[0], effect, _measured(diagnosis, seen))[0]


def _measured(diagnosis: Diagnosis, seen: Sensing) -> Measured:
    lead = diagnosis.contenders[0]
    records = tuple(_thin(record) for record in diagnosis.records)
    told = Predictor(lead, 0.0)
    readings = tuple(
        told.readings(record, told.point[None, :], np.array([[was.position, was.zero]]), was.velocity)[0]
        for record, was in zip(records, lead.initial, strict=True)
    )
    return Measured(records, readings, seen, magnitudes(records, lead.model.mass))


def _thin(record: Record) -> Record:
    stride = max(record.samples // SAMPLES, 1)
    return replace(record, time=record.time[::stride], position=record.position[::stride], force=record.force.copy())


def _hiding(kind: type[Effect], lead: CandidateModel, data: Measured) -> CandidateModel | None:
    """The rival that this effect makes at its largest silent size; ``None`` when it cannot hide."""
    shrinking = _shrinking(kind)
    if shrinking is None or lead.model.has(kind.name):
        return None
    record = max(data.records, key=lambda one: float(np.ptp(one.position)))
    best: tuple[float, CandidateModel] | None = None
    for guess in _guesses(kind, record, lead.model):
        found = _largest(lead, guess, shrinking, data)
        if found is not None and (best is None or found[0] > best[0]):
            best = found
    if best is None:
        return _playing(kind, lead, record, shrinking, data)
    return best[1]


def _shrinking(kind: type[Effect]) -> str | None:
    """Name of the parameter that makes the effect vanish at 0, if just one does; time may not drive it."""
    zeros = [name for name, value in kind.neutral if value == 0.0]
    return zeros[0] if len(zeros) == 1 and kind.steady else None


def _guesses(kind: type[Effect], record: Record, model: Model) -> Sequence[Effect]:
    try:
        model + kind.guess(record, model)[0]
    except (UsageError, IndexError):  # its family is taken, or there is no spring for it
        return ()
    return kind.guess(record, model)[:2]


def _largest(
    lead: CandidateModel, guess: Effect, shrinking: str, data: Measured
) -> tuple[float, CandidateModel] | None:
    """Part of the guessed size at which the data is still silent, and the rival there."""
    share = 1.0
    while share >= TENTH:
        values = {p.name: v for p, v in zip(guess.parameters, guess.values, strict=True)}
        effect = type(guess).from_values(values | {shrinking: share * values[shrinking]})
        rival, rise = _refitted(lead, effect, data, _HOPELESS)
        if rise <= SILENT:
            return share, rival
        share *= float(np.clip(0.9 * np.sqrt(SILENT / rise), 0.02, 0.7))
    return None


def _refitted(
    lead: CandidateModel, effect: Effect, data: Measured, hopeless: float = math.inf
) -> tuple[CandidateModel, float]:
    """The rival with the lead's parameters refitted around the effect, and the rise of chi² that is left.

    The readings of the leading explanation stand for the data, so that the rise contains no noise.
    """
    tries = [_around(lead, lead.model + effect, effect, data, hopeless)]
    gain = _gain(effect, data.records)
    if gain > 0.0 and gain != 1.0:  # another gain is another unit of force: no small step from one to the other
        model = lead.model.with_values(in_force_unit(lead.model, gain)) + effect
        tries.append(_around(lead, model, effect, data, hopeless))
    return min(tries, key=lambda one: one[1])


def _playing(
    kind: type[Effect], lead: CandidateModel, record: Record, shrinking: str, data: Measured
) -> CandidateModel | None:
    """The rival in which the cart began inside a play, of the size that the data allows; ``None`` without any.

    The lead has taken half the play for a start away from rest, and the stiffness for less. There is a valley of its
    own around the true size, and none of the smaller sizes leads there.
    """
    known = data.resting(lead)
    found: list[tuple[CandidateModel, float, FloatArray]] = []
    for guess in _guesses(kind, record, lead.model)[:1]:
        values = {p.name: v for p, v in zip(guess.parameters, guess.values, strict=True)}
        least = values[shrinking]
        for share in _PLAYS:
            effect = kind.from_values(values | {shrinking: share * least})
            trial = _resting(_trial(lead, lead.model + effect, effect, data))
            wider = data.resting(trial)
            if not any(spread > known[r] + 0.5 * share * least for r, spread in wider.items() if r in known):
                return None  # the cart begins where it would without the effect
            held = tuple(len(lead.free) + 2 * r for r in range(len(data.records)))
            found.append(nearest(lead, trial, Moving(len(lead.free), held), data, _HOPELESS))
    if not found:
        return None
    held_start = min(found, key=lambda one: one[1])[0]
    rival, rise, information = nearest(lead, held_start, Moving(len(held_start.free)), data, _HOPELESS)
    if rise > SILENT or rival.model[shrinking] < TENTH * least:
        return None
    return _told(lead, rival, rise, information)


def _resting(trial: CandidateModel) -> CandidateModel:
    """The trial with each record that begins at rest begun at the relaxed spring, at the same reading."""
    initial = tuple(
        replace(one, position=0.0, zero=one.zero + one.position) if one.velocity == 0.0 else one
        for one in trial.initial
    )
    return replace(trial, initial=initial)


def _gain(effect: Effect, records: Sequence[Record]) -> float:
    """Gain of the effect at the largest force; 1 if it does not act on the input."""
    largest = max((float(np.max(np.abs(record.force))) for record in records), default=0.0)
    return effect.pushes(largest) / largest if largest > 0.0 else 1.0


def _around(
    lead: CandidateModel, model: Model, effect: Effect, data: Measured, hopeless: float
) -> tuple[CandidateModel, float]:
    """The same from one start."""
    began, moving = _trial(lead, model, effect, data), Moving(len(lead.free))
    trial, rise, information = nearest(lead, began, moving, data, hopeless)
    return _told(lead, trial, rise, information), rise


def _trial(lead: CandidateModel, model: Model, effect: Effect, data: Measured) -> CandidateModel:
    """A rival yet to be fitted: the lead's parameters first, the effect's own last."""
    own = tuple(p.name for p in effect.parameters if np.isfinite(model[p.name]))
    free = tuple(dict.fromkeys((*lead.free, *own)))
    sizes = dict(zip(lead.free, lead.scale, strict=True))
    scale = np.array([sizes.get(p, data.typical.of(_unit(model, p))) for p in free])
    return CandidateModel(
        causes=tuple(sorted({*lead.causes, effect.name})), probability=0.0, evidence=lead.evidence, chi=lead.chi,
        model=model, free=free, scale=scale, information=np.zeros((len(free),) * 2), initial=lead.initial,
    )  # fmt: skip


def _told(lead: CandidateModel, trial: CandidateModel, rise: float, information: FloatArray) -> CandidateModel:
    """The rival with its information, and its evidence beside the lead's."""
    trial = replace(trial, information=information)
    complete = Predictor(trial, 0.0)
    prior = log_prior(frozenset(trial.causes) - set(lead.causes))
    evidence = lead.evidence + prior - 0.5 * rise + occam(complete, information)
    evidence -= occam(Predictor(lead, 0.0), lead.information)
    return replace(trial, evidence=float(evidence))


def _unit(model: Model, name: str) -> str:
    return next(p.unit for p in model.parameters if p.name == name)
