"""What could still hide: effects that the measured data would not show, as rivals of the explanation that stands.

One step of one amplitude fits perfectly although the actuator's gain bends, the spring has play or a force offset acts:
the plant's parameters take the blame. For each effect of the library this finds the size at which the data would just
begin to object, with the plant refitted around it; those that may be of any size worth knowing become rivals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.design.cores import each
from msd_ident.design.discrimination import occam
from msd_ident.design.prediction import Predictor, Sensing, sensing
from msd_ident.diagnose import Contender, Diagnosis
from msd_ident.diagnose.contenders import marginal
from msd_ident.diagnose.evidence import PRIOR_ODDS
from msd_ident.errors import UsageError
from msd_ident.fit.posing import pose
from msd_ident.fit.units import Magnitudes, in_force_unit, magnitudes
from msd_ident.model import Effect, Model
from msd_ident.model.effects import LIBRARY
from msd_ident.record import FloatArray, Record

#: Rise of chi² below which the data cannot object; and sizes against the library's own guess that are worth a test.
_SILENT = 12.0
_SMALLEST = 0.1
_SHRINKS, _ROUNDS = 4, 14
#: Sizes of a play that are tried, in parts of the library's least guess: what it hides is no even function of its size.
_PLAYS = (1.0, 0.5, 0.25, 0.12)
#: Damping at which a fit gives up.
_STUCK = 1e6
_SAMPLES = 1200


def hidden(diagnosis: Diagnosis, seen: Sensing) -> tuple[Contender, ...]:
    """The explanation that stands first, then one rival for each effect that may hide behind it; alone if none may."""
    if not diagnosis.contenders:
        return ()
    lead = diagnosis.contenders[0]
    data = _measured(diagnosis, seen)
    found = each(lambda kind: _hiding(kind, lead, data), tuple(LIBRARY))
    return (lead, *(rival for rival in found if rival is not None))


def beside(diagnosis: Diagnosis, effect: Effect) -> Contender:
    """The explanation that stands with one more effect, of the size given, the rest refitted around it.

    Raises:
        UsageError: the effect does not go with it.
    """
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    return _refitted(diagnosis.contenders[0], effect, _measured(diagnosis, seen))[0]


def _measured(diagnosis: Diagnosis, seen: Sensing) -> _Data:
    lead = diagnosis.contenders[0]
    records = tuple(_thin(record) for record in diagnosis.records)
    told = Predictor(lead, 0.0)
    readings = tuple(
        told.readings(record, told.point[None, :], np.array([[was.position, was.zero]]), was.velocity)[0]
        for record, was in zip(records, lead.initial, strict=True)
    )
    return _Data(records, readings, seen, magnitudes(records, lead.model.mass))


def _thin(record: Record) -> Record:
    stride = max(record.samples // _SAMPLES, 1)
    return replace(record, time=record.time[::stride], position=record.position[::stride], force=record.force.copy())


@dataclass(frozen=True)
class _Data:
    """Measured records, thinned; the lead's readings (n,) of each; what an encoder sees; typical magnitudes."""

    records: tuple[Record, ...]
    readings: tuple[FloatArray, ...]
    seen: Sensing
    typical: Magnitudes

    def weight(self, record: Record) -> FloatArray:
        """(n,) weight over noise squared of each kept sample."""
        speed = np.abs(np.gradient(record.position, record.time))
        share = record.period / self.seen.period
        return np.asarray(self.seen.weight(speed) * (share / self.seen.noise**2))

    def resting(self, contender: Contender) -> Mapping[int, float]:
        """How well it is known under a contender where each record that begins at rest began [m], by its index."""
        kept = frozenset(contender.model.names) - set(contender.free)
        return {balance.record: balance.spread for balance in pose(contender.model, self.records, kept).balances}


def _hiding(kind: type[Effect], lead: Contender, data: _Data) -> Contender | None:
    """The rival that this effect makes at its largest silent size; ``None`` when it cannot hide."""
    shrinking = _shrinking(kind)
    if shrinking is None or lead.model.has(kind.name):
        return None
    record = max(data.records, key=lambda one: float(np.ptp(one.position)))
    best: tuple[float, Contender] | None = None
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


def _largest(lead: Contender, guess: Effect, shrinking: str, data: _Data) -> tuple[float, Contender] | None:
    """Part of the guessed size at which the data is still silent, and the rival there."""
    share = 1.0
    for _ in range(_SHRINKS):
        values = {p.name: v for p, v in zip(guess.parameters, guess.values, strict=True)}
        effect = type(guess).from_values(values | {shrinking: share * values[shrinking]})
        rival, rise = _refitted(lead, effect, data)
        if rise <= _SILENT:
            return share, rival
        share *= float(np.clip(0.9 * np.sqrt(_SILENT / rise), 0.02, 0.7))
        if share < _SMALLEST:
            return None
    return None


