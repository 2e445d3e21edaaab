"""A force that acts in the first line: did it begin there, or had it acted before the record began?

A table has no line before its first. Where the cart rests under the force until it changes, it has acted before; where
it moves at once, it stepped.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.record import Record

#: A force below this part of its range is a rest and no push.
_PUSH = 0.3
#: Change of the force, in parts of its range, that ends its first level.
_CHANGE = 0.05
#: Motion per force under the first level, relative to that after the next change, below which the cart rests.
_RESTS = 0.25


def begins_pushed(record: Record) -> bool:
    """Whether a force acts in the first sample and none is known before it."""
    start = float(record.time[0])
    before, first = record.force_at([np.nextafter(start, -np.inf), start])
    return bool(before == 0.0 and first != 0.0)


def rests_under_force(record: Record) -> bool:
    """Whether the record begins pushed and the cart does not answer until the force changes."""
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
    height = abs(float(record.force_at([change])[0]) - first)
    return float(np.ptp(held)) / abs(first) < _RESTS * float(np.ptp(after)) / max(height, _CHANGE * span)


def since_before(record: Record) -> Record:
    """The record with its first force acting since long before it."""
    time = record.force_time.copy()
    index = max(int(np.searchsorted(time, record.time[0], side="right")) - 1, 0)
    earliest = float(record.time[0]) - max(record.duration, 1.0)
    return replace(
        record,
        force_time=np.concatenate(([earliest], time[index + 1 :])),
        force=record.force[index:],
    )
