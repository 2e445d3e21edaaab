"""Where the force steps: held levels of the force and the jumps between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.record import FloatArray, Record

#: A step must be at least this part of the force's whole range.
_SMALLEST_JUMP = 0.05
#: A level may vary by this part of the force's range and still count as held.
_FLATNESS = 0.02
#: A level must last for this many position samples.
_SHORTEST_LEVEL = 10


@dataclass(frozen=True)
class Level:
    """A force that was held: from ``start`` to ``end`` [s] at ``force``."""

    start: float
    end: float
    force: float


@dataclass(frozen=True)
class Onset:
    """A jump of the force at ``time`` [s] from one level to the next, which lasts until ``end`` [s]."""

    time: float
    end: float
    before: float
    after: float

    @property
    def amplitude(self) -> float:
        """Change of the force, with its sign."""
        return self.after - self.before


def levels(record: Record) -> tuple[Level, ...]:
    """Held levels of the force within the record, in order; a force that never rests has none.

    The first level may be short: it is the rest before a first step.
    """
    stamps, force = _stream(record)
    tolerance = max(_FLATNESS * float(np.ptp(force)), 1e-12)
    ends = np.append(stamps[1:], max(float(record.time[-1]), float(stamps[-1])))
    jumps = np.flatnonzero(np.abs(np.diff(force)) > tolerance) + 1
    found: list[Level] = []
    for first, last in zip([0, *jumps.tolist()], [*jumps.tolist(), force.size], strict=True):
        long_enough = first == 0 or ends[last - 1] - stamps[first] >= _SHORTEST_LEVEL * record.period
        if long_enough and float(np.ptp(force[first:last])) <= 2.0 * tolerance:
            found.append(Level(float(stamps[first]), float(ends[last - 1]), float(np.median(force[first:last]))))
    return tuple(found)


def _stream(record: Record) -> tuple[FloatArray, FloatArray]:
    """Stamps and force within the record; from just before its first sample, where a first stamp is a step from 0."""
    start = float(record.time[0])
    before = start - 0.5 * record.period
    inside = record.force_time > before
    return (
        np.concatenate(([before], np.maximum(record.force_time[inside], start))),
        np.concatenate((record.force_at([before]), record.force[inside])),
    )


def onsets(record: Record) -> tuple[Onset, ...]:
    """Steps of the force: jumps between neighbouring levels that follow each other at once."""
    span = float(np.ptp(record.force_at(record.time)))
    held = levels(record)
    found = []
    for before, after in zip(held, held[1:], strict=False):
        sudden = after.start - before.end <= 3.0 * record.period
        if sudden and abs(after.force - before.force) > _SMALLEST_JUMP * span:
            # A force that runs linearly between its stamps rises in the middle of the interval.
            time = 0.5 * (before.end + after.start) if record.hold == "linear" else after.start
            found.append(Onset(time, after.end, before.force, after.force))
    return tuple(found)


def held_share(record: Record) -> float:
    """Part of the record's duration during which the force rests on some level, 0 to 1."""
    return sum(level.end - level.start for level in levels(record)) / record.duration
