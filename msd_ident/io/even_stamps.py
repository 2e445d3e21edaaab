"""Time stamps that were rounded when they were written: the even times are reconstructed.

A data logger samples at a fixed rate and writes the time with three decimals. At 887 Hz the intervals are then 1 ms and
2 ms, and look like lost samples. What shows the truth is a counter column, or stamps that stay within one rounding of a
straight line over the whole record: no lost sample and no jitter could do that. Where the clock drifts, the stamps stay
within one rounding of their own running straight line. A counter shows that none is lost, or that no interval is longer
than the period rounded up: behind a lost sample the stamps would be a whole period off that line.

Stamps with a fixed number of digits (``%.2E``) are rounded ever more coarsely, by a decade each. They are rebuilt where
each stays within its own rounding of the straight line; the fine ones at the begin fix it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray

#: Headings of a counter, without unit and in lower case.
COUNTERS = ("sample", "samples", "sample number", "index", "counter", "seq", "sequence", "no", "no.", "nr", "#", "n")
#: A rounding below this part of the sampling interval does no harm; above this part of the record it hides everything.
_COARSE, _COARSEST = 0.01, 0.02
#: Stamps may leave the straight line by this many roundings, from the lowest to the highest.
_SPAN = 1.1
#: The same for a running straight line, which cuts the corners of a clock that drifts.
_BENT_SPAN = 1.5
#: Samples of a running straight line, and the part of the period by which a drifting clock may change it.
_RUNNING, _DRIFT = 401, 0.01
#: Decimal places that are looked for, from thousands to nanos, and numbers of digits.
_DECIMALS, _DIGITS = range(3, -10, -1), range(2, 8)
#: Part of a rounding by which a stamp may be off its multiples.
_MOST_OFF = 0.01
#: Part of the period by which a clock may jitter where the rounding is finer than that.
_JITTER = 0.05


@dataclass(frozen=True)
class Rebuilt:
    """Even stamps in place of rounded ones.

    Attributes:
        time: (n,) as even as the counter is, in the unit of the stamps.
        tick: what the stamps were rounded to; the last and coarsest rounding of stamps of a fixed number of digits.
        period: mean interval between samples.
        counted: whether a counter is the evidence.
        straight: whether the stamps stay within one rounding of one straight line; else the clock drifts.
        digits: fixed number of digits that the stamps have, 0 for a fixed number of decimals.
    """

    time: FloatArray
    tick: float
    period: float
    counted: bool
    straight: bool = True
    digits: int = 0


def rebuilt(time: FloatArray, counter: FloatArray | None = None) -> Rebuilt | None:
    """Times of the samples from rounded stamps.

    Args:
        time: (n,) stamps in any unit, in the order of the lines.
        counter: (n,) numbers of the samples, where the file has them; without, the lines are counted.

    Returns:
        The times, or ``None`` where the stamps are not rounded, or are no evenly sampled ones.
    """
    if time.size < MINIMUM_SAMPLES or not np.all(np.isfinite(time)):
        return None
    counted = counter is not None and _counts(counter)
    number = counter - counter[0] if counter is not None and counted else np.arange(float(time.size))
    if time[-1] <= time[0]:
        return None
    return _of_decimals(time, number, counted) or _of_digits(time, number, counted)


def _of_decimals(time: FloatArray, number: FloatArray, counted: bool) -> Rebuilt | None:
    """Times from stamps (n,) of samples (n,) that all have the same decimals."""
    duration, tick = float(time[-1] - time[0]), _tick(time)
    if not _COARSE * duration / number[-1] < tick < _COARSEST * duration:
        return None
    period, start = np.polyfit(number, time, 1)
    line = start + period * number
    off = time - line
    if period <= 0.0 or float(np.max(np.abs(off))) < 1e-3 * tick:
        return None
    straight = float(np.ptp(off)) <= _SPAN * tick
    if not straight:
        if time.size < _RUNNING or not (counted or _none_lost(time, period / tick, tick)):
            return None
        from msd_ident.data.local_polynomial import local_polynomial  # imported here: it imports parts of scipy

        running = local_polynomial(off, _RUNNING, 1, 0, 1.0)
        drift = np.diff(running) / (period * np.diff(number))
        if float(np.ptp(off - running)) > _BENT_SPAN * tick or float(np.max(np.abs(drift))) > _DRIFT:
            return None
        line = line + running
    return Rebuilt(line, tick, float(period), counted, straight)


def _of_digits(time: FloatArray, number: FloatArray, counted: bool) -> Rebuilt | None:
    """Times from stamps (n,) of samples (n,) that all have the same number of digits."""
    digits, ticks = _ticks_of_digits(time)
    duration, tick = float(time[-1] - time[0]), float(np.max(ticks))
    mean = duration / number[-1]
    seconds = 10.0 ** min(_DECIMALS) <= tick <= 10.0 ** max(_DECIMALS)
    if not digits or tick == np.min(ticks) or not (seconds and _COARSE * mean < tick < _COARSEST * duration):
        return None
    allowed = np.maximum(0.5 * _SPAN * ticks, _JITTER * mean)
    period, start = np.polyfit(number, time, 1, w=1.0 / allowed)
    line = start + period * number
    off = np.abs(time - line)
    if period <= 0.0 or float(np.max(off)) < 1e-3 * tick or bool(np.any(off > allowed)):
        return None
    return Rebuilt(line, tick, float(period), counted, digits=digits)


def _ticks_of_digits(time: FloatArray) -> tuple[int, FloatArray]:
    """Fewest digits that all stamps (n,) can be written with, and what each is rounded to; 0 for more than a few."""
    size = np.abs(time)
    size = np.where(size > 0.0, size, np.min(size[size > 0.0]))  # a zero has no decade: that of the smallest
    decade = np.floor(np.log10(size) + 1e-12)
    for digits in _DIGITS:
        ticks = 10.0 ** (decade - (digits - 1))
        places = time / ticks
        if float(np.max(np.abs(places - np.rint(places)))) < 1e-6:
            return digits, ticks
    return 0, np.zeros_like(time)


def _none_lost(time: FloatArray, period: float, tick: float) -> bool:
    """Whether all intervals of stamps (n,) are the period [ticks] rounded down or up, and a lost sample would be seen.

    It moves all later stamps by a period. That is seen where the rounding goes through all its phases on both sides of
    it; with a period of a whole number of ticks, an interval that is one tick longer may be a lost sample.
    """
    intervals = np.rint(np.diff(time) / tick)
    phase = abs(period - round(period))
    seen = period > 1.0 and phase * (_RUNNING // 2) >= 1.0
    return bool(seen and np.min(intervals) >= math.floor(period) and np.max(intervals) <= math.ceil(period))


def _counts(counter: FloatArray) -> bool:
    """Whether numbers are whole and rise with every line."""
    whole = bool(np.all(np.isfinite(counter))) and bool(np.all(counter == np.rint(counter)))
    return whole and bool(np.all(np.diff(counter) >= 1.0))


def _tick(time: FloatArray) -> float:
    """Largest power of ten of which all stamps are multiples."""
    for decimal in _DECIMALS:
        tick = 10.0**decimal
        places = time / tick
        rounding = 1e-6 * max(1.0, 1e-6 * float(np.max(np.abs(places))))  # of numbers with 15 digits
        if float(np.max(np.abs(places - np.rint(places)))) < min(rounding, _MOST_OFF):
            return tick
    return 0.0
