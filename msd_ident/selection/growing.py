"""Starts that are followed over more and more of a record, where the motion would lead each of them away from it.

A joint that stands over its axis falls: a start that differs from the truth by a thousandth parts from the record as
e^(rate·time), and what it leaves of the whole record says nothing about it. What it leaves before that does.
"""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import Weighting, descend
from msd_ident.estimate.effort import LOOK
from msd_ident.estimate.levels import MOST_OF, NEGLIGIBLE

#: A start: its problem in units of the noise, and its point (p,).
Start = tuple[Weighting, FloatArray]

#: Equal parts of the records, by which a fit grows.
_PARTS = 2**LOOK
#: Angle [rad] from the record beyond which a start is nearer to another turn.
_PARTED = math.pi


def grown(starts: list[Start], keep: int) -> list[Start]:
    """The starts that follow the records longest, each fitted from there on to more and more of them.

    Args:
        starts: of one set of causes.
        keep: how many to fit.

    Returns:
        At most ``keep``. One that follows the whole records is returned as it is.
    """
    judged = [(_followed(*start), start) for start in starts]
    judged.sort(key=lambda one: (-one[0][0], one[0][1]))
    return [(weighting, _fitted(weighting, point, rank[0])) for rank, (weighting, point) in judged[:keep]]


def _followed(weighting: Weighting, point: FloatArray) -> tuple[int, float]:
    """How many parts of the records a start follows, at least one, and the chi² that it leaves on them.

    It follows where it leaves less than a quarter of the chi² of a cart that stands still at the mean position, up to
    the first part in which it is half a turn off: it has gone round once more or less, however little that is of a
    motion of many turns.
    """
    left, still, off = np.zeros(_PARTS), np.zeros(_PARTS), np.zeros(_PARTS)
    for r, (record, root) in enumerate(zip(weighting.problem.records, weighting.roots, strict=True)):
        angle, position = weighting.problem.residual(point, r), record.position
        residual = root * angle
        for part in range(_PARTS):
            end = max((part + 1) * record.samples // _PARTS, 1)
            left[part] += float(residual[:end] @ residual[:end])
            still[part] += float(np.sum((root[:end] * (position[:end] - np.mean(position[:end]))) ** 2))
            off[part] = max(off[part], float(np.max(np.abs(angle[:end]))))
    near = np.flatnonzero((left < MOST_OF**2 * still) & (off < _PARTED))
    parts = int(np.max(near, initial=0))
    return parts + 1, float(left[parts])


def _fitted(weighting: Weighting, point: FloatArray, follows: int) -> FloatArray:
    """The point after a few steps on the parts that it follows, as long as these let it follow more."""
    fitted = _PARTS if follows == _PARTS else 0
    while follows > fitted:
        short = _shortened(weighting, follows / _PARTS)
        state = short.exact(np.clip(point, short.problem.lower, short.problem.upper), short.steps(None))
        point = descend(short, state, LOOK, NEGLIGIBLE * state.chi).point
        fitted, (follows, _) = follows, _followed(weighting, point)
    return point


def _shortened(weighting: Weighting, share: float) -> Weighting:
    """The same problem on the first part of each record."""
    part = weighting.problem.shortened(share)
    pairs = zip(weighting.roots, part.records, strict=True)
    return Weighting(part, tuple(root[: record.samples] for root, record in pairs))
