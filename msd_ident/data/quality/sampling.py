"""When the samples were taken: gaps, jitter, rates."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import FloatArray, Record

#: Intervals within this part of the median count as the sampling period.
_REGULAR = 0.25
#: Jitter of the stamps, relative to the period, from which it is reported, and from which it is a warning.
_JITTER_TOLD, _JITTER_BAD = 0.05, 0.2
#: Interval, in sampling periods, up to which lost samples hide little of the motion.
SHORT_GAP = 5.5


def sampling(record: Record) -> Iterator[Finding]:
    """Stamps of the position [s] that are not even: two rates mixed, gaps, jitter."""
    intervals = np.diff(record.time)
    fast, slow = _rates(intervals)
    if fast and slow:
        yield warning("two_rates", _of_rates(fast, slow))
    period = slow or record.period
    yield from _gaps(record, intervals, period)
    regular = intervals[np.abs(intervals - period) < 0.5 * period]
    jitter = float(np.std(regular)) if regular.size > 1 and not slow else 0.0
    if jitter > _JITTER_TOLD * period:
        yield Finding(
            "warning" if jitter > _JITTER_BAD * period else "info",
            "jitter",
            f"the intervals between samples scatter by {1e3 * jitter:.3g} ms around {1e3 * period:.4g} ms "
            f"({100 * jitter / period:.0f} %): stamp the samples when they are taken",
        )


def _of_rates(fast: float, slow: float) -> str:
    if fast == slow:
        return (
            f"samples come in pairs: two sources take turns, at {1 / fast:.4g} Hz and {1 / slow:.4g} Hz, or every "
            "third sample is lost: check that one source alone gives the position, and that each of its messages holds "
            "it"
        )
    return (
        f"two sampling rates are mixed: {1 / fast:.4g} Hz and {1 / slow:.4g} Hz: check that one source alone gives the "
        "position, at one rate"
    )


def _gaps(record: Record, intervals: FloatArray, period: float) -> Iterator[Finding]:
    missing = missing_samples(record)
    if not missing:
        return
    gaps = np.flatnonzero(intervals > 1.5 * period)
    longest = int(gaps[np.argmax(intervals[gaps])])
    share = missing / (missing + record.samples)
    where = f"the longest {intervals[longest]:.4g} s at {record.time[longest]:.3f} s"
    count = f"{gaps.size} gap, {where}" if gaps.size == 1 else f"{gaps.size} gaps, {where}"
    digits = 2 if share < 0.99 else 4
    small = share < 1e-3 and intervals[longest] < SHORT_GAP * period
    yield Finding(
        "info" if small else "warning",
        "missing_samples",
        f"{missing} of {missing + record.samples} samples ({100 * share:.{digits}g} %) are missing ({count}): "
        "look for lost messages",
    )


def missing_samples(record: Record) -> int:
    """Position samples that the stamps say are missing: see ``missing_in``."""
    return missing_in(record.time)


def missing_in(time: FloatArray) -> int:
    """Samples missing in stamps (n,) [s]: whole periods in gaps of a train with a regular period, else 0."""
    intervals = np.diff(time)
    if intervals.size < 2:
        return 0
    _, slow = _rates(intervals)
    period = slow or float(np.median(intervals))
    if not slow and np.mean(np.abs(intervals - period) < _REGULAR * period) < 0.5:
        return 0
    gaps = intervals[intervals > 1.5 * period]
    return int(np.sum(np.rint(gaps / period) - 1))


def _rates(intervals: FloatArray) -> tuple[float, float]:
    """Shorter and longer sampling interval [s] where two regular rates are mixed, else twice 0.

    Either one part of the record has another rate, or two publishers take turns. Lost samples do neither: their
    gaps stand alone, and no interval is shorter than the period.
    """
    period = float(np.median(intervals))
    other = intervals[_in_long_runs(np.abs(intervals - period) > _REGULAR * period, 10)]
    second = float(np.median(other)) if other.size else 0.0
    if other.size > 0.01 * intervals.size and np.mean(np.abs(other - second) < _REGULAR * second) > 0.8:
        # Where the stamps scatter, there are intervals between the two as well; lost samples make whole ones.
        between = np.abs(intervals - 0.5 * (period + second)) < abs(second - period) / 6.0
        between &= np.abs(intervals - period * np.rint(intervals / period)) > 0.05 * period
        if np.count_nonzero(between) < 0.5 * other.size:
            return min(period, second), max(period, second)
    return _taking_turns(intervals, period)


def _taking_turns(intervals: FloatArray, period: float) -> tuple[float, float]:
    """Rates of two publishers: one of them cuts intervals of the other in two parts."""
    pairs = intervals[:-1] + intervals[1:]
    whole = float(np.median(pairs))
    uneven = np.mean(np.abs(intervals - whole / 2) > 0.05 * whole) > 0.8
    if uneven and np.mean(np.abs(pairs - whole) < 0.02 * whole) > 0.8:
        return whole, whole
    short = intervals < (1 - _REGULAR) * period
    cut = short[:-1] & short[1:] & (np.abs(pairs - period) < 0.1 * period)
    if np.count_nonzero(cut) < 0.02 * intervals.size or 2 * np.count_nonzero(cut) < 0.8 * np.count_nonzero(short):
        return 0.0, 0.0
    return period, float(np.sum(intervals)) / int(np.count_nonzero(cut))


def _in_long_runs(mask: npt.NDArray[np.bool_], length: int) -> npt.NDArray[np.bool_]:
    """Which of the true entries stand in runs of at least ``length``."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    long = np.zeros_like(mask)
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        long[begin:end] = end - begin >= length
    return long
