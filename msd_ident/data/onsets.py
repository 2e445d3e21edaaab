"""Where the force steps: held levels of the force and the jumps between them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.quantity import MAD

#: A force that is held for less than this part of the time has no steps to speak of.
_HELD = 0.5
#: A step must be at least this part of the force's whole range.
_SMALLEST_JUMP = 0.05
#: A level may vary by this part of the force's range to either side and still count as held.
_FLATNESS = 0.02
#: A level must last for this many position samples.
_SHORTEST_LEVEL = 10
#: A measured force needs as many samples before its noise can be distinguished from its steps.
_MEASURED = 50
#: The force must rise within so many position samples, or within this part of the level that it rises to.
_RISE_SAMPLES, _RISE_SHARE = 3.0, 0.01


@dataclass(frozen=True)
class Level:
    """A held force.

    Attributes:
        start, end: [s].
        force: in the record's unit.
        std: its standard deviation; 0 for a command.
    """

    start: float
    end: float
    force: float
    std: float


@dataclass(frozen=True)
class Onset:
    """A step of the force.

    Attributes:
        time: [s].
        time_std: its standard deviation [s]. The stamp of a command is exact. A force sampled with the position stepped
            within one interval before or after its sample.
        before, after: the levels before and after the step.
    """

    time: float
    time_std: float
    before: Level
    after: Level

    @property
    def amplitude(self) -> float:
        """Change of the force, with its sign."""
        return self.after.force - self.before.force

    @property
    def amplitude_std(self) -> float:
        """Standard deviation of the amplitude, 0 for a command."""
        return math.hypot(self.before.std, self.after.std)


def _levels(record: Record) -> tuple[Level, ...]:
    """Held levels of the force within the record, in order; a force that never rests has none.

    The first level may be short: it is the rest before a first step.
    """
    stamps, force = _stream(record)
    shortest = _SHORTEST_LEVEL * record.period
    noise = _noise(force)
    flat = _FLATNESS * float(np.ptp(force))
    jumps = np.flatnonzero(np.abs(np.diff(force)) > max(flat, 7.0 * noise, 1e-12)) + 1
    found: list[Level] = []
    for first, last in zip([0, *jumps.tolist()], [*jumps.tolist(), force.size], strict=True):
        start, end = float(stamps[first]), _level_end(record, stamps, last)
        long_enough = first == 0 or end - start >= shortest
        if long_enough and float(np.ptp(force[first:last])) <= 2.0 * max(flat, 5.0 * noise, 1e-12):
            found.append(Level(start, end, float(np.mean(force[first:last])), noise / math.sqrt(last - first)))
    return tuple(found)


def _noise(force: FloatArray) -> float:
    """Standard deviation of a measured force's noise, from its differences; 0 for commands."""
    if force.size < _MEASURED:
        return 0.0
    return MAD / math.sqrt(2.0) * float(np.median(np.abs(np.diff(force))))


def _level_end(record: Record, stamps: FloatArray, last: int) -> float:
    """Until when the level whose samples end before ``last`` is held."""
    if last == stamps.size:
        return max(float(record.time[-1]), float(stamps[-1]))
    return float(stamps[last] if record.hold == "zero" else stamps[last - 1])


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
    """Steps of a force that is held for long: jumps between levels that follow each other without a gap."""
    held, period = _levels(record), record.period
    if sum(level.end - level.start for level in held) / record.duration < _HELD:
        return ()
    sampled = float(np.median(np.diff(record.force_time))) / math.sqrt(3.0) if record.force.size >= _MEASURED else 0.0
    smallest = _SMALLEST_JUMP * float(np.ptp([level.force for level in held])) if held else 0.0
    found = []
    for before, after in zip(held, held[1:], strict=False):
        rise = max(_RISE_SAMPLES * period, _RISE_SHARE * (after.end - after.start))
        if after.start - before.end <= rise and abs(after.force - before.force) > max(smallest, 1e-12):
            # Where the force takes a while to rise, or runs linearly between its stamps, the middle of it counts.
            time = 0.5 * (before.end + after.start)
            found.append(Onset(time, sampled, before, after))
    return tuple(found)


def is_constant(record: Record) -> bool:
    """Whether the force is the same from the first to the last position sample."""
    return float(np.ptp(_stream(record)[1][1:])) == 0.0 if record.force.size > 1 else True
