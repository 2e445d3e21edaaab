"""Starts that are followed over more and more of a record, where the motion would lead each of them away from it.

A joint that stands over its axis falls: a start that differs from the truth by a thousandth parts from the record as
e^(rate·time), and what it leaves of the whole record says nothing about it. What it leaves before that does.
"""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import Weighting, descend
from msd_ident.estimate.effort import LOOK
from msd_ident.estimate.levels import MOST_OF, NEGLIGIBLE

#: A start: its problem in units of the noise, and its point (p,).
Start = tuple[Weighting, FloatArray]

#: Parts of the records over which a fit grows, each twice the one before.
_SHARES = tuple(0.5**n for n in range(LOOK, -1, -1))


def grown(starts: list[Start], keep: int) -> list[Start]:
    """The starts that follow the records longest, each fitted from there on to more and more of them.

    Args:
        starts: of one set of causes.
        keep: how many to fit.

    Returns:
        At most ``keep``. One that follows the whole records is returned as it is.
    """
    judged = [(_followed(*start), start) for start in starts]
    judged.sort(key=lambda one: one[0])
    return [(weighting, _fitted(weighting, point, rank[0])) for rank, (weighting, point) in judged[:keep]]


def _followed(weighting: Weighting, point: FloatArray) -> tuple[int, float]:
    """Number of the shares that a start does not follow, and the chi² that it leaves on the last one that it does.

    It follows where it leaves less than half of what a cart leaves which stands still at the mean position.
    """
    records = weighting.problem.records
    left = [root * weighting.problem.residual(point, r) for r, root in enumerate(weighting.roots)]
    for share in reversed(_SHARES):
        ends = [part.samples for part in weighting.problem.shortened(share).records]
        chi = sum(float(one[:end] @ one[:end]) for one, end in zip(left, ends, strict=True))
        still = 0.0
        for record, root, end in zip(records, weighting.roots, ends, strict=True):
            still += float(np.sum((root[:end] * (record.position[:end] - np.mean(record.position[:end]))) ** 2))
        if chi < MOST_OF**2 * still:
            break
    return len(_SHARES) - 1 - _SHARES.index(share), chi


def _fitted(weighting: Weighting, point: FloatArray, missed: int) -> FloatArray:
    """The point after a few steps on each of the shares, from the last one that it follows to the whole."""
    for share in _SHARES[len(_SHARES) - 1 - missed :] if missed else ():
        part = weighting.problem.shortened(share)
        roots = tuple(root[: record.samples] for root, record in zip(weighting.roots, part.records, strict=True))
        short = Weighting(part, roots)
        state = short.exact(np.clip(point, part.lower, part.upper), short.steps(None))
        point = descend(short, state, LOOK, NEGLIGIBLE * state.chi).point
    return point
