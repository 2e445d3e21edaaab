"""How a record begins: under a force that acted before it, at rest, or in motion.

A table tells nothing about the time before its first line. If the cart rests under the first force until this changes,
the force acted before; if it moves at once, the force stepped at the first line. A controller's force changes because
the cart has moved: such a change does not end a rest.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.data.noise import Noise, noise_of
from msd_ident.data.quality.feedback import feedback_gain
from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record

#: A force below this part of its range is a rest and no push.
_PUSH = 0.3
#: Change of the force, in parts of its range, that ends its first level.
_CHANGE = 0.05
#: Motion per force under the first level, relative to that after the next change, below which the cart rests. And the
#: part of its whole travel by which it may leave its first place under that level: a response leaves it at once.
_RESTS, _CREEPS = 0.25, 0.02
#: Readings of a cart at rest stay within this many noise floors, and one encoder step, of their median.
_STILL = 5.0
#: Times as far as in the first half of the time that a cart has come which speeds up: between 2 and 4.
_SPEEDS_UP = 3.0
#: Part of the change of the force that comes in the first half of the time to it, where the force holds a level first.
_SLOPE = 0.2


def begins_pushed(record: Record) -> bool:
    """Whether a force acts in the first sample and none is known before it."""
    start = float(record.time[0])
    before, first = record.force_at([np.nextafter(start, -np.inf), start])
    return bool(before == 0.0 and first != 0.0)


def rests_under_force(record: Record) -> bool:
    """Whether a force acts in the first sample and the cart rests until this force changes by more than a controller
    makes of the motion.
    """
    if not begins_pushed(record):
        return False
    start, span = float(record.time[0]), float(np.ptp(np.append(record.force, 0.0)))
    first = float(record.force_at([start])[0])
    later = record.force_time > start
    changed = np.flatnonzero(later & (np.abs(record.force - first) > _CHANGE * span))
    if abs(first) < _PUSH * span or not changed.size:
        return False
    change = float(record.force_time[changed[0]])
    length = change - start
    held = record.position[record.time < change]
    after = record.position[(record.time >= change) & (record.time < change + length)]
    if held.size < 5 or after.size < 5:
        return False
    jump = float(record.force_at([change])[0]) - first
    height = abs(jump)
    first_few = held[: min(MINIMUM_SAMPLES, held.size // 3)]
    left = abs(float(np.median(held) - np.median(first_few)))
    noise = noise_of(record)
    stays = left < max(_STILL * noise.floor + noise.step, _CREEPS * float(np.ptp(record.position)))
    rests = float(np.ptp(held)) / abs(first) < _RESTS * float(np.ptp(after)) / max(height, _CHANGE * span)
    if (not _is_level(record, change, first) and _moves(held, noise)) or _departs(held, noise):
        return False
    return stays and rests and not (_passes(held, after, noise) or _follows(record, change, jump))


def _is_level(record: Record, change: float, first: float) -> bool:
    """Whether most of a change of the force up to a time [s] comes in the later half of the time before it: a force
    that changes all the time holds no level under which a cart could be seen to rest.
    """
    start = float(record.time[0])
    half_way, end = record.force_at([0.5 * (start + change), change])
    return bool(abs(half_way - first) < _SLOPE * abs(end - first))


def _moves(held: FloatArray, noise: Noise) -> bool:
    return float(np.ptp(held)) > 2.0 * _STILL * noise.floor + noise.step


def _departs(held: FloatArray, noise: Noise) -> bool:
    """Whether a cart leaves its first place as one does that a constant force pushes from rest, with x over t²: four
    times as far as in the first half of the time, where that is seen. One that creeps goes twice as far.
    """
    few = max(held.size // 10, 1)
    begin, middle, end = (float(np.median(part)) for part in (held[:few], _around(held, few), held[-few:]))
    half_way = abs(middle - begin)
    return half_way > _STILL * noise.floor + noise.step and abs(end - begin) > _SPEEDS_UP * half_way


def _around(held: FloatArray, few: int) -> FloatArray:
    """A few readings about the middle one."""
    return held[held.size // 2 - few // 2 :][:few]


def _passes(held: FloatArray, after: FloatArray, noise: Noise) -> bool:
    """Whether a cart moved before a change of the force, at least half as far as in the same time after it."""
    return _moves(held, noise) and float(np.ptp(held)) > 0.5 * float(np.ptp(after))


def _follows(record: Record, change: float, jump: float) -> bool:
    """Whether a change of the force [N] up to a time [s] is mostly what a controller makes of the motion before."""
    moved = float(np.interp(change, record.time, record.position)) - float(record.position[0])
    return abs(jump - feedback_gain(record) * moved) < 0.5 * abs(jump)


def since_before(record: Record) -> Record:
    """The record with its first force acting since long before its first sample."""
    time = record.force_time.copy()
    index = max(int(np.searchsorted(time, record.time[0], side="right")) - 1, 0)
    earliest = float(record.time[0]) - max(record.duration, 1.0)
    return replace(
        record,
        force_time=np.concatenate(([earliest], time[index + 1 :])),
        force=record.force[index:],
    )


def rest_before(record: Record, settling: float) -> Record | None:
    """The rest at the start of a record, before anything moves the cart.

    Friction holds the cart while a hand begins to pull, so the readings do not show when the pull began. The last
    ``settling`` seconds before the first motion are left out.

    Args:
        record: as measured.
        settling: time before the first motion in which a hand may already pull [s].

    Returns:
        The first part of the record, with its own stamps and the same zero of the encoder; None if it is too short.
    """
    begin = float(np.median(record.position[:MINIMUM_SAMPLES]))
    noise = noise_of(record)
    limit = _STILL * noise.floor + noise.step
    moved = np.flatnonzero(np.abs(record.position - begin) > limit)
    end = (float(record.time[moved[0]]) - settling) if moved.size else float(record.time[-1])
    if np.count_nonzero(record.time <= end) < MINIMUM_SAMPLES:
        return None
    return record.window(float(record.time[0]), end)
