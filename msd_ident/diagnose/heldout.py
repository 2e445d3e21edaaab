"""Does the extension predict? Both models on segments of the data that their fits did not see.

The records are cut where the force steps, or else into equal parts, and dealt into folds. For each fold both models are
refitted without its segments (starting from the full fit) and simulated through them; nothing of a left-out segment
enters but the first instants of a record, which tell where it starts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.diagnose.candidates import Experiment, Fitted, weigh
from msd_ident.diagnose.descent import State, descend
from msd_ident.fit import see_reduction
from msd_ident.record import FloatArray, Record

FOLDS = 4
_SEGMENTS = 8
_PIECES = 6
_DRAWS = 400
_ITERATIONS = 4


@dataclass(frozen=True)
class HeldOut:
    """Errors on left-out data: SEE [m] of both models, reduction in per cent (eq. 15) and its 95 % interval."""

    see_base: float
    see_extended: float
    reduction_percent: float
    interval_percent: tuple[float, float]

    @property
    def better(self) -> bool:
        """Whether the extension predicts better than the base."""
        return self.reduction_percent > 0.0


def segments(record: Record) -> FloatArray:
    """Number (n,) of the segment that each sample is in: from force step to force step, or equal parts."""
    changes = record.force_time[1:][np.diff(record.force) != 0.0]
    changes = changes[(changes > record.time[0]) & (changes < record.time[-1])]
    if FOLDS <= changes.size + 1 <= 40 and np.min(np.diff(changes), initial=np.inf) > record.duration / 80.0:
        return np.asarray(np.searchsorted(changes, record.time, side="right"))
    return np.minimum(np.arange(record.samples) * _SEGMENTS // record.samples, _SEGMENTS - 1)


def predict(experiment: Experiment, base: Fitted, extended: Fitted) -> HeldOut:
    """Compare two fitted sets on left-out segments."""
    cuts = [segments(record) for record in experiment.records]
    errors = [_left_out(experiment, fitted, cuts) for fitted in (base, extended)]
    pairs = _by_piece(errors[0], errors[1], cuts)
    see_base, see_extended = (math.sqrt(pairs[i].sum() / max(pairs[2].sum() - 2.0, 1.0)) for i in (0, 1))
    rng = np.random.default_rng(0)
    draws = rng.integers(pairs.shape[1], size=(_DRAWS, pairs.shape[1]))
    ratios = np.sqrt(pairs[1][draws].sum(axis=1) / np.maximum(pairs[0][draws].sum(axis=1), 1e-300))
    low, high = np.quantile(100.0 * (1.0 - ratios), (0.025, 0.975))
    return HeldOut(see_base, see_extended, see_reduction(see_base, see_extended), (float(low), float(high)))


def _left_out(experiment: Experiment, fitted: Fitted, cuts: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
    """For each record the (n,) error of predictions by fits that did not see the sample."""
    problem = fitted.problem
    errors = tuple(np.zeros(record.samples) for record in problem.records)
    for fold in range(FOLDS):
        masks = [_training(cut, fold) for cut in cuts]
        weighting = weigh(problem, experiment.readings, masks)
        kept = np.concatenate(masks)
        seen = State(fitted.point, fitted.state.residual * kept, fitted.state.jacobian * kept, True)
        point = descend(weighting, seen, _ITERATIONS, 1e-3 * seen.chi).point
        for r, mask in enumerate(masks):
            out = mask == 0.0
            errors[r][out] = problem.residual(point, r)[out]
    return errors


def _training(cut: FloatArray, fold: int) -> FloatArray:
    """1 where a sample is fitted, 0 where it is predicted; the first hundredth of a record is always fitted."""
    mask = np.asarray(cut % FOLDS != fold, dtype=np.float64)
    mask[: max(10, cut.size // 100)] = 1.0
    return mask


def _by_piece(base: Sequence[FloatArray], extended: Sequence[FloatArray], cuts: Sequence[FloatArray]) -> FloatArray:
    """(3, pieces): sums of squares of both errors and counts, over pieces of segments: what the bootstrap draws
    from.
    """
    found = []
    for one, other, cut in zip(base, extended, cuts, strict=True):
        for number in np.unique(cut):
            for piece in np.array_split(np.flatnonzero(cut == number), _PIECES):
                if piece.size:
                    found.append(
                        (float(one[piece] @ one[piece]), float(other[piece] @ other[piece]), float(piece.size))
                    )
    return np.ascontiguousarray(np.asarray(found, dtype=np.float64).T)