def _refitted(lead: Contender, effect: Effect, data: _Data) -> tuple[Contender, float]:
    """The rival with the lead's parameters refitted around the effect, and the rise of chi² that is left.

    The lead's readings stand for the data, so that the rise is the effect's own, without the noise.
    """
    tries = [_around(lead, lead.model + effect, effect, data)]
    gain = _gain(effect, data.records)
    if gain > 0.0 and gain != 1.0:  # another gain is another unit of force: no small step from one to the other
        model = lead.model.with_values(in_force_unit(lead.model, gain)) + effect
        tries.append(_around(lead, model, effect, data))
    return min(tries, key=lambda one: one[1])


def _playing(kind: type[Effect], lead: Contender, record: Record, shrinking: str, data: _Data) -> Contender | None:
    """The rival in which the cart began inside a play, of the size that the data allows; ``None`` without any.

    The lead has taken half the play for a start away from rest, and the stiffness for less. There is a valley of its
    own around the true size, and none of the smaller sizes leads there.
    """
    known = data.resting(lead)
    found: list[tuple[Contender, float, FloatArray]] = []
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
            found.append(_settled(lead, trial, len(lead.free), data, held))
    if not found:
        return None
    nearest = min(found, key=lambda one: one[1])[0]
    rival, rise, information = _settled(lead, nearest, len(nearest.free), data)
    if rise > _SILENT or rival.model[shrinking] < _SMALLEST * least:
        return None
    return _told(lead, rival, rise, information)


def _resting(trial: Contender) -> Contender:
    """Each record begins at rest in the middle, at the same reading."""
    initial = tuple(
        replace(one, position=0.0, zero=one.zero + one.position) if one.velocity == 0.0 else one
        for one in trial.initial
    )
    return replace(trial, initial=initial)


def _gain(effect: Effect, records: Sequence[Record]) -> float:
    """What the effect makes of the largest force, in parts of it; 1 when it is none of the input's."""
    law = effect.laws().get("input_map")
    largest = max((float(np.max(np.abs(record.force))) for record in records), default=0.0)
    return law(largest, *effect.values) / largest if law is not None and largest > 0.0 else 1.0


def _around(lead: Contender, model: Model, effect: Effect, data: _Data) -> tuple[Contender, float]:
    """The same from one start."""
    trial, rise, information = _settled(lead, _trial(lead, model, effect, data), len(lead.free), data)
    return _told(lead, trial, rise, information), rise


def _trial(lead: Contender, model: Model, effect: Effect, data: _Data) -> Contender:
    """A rival yet to be fitted: the lead's parameters first, the effect's own last."""
    own = tuple(p.name for p in effect.parameters if np.isfinite(model[p.name]))
    free = tuple(dict.fromkeys((*lead.free, *own)))
    sizes = dict(zip(lead.free, lead.scale, strict=True))
    scale = np.array([sizes.get(p, data.typical.of(_unit(model, p))) for p in free])
    return Contender(
        causes=tuple(sorted({*lead.causes, effect.name})), probability=0.0, evidence=lead.evidence, chi=lead.chi,
        model=model, free=free, scale=scale, information=np.zeros((len(free),) * 2), initial=lead.initial,
    )  # fmt: skip


def _told(lead: Contender, trial: Contender, rise: float, information: FloatArray) -> Contender:
    """The rival with its information, and its evidence beside the lead's."""
    trial = replace(trial, information=information)
    complete = Predictor(trial, 0.0)
    evidence = lead.evidence + np.log(PRIOR_ODDS) - 0.5 * rise + occam(complete, information)
    evidence -= occam(Predictor(lead, 0.0), lead.information)
    return replace(trial, evidence=float(evidence))


def _settled(
    lead: Contender, trial: Contender, moving: int, data: _Data, held: Sequence[int] = ()
) -> tuple[Contender, float, FloatArray]:
    """A trial moved to where it leaves least: the trial there, the rise of chi² over the lead's own, information.

    Damped steps (Levenberg–Marquardt), each from the best place so far: the valley of rest and samples is bent.

    Args:
        lead: whose readings stand for the data.
        trial: to begin with.
        moving: how many of its free parameters are fitted, the first ones.
        data: what was measured.
        held: entries that stay: after the parameters come each record's start position and zero.
    """
    resting, own = data.resting(trial), data.resting(lead)
    base = sum((_imbalance(lead, r)[0] / spread) ** 2 for r, spread in own.items())
    best: _System | None = None
    rise, damping = np.inf, 0.0
    for _ in range(_ROUNDS):
        predictor = Predictor(trial, 10.0 * data.seen.noise)
        rows = [_linearised(predictor, record, i, data) for i, record in enumerate(data.records)]
        system = _system(trial, rows, moving, resting)
        slow = best is not None and 0.8 * best.total < system.total <= best.total
        if best is None or system.total <= best.total:
            best, damping = system, 0.1 * damping
        else:
            damping = max(10.0 * damping, 1e-3)
        move, left = best.step(damping, held)
        trial, rise = _shifted(best.trial, move, moving), left - base
        if slow or rise < 0.2 * _SILENT or damping > _STUCK:
            break
    assert best is not None
    return trial, rise, best.information


