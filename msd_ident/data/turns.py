"""Angles that are wrapped at one turn (-π to π, 0 to 2π): recognised, and unwrapped.

A wrapped angle never leaves one turn, and where it jumps by almost a whole one, it goes on with the speed that it had.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record

TURN = 2.0 * math.pi
#: Turns beyond which a shaft is on no spring: clock springs have less.
WOUND = 20.0
#: Part of a turn by which rounding lets readings leave it.
_ROUNDING = 1e-3
#: Speed at a jump in that of the samples beside it, on each side, and part of a turn that noise may add to the step.
_BESIDE, _FASTEST, _NOISE = 5, 3.0, 0.01
#: Part of the jumps that must be smooth; the others may be wild readings.
_SMOOTH = 0.9
#: Steps of more than a quarter of a turn from which on the direction of a turn is in doubt.
_DOUBTFUL = 5
#: Interval in sampling periods in which an angle may turn further than half a turn unseen.
_GAP = 1.5


def unwrapped(time: FloatArray, angle: FloatArray) -> tuple[FloatArray, str]:
    """An angle without the jumps of one turn, and a sentence on them; an angle without such jumps as it is.

    Args:
        time: (n,) rising stamps [s].
        angle: (n,) [rad].
    """
    jumps = wraps(time, angle, TURN)
    if not jumps.size:
        return angle, _doubt(angle)
    steps = np.diff(np.unwrap(angle))
    intervals = np.diff(time)
    speed = steps / intervals
    for i in np.flatnonzero(intervals > _GAP * np.median(intervals)):  # it turned on there
        beside = np.delete(speed, i)[max(i - 1, 0) : i + 1]
        steps[i] += TURN * np.rint((float(np.mean(beside)) * intervals[i] - steps[i]) / TURN)
    times = "once" if jumps.size == 1 else f"{jumps.size} times"
    turns = np.rint((angle[0] + np.concatenate(([0.0], np.cumsum(steps))) - angle) / TURN)
    return angle + TURN * turns, (
        f"position: the angle jumps by one turn {times}, the first time at {time[jumps[0] + 1] - time[0]:.3f} s, and "
        "turns on with the same speed: it was wrapped, and is unwrapped."
    )


def wraps(time: FloatArray, position: FloatArray, turn: float) -> npt.NDArray[np.intp]:
    """Samples behind which a position is wrapped; none where it is not, or where it cannot be told.

    Args:
        time: (n,) rising stamps [s].
        position: (n,).
        turn: length after which it would repeat.
    """
    none = np.zeros(0, dtype=np.intp)
    far = np.flatnonzero(np.abs(np.diff(position)) > 0.5 * turn)
    if not far.size or position.size < MINIMUM_SAMPLES or np.ptp(position) > (1.0 + _ROUNDING) * turn:
        return none
    steps = np.abs(np.diff(np.unwrap(position, period=turn)))
    if _is_doubtful(steps, turn):
        return none
    intervals = np.diff(time)
    speed = steps / intervals
    elsewhere = speed.copy()
    elsewhere[far] = 0.0  # a wild reading jumps there and back
    beside = np.array([np.max(elsewhere[max(i - _BESIDE, 0) : i + 1 + _BESIDE]) for i in far])
    smooth = speed[far] <= _FASTEST * beside + _NOISE * turn / intervals[far]
    return far if float(np.mean(smooth)) >= _SMOOTH else none


def _is_doubtful(steps: FloatArray, turn: float) -> bool:
    return bool(np.count_nonzero(np.abs(steps) > 0.25 * turn) >= _DOUBTFUL)


def _doubt(angle: FloatArray) -> str:
    """A sentence on an angle that may be wrapped, and turns too far between two samples to tell; else empty."""
    steps = np.diff(angle)
    jumps = np.count_nonzero(np.abs(steps) > 0.5 * TURN)
    if not jumps or np.ptp(angle) > (1.0 + _ROUNDING) * TURN or not _is_doubtful(np.diff(np.unwrap(angle)), TURN):
        return ""
    return (
        f"position: the angle stays within one turn and jumps by more than half of it {jumps} times, but turns so far "
        "between two samples that it cannot be told whether it is wrapped: it is used as it is; sample faster, or "
        "unwrap it before."
    )


def turned_away(record: Record) -> float:
    """Turns of a joint, where they are more than any spring or stop goes along with (``WOUND``); else 0."""
    turns = float(np.ptp(record.position)) / TURN
    return turns if record.position_unit == "rad" and turns > WOUND else 0.0
