"""Gaps of a record in which the force is not known: the longest part without one is used.

A model is simulated with the force from the first sample to the last. Over a gap of some samples the last value stands
for those that are missing. Over a long one it does not, and everything behind it is wrong. A force on a clock of its
own is not missing because positions are, and neither is one that is the same for as long before a gap and behind it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.motion import observe
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.quality.sampling import SHORT_GAP
from msd_ident.data.record import Record

#: Part of the time between two turning points beyond which a gap is long; and of the duration where there are few.
_LONG, _LONG_IN_ALL = 0.25, 0.02
#: Part of its range by which a force may change around a gap and still count as constant.
_CHANGES = 0.02
#: Part of a force's intervals that are even where it is a signal; commands come when they change.
_EVEN, _REGULAR = 0.75, 0.25
#: Interval of the force, in its usual ones, in which values are lost.
_LOST = 1.5
#: What the longest part must have to stand for the record: samples, and parts of its samples and of its travel.
_FEWEST, _ENOUGH, _TRAVEL = 100, 0.25, 0.25
#: Most other parts that are named, and least part of the samples that they have.
_NAMED, _WORTH = 3, 0.1


@dataclass(frozen=True)
class Continuous:
    """The longest part of a record in which the force is known.

    Attributes:
        record: the part; the record as it is where it has no long gap, or no part that can stand for it.
        gaps: (g,) indices of the samples before the long gaps.
        parts: from the first sample to the last of each part [s].
        whole: as it came.
    """

    record: Record
    gaps: npt.NDArray[np.intp]
    parts: tuple[tuple[float, float], ...]
    whole: Record


def continuous(record: Record) -> Continuous:
    """The longest part without a long gap in which the force is not known."""
    gaps = _unknown(record)
    first, last = np.append(0, gaps + 1), np.append(gaps, record.samples - 1)
    parts = tuple((float(record.time[i]), float(record.time[j])) for i, j in zip(first, last, strict=True))
    longest = int(np.argmax(last - first))
    samples, inside = int(last[longest] - first[longest]) + 1, slice(first[longest], last[longest] + 1)
    enough = samples >= max(_FEWEST, _ENOUGH * record.samples)
    travels = np.ptp(record.position[inside]) >= _TRAVEL * np.ptp(record.position)
    used = record.cut(*parts[longest]) if gaps.size and enough and travels else record
    return Continuous(used, gaps, parts, record)


def left_out(found: Continuous) -> Iterator[Finding]:
    """What a long gap takes away, and the options that choose another part."""
    if not found.gaps.size:
        return
    time, samples = found.whole.time, found.whole.samples
    lengths = np.diff(time)[found.gaps]
    longest = int(np.argmax(lengths))
    many = f"{found.gaps.size} long gaps, the longest " if found.gaps.size > 1 else "a long gap "
    what = (
        f"the force is not known in {many}of {_seconds(lengths[longest])} s at {_seconds(time[found.gaps[longest]])} s"
    )
    if found.record is found.whole:
        yield warning(
            "long_gap",
            f"{what}, and no part without one is long enough to stand for the record: what follows a gap is wrong by "
            f"what the force did there; record again without losses{_others(found, samples)}",
        )
        return
    used = found.record
    yield warning(
        "long_gap",
        f"{what}: only the longest part without one is used, {_seconds(used.time[0])} s to {_seconds(used.time[-1])} s "
        f"({100 * used.samples / samples:.0f} % of the samples){_others(found, samples)}",
    )


def _others(found: Continuous, samples: int) -> str:
    """Ready options for the longest of the parts that are not used."""
    time, used = found.whole.time, found.record
    sizes = {part: np.count_nonzero((time >= part[0]) & (time <= part[1])) for part in found.parts}
    spare = [part for part in found.parts if part[0] != used.time[0] or used is found.whole]
    spare = sorted((part for part in spare if sizes[part] >= _WORTH * samples), key=lambda part: -sizes[part])
    named = [
        f"--start {_seconds(start)} --end {_seconds(end)} ({100 * sizes[start, end] / samples:.0f} %)"
        for start, end in spare[:_NAMED]
    ]
    return f"; for another part, use {' or '.join(named)}" if named else ""


def _seconds(instant: float) -> str:
    return f"{round(float(instant), 4):.12g}"


def _unknown(record: Record) -> npt.NDArray[np.intp]:
    """Samples behind which the position is missing for long, and the force with it."""
    none, intervals = np.zeros(0, dtype=np.intp), np.diff(record.time)
    long = np.flatnonzero(intervals > SHORT_GAP * record.period)
    if not long.size or not _is_signal(record):
        return none
    half = observe(record).half_period
    least = _LONG * half if half else _LONG_IN_ALL * record.duration
    return np.array([i for i in long if intervals[i] > least and _force_changes(record, int(i))], dtype=np.intp)


def _is_signal(record: Record) -> bool:
    """Whether the force is sampled, and not commanded when it changes."""
    intervals = np.diff(record.force_time)
    return bool(intervals.size and np.mean(np.abs(intervals / np.median(intervals) - 1.0) < _REGULAR) >= _EVEN)


def _force_changes(record: Record, i: int) -> bool:
    """Whether the force is not known behind sample ``i``: stamps of it are missing there, and it changes around."""
    begin, end = float(record.time[i]), float(record.time[i + 1])
    stamps = record.force_time
    last, following = np.searchsorted(stamps, begin + 0.5 * record.period) - 1, np.searchsorted(stamps, end)
    if last < 0 or following >= stamps.size:
        return False
    if np.max(np.diff(stamps[last : following + 1]), initial=0.0) < _LOST * np.median(np.diff(stamps)):
        return False
    around = record.force[(stamps >= begin - (end - begin)) & (stamps <= end + (end - begin))]
    return bool(around.size and np.ptp(around) > _CHANGES * np.ptp(record.force))