def _unit(model: Model, name: str) -> str:
    return next(p.unit for p in model.parameters if p.name == name)


_Row = tuple[FloatArray, FloatArray, FloatArray]


def _linearised(predictor: Predictor, record: Record, index: int, data: _Data) -> _Row:
    """Difference (n,) of the trial's readings from the lead's, Jacobian (p + 2, n) and weight (n,) of one record."""
    start = predictor.contender.initial[index]
    at = np.array([start.position, start.zero])
    readings, jacobian = predictor.linearised(record, predictor.point, at, start.velocity)
    return readings - data.readings[index], jacobian, data.weight(record)


@dataclass(frozen=True)
class _System:
    """Normal equations around a trial.

    Attributes:
        trial: where they hold.
        normal, right: (s, s) and (s,), of the parameters that move and each record's start position and zero.
        total: weighted squares there.
        information: (p, p) of all free parameters.
    """

    trial: Contender
    normal: FloatArray
    right: FloatArray
    total: float
    information: FloatArray

    def step(self, damping: float, held: Sequence[int]) -> tuple[FloatArray, float]:
        """(s,) step, damped in units of each diagonal entry, some entries held; the squares that it should leave."""
        unit = np.sqrt(np.maximum(np.diag(self.normal), 1e-300))
        scaled = self.normal / np.outer(unit, unit) + damping * np.eye(unit.size)
        moved = np.setdiff1d(np.arange(unit.size), held)
        move = np.zeros(unit.size)
        move[moved] = -np.linalg.lstsq(scaled[np.ix_(moved, moved)], (self.right / unit)[moved], rcond=1e-12)[0]
        move /= unit
        left = self.total + 2.0 * float(self.right @ move) + float(move @ self.normal @ move)
        return move, max(left, 0.0)


def _system(trial: Contender, rows: Sequence[_Row], moving: int, resting: Mapping[int, float]) -> _System:
    """Normal equations of the first parameters, with the readings and with what rest at the start says."""
    count = len(trial.free)
    size = moving + 2 * len(rows)
    normal, right, total = np.zeros((size, size)), np.zeros(size), 0.0
    information = np.zeros((count, count))
    for i, row in enumerate(rows):
        difference, jacobian, weight = _beside_rest(trial, row, i, resting)
        whole = (jacobian * weight) @ jacobian.T
        information += marginal(whole, count)
        places = np.array([*range(moving), moving + 2 * i, moving + 2 * i + 1])
        entries = [*range(moving), count, count + 1]
        normal[np.ix_(places, places)] += whole[np.ix_(entries, entries)]
        right[places] += (jacobian[entries] * weight) @ difference
        total += float(weight @ difference**2)
    return _System(trial, normal, right, total, information)


def _beside_rest(trial: Contender, row: _Row, index: int, resting: Mapping[int, float]) -> _Row:
    """The same with one pseudo-reading more: the cart began where spring and offset cancel (``fit.Balance``)."""
    difference, jacobian, weight = row
    if index not in resting:
        return row
    rest, slope = _imbalance(trial, index)
    return (
        np.append(difference, rest),
        np.concatenate([jacobian, slope[:, None]], axis=1),
        np.append(weight, resting[index] ** -2.0),
    )


def _imbalance(trial: Contender, index: int) -> tuple[float, FloatArray]:
    """How far [m] a record begins from where spring and offset cancel, and its change (p + 2,) with all entries."""
    model = trial.model
    slope = np.zeros(len(trial.free) + 2)
    slope[-2] = 1.0
    lean = 0.0
    if model.has("force_offset") and model.stiffness > 0.0:
        lean = model["offset_force"] / model.stiffness
        slope[trial.free.index("offset_force")] = 1.0 / model.stiffness
    return trial.initial[index].position + lean, slope


def _shifted(trial: Contender, move: FloatArray, moving: int) -> Contender:
    """The trial after a step of its first parameters and of its records' start positions and zeros."""
    names = dict(zip(trial.free[:moving], move[:moving], strict=True))
    values = {n: max(trial.model[n] + d, 0.2 * trial.model[n]) for n, d in names.items() if trial.model[n] > 0.0}
    initial = tuple(
        replace(one, position=one.position + move[moving + 2 * i], zero=one.zero + move[moving + 2 * i + 1])
        for i, one in enumerate(trial.initial)
    )
    return replace(trial, model=trial.model.with_values(values), initial=initial)
