"""A rival, refitted so that its readings are as close as possible to those of the leading explanation.

The readings of the leading explanation stand for the data, so that the difference contains no noise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.design.prediction import Predictor, Sensing
from msd_ident.estimate.effort import LOOK, SHORT
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.levels import STUCK
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.model.base_model import OFFSET, OFFSET_FORCE
from msd_ident.selection.candidate_models import CandidateModel, marginal
from msd_ident.selection.ranking import NEAR

#: Rise of chi² below which the data cannot object: twice the evidence at which a set is kept.
SILENT = NEAR


@dataclass(frozen=True)
class Measured:
    """What was measured, for refits of rivals.

    Attributes:
        records: thinned.
        readings: (n,) readings of the leading explanation in each [m].
        seen: noise, encoder step and sample period of the rig.
        typical: typical force, length and time.
    """

    records: tuple[Record, ...]
    readings: tuple[FloatArray, ...]
    seen: Sensing
    typical: Magnitudes

    def weight(self, record: Record) -> FloatArray:
        """(n,) weight over noise squared of each kept sample."""
        speed = np.abs(np.gradient(record.position, record.time))
        share = record.period / self.seen.period
        return np.asarray(self.seen.weight(speed) * (share / self.seen.noise**2))

    def resting(self, contender: CandidateModel) -> Mapping[int, float]:
        """How well it is known under a contender where each record that begins at rest began [m], by its index."""
        kept = frozenset(contender.model.names) - set(contender.free)
        return {balance.record: balance.spread for balance in formulate(contender.model, self.records, kept).balances}


@dataclass(frozen=True)
class Moving:
    """Which entries of a trial are fitted.

    Attributes:
        parameters: how many of its free parameters, the first ones.
        held: entries that stay; after the parameters come each record's start position and zero.
    """

    parameters: int
    held: Sequence[int] = ()


def nearest(
    lead: CandidateModel,
    trial: CandidateModel,
    moving: Moving,
    data: Measured,
    hopeless: float = math.inf,
) -> tuple[CandidateModel, float, FloatArray]:
    """Refit of a trial to the readings of the leading explanation, by Levenberg–Marquardt.

    Args:
        lead: the leading explanation, whose readings stand for the data.
        trial: the rival to start from.
        moving: which of its entries are fitted.
        data: what was measured.
        hopeless: increase of chi² beyond which the trial is useless; the search ends when no step predicts less.

    Returns:
        The refitted trial, its increase of chi² over that of the leading explanation, and the information (p, p) about
        its free parameters.
    """
    resting, own = data.resting(trial), data.resting(lead)
    base = sum((_imbalance(lead, r)[0] / spread) ** 2 for r, spread in own.items())
    best: _System | None = None
    count = moving.parameters
    begun = _values(trial, count)
    rise, promised, damping = np.inf, np.inf, 0.0
    for turn in range(SHORT):
        predictor = Predictor(trial, 10.0 * data.seen.noise)
        rows = [_linearised(predictor, record, i, data) for i, record in enumerate(data.records)]
        system = _system(trial, rows, count, resting, begun)
        slow = best is not None and 0.8 * best.total < system.total <= best.total
        if best is None or system.total <= best.total:
            best, damping = system, 0.1 * damping
        else:
            damping = max(10.0 * damping, 1e-3)
        move, left = best.step(damping, moving.held)
        trial, rise = _shifted(best.trial, move, count), left - base
        promised = min(promised, rise)
        vain = turn + 1 >= LOOK and promised > hopeless
        if slow or vain or rise < 0.2 * SILENT or damping > STUCK:
            break
    assert best is not None
    return trial, rise, best.information


_Row = tuple[FloatArray, FloatArray, FloatArray]


def _linearised(predictor: Predictor, record: Record, index: int, data: Measured) -> _Row:
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

    trial: CandidateModel
    normal: FloatArray
    right: FloatArray
    total: float
    information: FloatArray

    def step(self, damping: float, held: Sequence[int]) -> tuple[FloatArray, float]:
        """Damped step of all entries that are not held.

        Args:
            damping: added to the diagonal of the normal matrix after that is scaled to a unit diagonal.
            held: indices of the entries that stay.

        Returns:
            The step (s,), and the weighted sum of squares that it should leave.
        """
        unit = np.sqrt(np.maximum(np.diag(self.normal), 1e-300))
        scaled = self.normal / np.outer(unit, unit) + damping * np.eye(unit.size)
        moved = np.setdiff1d(np.arange(unit.size), held)
        move = np.zeros(unit.size)
        move[moved] = -np.linalg.lstsq(scaled[np.ix_(moved, moved)], (self.right / unit)[moved], rcond=1e-12)[0]
        move /= unit
        left = self.total + 2.0 * float(self.right @ move) + float(move @ self.normal @ move)
        return move, max(left, 0.0)


def _values(trial: CandidateModel, moving: int) -> FloatArray:
    """The first ``moving`` free parameters, (moving,)."""
    return np.array([trial.model[name] for name in trial.free[:moving]])


def _system(
    trial: CandidateModel, rows: Sequence[_Row], moving: int, resting: Mapping[int, float], begun: FloatArray
) -> _System:
    """Normal equations of the first parameters, from the readings and from rest at the start.

    A parameter moves by its natural size at ease and not much further (``Predictor.precision``): where no reading
    holds it, as the frequency of a disturbance too faint to see, a step would take it anywhere.
    """
    count = len(trial.free)
    size = moving + 2 * len(rows)
    ease = trial.scale[:moving] ** -2.0
    moved = _values(trial, moving) - begun
    normal, right, total = np.zeros((size, size)), np.zeros(size), float(ease @ moved**2)
    normal[range(moving), range(moving)], right[:moving] = ease, ease * moved
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


def _beside_rest(trial: CandidateModel, row: _Row, index: int, resting: Mapping[int, float]) -> _Row:
    """The same with one more pseudo-reading: the cart began where spring and offset cancel (``RestConstraint``)."""
    difference, jacobian, weight = row
    if index not in resting:
        return row
    rest, slope = _imbalance(trial, index)
    return (
        np.append(difference, rest),
        np.concatenate([jacobian, slope[:, None]], axis=1),
        np.append(weight, resting[index] ** -2.0),
    )


def _imbalance(trial: CandidateModel, index: int) -> tuple[float, FloatArray]:
    """Deviation [m] of a record's start from the balance of spring and offset, and its gradient (p + 2,)."""
    model = trial.model
    slope = np.zeros(len(trial.free) + 2)
    slope[-2] = 1.0
    lean = 0.0
    if model.has(OFFSET) and model.stiffness > 0.0:
        lean = model[OFFSET_FORCE] / model.stiffness
        slope[trial.free.index(OFFSET_FORCE)] = 1.0 / model.stiffness
    return trial.initial[index].position + lean, slope


def _shifted(trial: CandidateModel, move: FloatArray, moving: int) -> CandidateModel:
    """The trial after a step of its first parameters and of its records' start positions and zeros."""
    names = dict(zip(trial.free[:moving], move[:moving], strict=True))
    values = {n: max(trial.model[n] + d, 0.2 * trial.model[n]) for n, d in names.items() if trial.model[n] > 0.0}
    initial = tuple(
        replace(one, position=one.position + move[moving + 2 * i], zero=one.zero + move[moving + 2 * i + 1])
        for i, one in enumerate(trial.initial)
    )
    return replace(trial, model=trial.model.with_values(values), initial=initial)
