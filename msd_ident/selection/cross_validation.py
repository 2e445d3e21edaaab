"""Prediction of left-out data by base and extended model.

The records are cut where the force steps, or else into parts equal in travel and time together, and dealt into folds.
For each fold both models are refitted without its segments (starting from the full fit, whose Jacobian is known there)
and simulated through them. No sample of a left-out segment enters, except those at the start of a record, which
determine its initial state.

A useless parameter improves the fit of the training data and, on average, makes the prediction worse; by chance it
makes it better in one of six cases. The gain therefore has an interval, from the errors that the extension leaves on
blocks of data that are longer than the memory of the plant (Diebold and Mariano 1995, with block sums for the
variance). The interval tells what a repetition of this experiment would show, not what other segments would: it takes
events of the experiment, such as two contacts with a stop, as given.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import see_reduction
from msd_ident.estimate.broyden import State, descend
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.levels import CONFIDENCE
from msd_ident.model import Model
from msd_ident.selection.experiment import Experiment, weigh
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import least_fall
from msd_ident.tuning import fixed, tuned

FOLDS = tuned(4, unit="folds", why="parts of the data that are left out in turn", chosen="by hand")
_SEGMENTS = 2 * FOLDS
_LOOKS = fixed(20, "accuracy", "distances in a segment that its travel is summed from: each is long beside the noise")
_WORST = fixed(50.0, "accuracy", "logarithm of a ratio of errors beyond which it is as good as infinite")


@dataclass(frozen=True)
class HeldOut:
    """Errors on left-out data.

    Attributes:
        see_base, see_extended: SEE of both models [m].
        reduction_percent: SEE reduction [%], eq. 15.
        interval_percent: its 95 % interval.
    """

    see_base: float
    see_extended: float
    reduction_percent: float
    interval_percent: tuple[float, float]

    @property
    def better(self) -> bool:
        """Whether the extension predicts better than the base, by more than chance: the interval lies above 0."""
        return self.interval_percent[0] > 0.0


@dataclass(frozen=True)
class _Blocks:
    """Sums over blocks of left-out data [m²], each (blocks,), and all samples.

    Attributes:
        base, extended: squares of both models' errors.
        crossed: the extension's errors times what both predictions differ by.
        samples: of all blocks.
    """

    base: FloatArray
    extended: FloatArray
    crossed: FloatArray
    samples: int


def segments(record: Record) -> FloatArray:
    """Segment number (n,) of each sample: from step to step of the force, or parts equal in travel and time together.

    After one push the cart is soon at rest, and of equal times the first part would hold nearly all that there is to
    fit; of equal travel the last part would hold nearly all samples.
    """
    changes = record.force_time[1:][np.diff(record.force) != 0.0]
    changes = changes[(changes > record.time[0]) & (changes < record.time[-1])]
    if FOLDS <= changes.size + 1 <= 40 and np.min(np.diff(changes), initial=np.inf) > record.duration / 80.0:
        return np.asarray(np.searchsorted(changes, record.time, side="right"))
    lag = max(record.samples // (_LOOKS * _SEGMENTS), 1)
    way = np.abs(record.position[lag:] - record.position[:-lag])
    travelled = np.cumsum(np.pad(way, (lag // 2, lag - lag // 2), mode="edge"))
    share = 0.5 * (travelled / max(travelled[-1], 1e-300) + np.arange(record.samples) / record.samples)
    return np.asarray(np.minimum((share * _SEGMENTS).astype(np.intp), _SEGMENTS - 1))


def predict(experiment: Experiment, base: Hypothesis, extended: Hypothesis) -> HeldOut:
    """Compare the predictions of two fitted sets on left-out segments.

    Args:
        experiment: readings with their weights.
        base: the fit without the causes.
        extended: the fit with them.
    """
    cuts = [segments(record) for record in experiment.records]
    errors = left_out(experiment, base, cuts)
    if extended is base:
        return _compared(_blocks(experiment, base.model, (errors, errors), cuts))
    return _compared(_blocks(experiment, base.model, (errors, left_out(experiment, extended, cuts)), cuts))


def left_out(experiment: Experiment, fitted: Hypothesis, cuts: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
    """Errors of predictions of samples by fits that did not use them.

    Args:
        experiment: readings with their weights.
        fitted: the set, fitted to all samples.
        cuts: for each record the (n,) segment numbers that ``segments`` gives.

    Returns:
        For each record the (n,) errors model − data [m]; 0 for the samples that every fit uses.
    """
    problem = fitted.problem
    errors = tuple(np.zeros(record.samples) for record in problem.records)
    for fold in range(FOLDS):
        masks = [training(cut, fold) for cut in cuts]
        point = refitted(experiment, fitted, masks)
        for r, mask in enumerate(masks):
            out = mask == 0.0
            if out.any():
                errors[r][out] = problem.residual(point, r)[out]
    return errors


def training(cut: FloatArray, fold: int) -> FloatArray:
    """Mask (n,) of a fold: 1 where a sample is fitted, 0 where it is predicted.

    Args:
        cut: (n,) segment number of each sample.
        fold: number of the fold, 0 to ``FOLDS`` − 1. It predicts every ``FOLDS``-th segment. The first hundredth of the
            record (at least 10 samples) is always fitted.
    """
    mask = np.asarray(cut % FOLDS != fold, dtype=np.float64)
    mask[: max(10, cut.size // 100)] = 1.0
    return mask


def refitted(experiment: Experiment, fitted: Hypothesis, masks: Sequence[FloatArray]) -> FloatArray:
    """Fit to a part of the samples, from where the fit to all samples ended.

    All entries of the vector are free. What these samples do not determine (a stop that they do not reach) keeps its
    value.

    Args:
        experiment: readings with their weights.
        fitted: the set, fitted to all samples.
        masks: for each record (n,): 1 where a sample is fitted, else 0.

    Returns:
        (p,) vector of the set's problem.
    """
    weighting = weigh(fitted.problem, experiment.readings, masks)
    kept = np.concatenate(masks)
    known = fitted.state
    seen = State.at(known.point, known.residual * kept, known.jacobian * kept, exact=known.exact)
    return descend(weighting, seen, SHORT, least_fall(experiment, fitted.chi)).point


def _blocks(
    experiment: Experiment, model: Model, errors: tuple[Sequence[FloatArray], Sequence[FloatArray]],
    cuts: Sequence[FloatArray],
) -> _Blocks:  # fmt: skip
    """Both models' errors on left-out data, summed over blocks of segments in which the plant forgets; no block is
    shorter than a sample, however light the cart seems.
    """
    memory = _memory(model)
    found = []
    for record, one, other, cut in zip(experiment.records, *errors, cuts, strict=True):
        for number in np.unique(cut):
            inside = np.flatnonzero(cut == number)
            count = max(int(inside.size * record.period / max(memory, record.period)), 1)
            for block in np.array_split(inside, count):
                base, extended = one[block], other[block]
                found.append((base @ base, extended @ extended, extended @ (base - extended)))
    sums = np.asarray(found, dtype=np.float64).T
    return _Blocks(sums[0], sums[1], sums[2], sum(record.samples for record in experiment.records))


def _memory(model: Model) -> float:
    """Time [s] after which errors of a plant's motion are others: a swing, and until it has died away to 1/e."""
    swing = 2.0 * math.pi * math.sqrt(model.mass / model.stiffness) if model.stiffness > 0.0 else 0.0
    decay = (2.0 if model.stiffness > 0.0 else 1.0) * model.mass / max(model.damping, 1e-300)
    return max(swing, decay)


