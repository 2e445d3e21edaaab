"""Whether the force has anything to do with the motion: detection of records that no mass-spring-damper model can fit.

A joint that a hand moves, or an effort that is no force, is still fitted by some model, with absurd values. Before any
model is fitted, m x'' + b x' + k x + Fc sign(x') + F0 = F is multiplied by smooth windows and integrated by parts, so
that no reading is differentiated (the modulating functions of Shinbrot, 1957), and regressed. Springs that press only
near either end of the travel are columns too: a cart that runs into its stops has most of its force there. So are sine
and cosine of an angle: a pendulum that goes round is moved by its weight. The result is the part of the force's
variation that the motion accounts for, at the window length at which it accounts for most. It is corrected for the
noise of the encoder that the regression carries into the force.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, error
from msd_ident.data.record import FloatArray, Record

#: Part of the force's variation below which nothing is left to fit. Rigs with any effect of the library reach 0.5 (a
#: second mode that takes the force upon itself) to 1, measured ones 0.85 to 1, the noise of a motor that is off 0.1.
_UNRELATED = 0.2
#: Parts of the travel, from either end, in which a stop may press.
_AT_ENDS = (0.15, 0.3)
#: Windows in the record's duration: from the narrowest to the widest.
_WINDOWS = (600, 200, 60)
#: Points that are enough for the narrowest of them, and fewest of a record and of a window.
_POINTS, _SHORTEST, _NARROWEST = 12_000, 240, 8
#: Fewest windows with motion in them, also counted by their part in the force's variation: of one step alone, a few
#: windows hold it all. And the part of its span by which the cart must move to count as in motion.
_FEWEST, _MOVES = 40, 0.02
#: Most stamps of a force that is commanded now and then, and held after the last one.
_COMMANDS = 10
#: A force whose windowed values vary by less than this part of its range is constant, as far as they show.
_VARIES = 0.02


def relation(record: Record, motion: Motion) -> Iterator[Finding]:
    """A force that the motion does not account for."""
    if motion.still or motion.force_span == 0.0:
        return
    share = accounted(record, motion.floor)
    if share < _UNRELATED:
        yield error(
            "unrelated_force",
            f"the motion accounts for {100.0 * max(share, 0.0):.0f} % of the force's variation, so no mass, damping "
            "and stiffness explain this record: a hand may move the cart, or the force is another quantity; "
            "check --force, or give --force none and --start for a part without force",
        )


def accounted(record: Record, floor: float = 0.0) -> float:
    """Part of the force's variation that the motion explains, at the best window length; NaN if none is usable.

    Args:
        record: position and force.
        floor: standard deviation of the encoder's noise [m].
    """
    return max(_usable(record, floor, _WINDOWS, angle=record.position_unit == "rad"), default=math.nan)


def without_spring(record: Record, floor: float = 0.0) -> tuple[float, float]:
    """Part of the force's variation that the motion explains with a spring, and without one; NaN if unknown.

    Both are those of the widest usable window: it differentiates the readings least, so their noise does not stand for
    what a model lacks.

    Args:
        record: position and force.
        floor: standard deviation of the encoder's noise [m].
    """
    widest = _WINDOWS[::-1]
    sprung, free = (next(_usable(record, floor, widest, spring=spring), math.nan) for spring in (True, False))
    return sprung, free


def _usable(
    record: Record, floor: float, windows: Iterable[int], *, spring: bool = True, angle: bool = False
) -> Iterator[float]:
    """``_share`` with each of these numbers of windows in the record, but for those of which none is usable."""
    position, force, averaged = _even(record)
    if position.size < _SHORTEST:
        return
    pressing = [position if spring else np.zeros_like(position), *_bent_at_ends(position)]
    pressing += [np.sin(position), np.cos(position)] if angle else []
    for size in (position.size // count for count in windows):
        if size >= _NARROWEST:
            share = _share(position, force, pressing, size, floor / math.sqrt(averaged))
            if not math.isnan(share):
                yield share


def _even(record: Record) -> tuple[FloatArray, FloatArray, int]:
    """Position and force, evenly spaced, and how many samples each of their points averages: the narrowest window has
    a few points.

    A force of more stamps than commands have is a signal, and only known as long as it was recorded.
    """
    begin, end = float(record.time[0]), float(record.time[-1])
    if record.force.size > _COMMANDS:
        begin, end = max(begin, float(record.force_time[0])), min(end, float(record.force_time[-1]))
    period = record.duration / (record.samples - 1)
    samples = int((end - begin) / period) + 1
    count = math.ceil(samples / _POINTS)
    time = begin + period * np.arange(samples // count * count)
    pair = (np.interp(time, record.time, record.position), record.force_at(time))
    position, force = (values.reshape(-1, count).mean(axis=1) for values in pair)
    return position - np.mean(position), force, count


def _share(position: FloatArray, force: FloatArray, pressing: Sequence[FloatArray], size: int, noise: float) -> float:
    """Of windows of ``size`` points: 1 − residual over variation of the force, corrected for the numbers fitted and for
    the noise of a position [m] that the fitted coefficients turn into force.

    ``pressing``: curves over the position with a force of their own, that of the spring first.
    """
    u = np.linspace(-1.0, 1.0, size + 2)[1:-1]
    bump, slope = (1.0 - u**2) ** 3, -6.0 * u * (1.0 - u**2) ** 2
    bend = -6.0 * (1.0 - u**2) ** 2 + 24.0 * u**2 * (1.0 - u**2)
    bend -= bump * np.sum(bend) / np.sum(bump)  # of few points, a position that is constant would be an acceleration
    v, a, f = (_windowed(*pair) for pair in ((position, -slope), (position, bend), (force, bump)))
    swing = float(np.ptp(position))
    pressed = [_windowed(curve, bump) for curve in pressing]
    if np.ptp(force) == 0.0:
        return math.nan
    moving = np.abs(v) > _MOVES * swing * float(np.sum(np.abs(slope))) / 2.0
    if np.count_nonzero(moving) < _FEWEST or np.std(f[moving]) < _VARIES * np.ptp(force) * np.sum(bump):
        return math.nan
    deviation = (f[moving] - np.mean(f[moving])) ** 2
    if float(np.sum(deviation)) ** 2 < _FEWEST * float(np.sum(deviation**2)):
        return math.nan
    columns = np.column_stack((a, v, pressed[0], np.sign(v), np.ones_like(v), *pressed[1:]))[moving]
    sizes = np.sqrt(np.mean(columns**2, axis=0))
    scale = np.where(sizes > 0.0, sizes, 1.0)
    fitted = np.linalg.lstsq(columns / scale, f[moving], rcond=None)[0] / scale
    left = f[moving] - columns @ fitted
    kernel = fitted[0] * bend - fitted[1] * slope + fitted[2] * bump
    carried = noise**2 * float(kernel @ kernel)
    pieces = np.count_nonzero(moving) / 4.0  # neighbours overlap by three quarters
    lost = pieces / max(pieces - columns.shape[1], 1.0)
    return float(1.0 - max(lost * np.mean(left**2) - carried, 0.0) / np.var(f[moving]))


def _bent_at_ends(position: FloatArray) -> Iterator[FloatArray]:
    """How far (n,) the cart is within each part of ``_AT_ENDS``, at one end of its travel and then at the other."""
    low, high = float(np.min(position)), float(np.max(position))
    for part in _AT_ENDS:
        yield np.minimum(position - (low + part * (high - low)), 0.0)
        yield np.maximum(position - (high - part * (high - low)), 0.0)


def _windowed(values: FloatArray, window: FloatArray) -> FloatArray:
    """Sums over windows that begin every quarter of their length."""
    return np.asarray(np.convolve(values, window[::-1], mode="valid")[:: max(window.size // 4, 1)], dtype=np.float64)