def _compared(blocks: _Blocks) -> HeldOut:
    """SEE of both on left-out data, and the reduction with its interval.

    With the extension's errors e and the predictions' difference d, the base's are e + d; to first order the logarithm
    of the ratio Σe²/Σ(e + d)² changes by what chance does to Σe² and Σed.
    """
    base, extended = float(blocks.base.sum()), float(blocks.extended.sum())
    see_base, see_extended = (math.sqrt(total / max(blocks.samples - 2, 1)) for total in (base, extended))
    if not (base > 0.0 and extended > 0.0):
        return HeldOut(see_base, see_extended, 0.0, (0.0, 0.0))
    scatter = blocks.extended - extended / blocks.extended.size
    change = scatter * (1.0 / extended - 1.0 / base) - 2.0 * blocks.crossed / base
    count = change.size
    spread = math.sqrt(float(change @ change)) * float(stdtrit(max(count - 1, 1), 0.5 * (1.0 + CONFIDENCE)))
    middle = math.log(extended / base)
    ratios = (min(0.5 * (middle + side * spread), _WORST) for side in (1.0, -1.0))
    low, high = (0.0 - 100.0 * math.expm1(ratio) for ratio in ratios)
    return HeldOut(see_base, see_extended, see_reduction(see_base, see_extended), (low, high))
