"""Readings that repeat the one before because the encoder was not read again: only new readings are used.

An encoder that is read more slowly than it is published, or a table that was resampled with the last value held, shows
a staircase. Between its steps the cart moves on, so each repeated reading is wrong by what the cart has moved since.
Where the cart rests, a repeated reading is right: there one is kept for each interval between readings.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from msd_ident.data.noise import encoder_step
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record

#: Jump between two new readings of a moving cart, at least [encoder steps].
_JUMP = 5
#: Percentile of the jumps that stands for the step of an encoder whose readings lie on no grid.
_SMALL = 5.0
#: Fewest repeated stretches, and part of the samples in them, that are no accident.
_FEWEST, _PART = 10, 0.05
#: Part of the usual interval between readings by which most intervals may differ: a cart that sticks and slips waits
#: for longer or shorter.
_EVEN = 0.25
#: Part of the force's changes that come with a new reading, all as early or late, where one message brings both.
_TOGETHER = 0.9
#: Correlation of force and position from which the cart follows a staircase of the force without any delay.
_FOLLOWS = 0.99

_Places = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Renewed:
    """A record without repeated readings.

    Attributes:
        record: the rest; the record as it is where readings do not repeat, or not evenly.
        every: samples from one new reading to the next; 0 where readings do not repeat.
    """

    record: Record
    every: int


def without_repeats(record: Record) -> Renewed:
    """Leave out the readings that an encoder repeats while the cart moves, where new ones come evenly.

    A force that changes when a new reading comes was brought by the same message: its repeated values go too.
    """
    change = np.flatnonzero(np.diff(record.position)) + 1
    moving = _between_jumps(record.position, change, encoder_step(record))
    size = np.diff(change)
    every = _usual(size, moving)
    if every < 2 or np.sum(size[moving & (size > 1)]) <= _PART * record.samples:
        return Renewed(record, 0)
    least, most = np.percentile(size[moving], (10.0, 90.0))
    if most - least > max(_EVEN * every, 1.0):  # at a rate that is no whole part of the record's, one sample is usual
        return Renewed(record, every)
    resting = np.concatenate(([True], ~moving, [True])) & (np.diff(change, prepend=0, append=record.samples) > most)
    return Renewed(_renewed(record, change, resting, every), every)


def repeated(record: Record, renewed: Renewed) -> Iterator[Finding]:
    """What was left out of a record."""
    if renewed.every:
        used = f"only new readings are used ({renewed.record.samples} of {record.samples})"
        if renewed.record is record:
            used = "record it at the rate at which it is read"
        yield warning(
            "held_samples",
            f"the position changes only every {renewed.every} samples "
            f"({1e3 * record.period * renewed.every:.3g} ms) while the cart moves: the encoder is read more slowly "
            f"than it is published, or the table was resampled; {used}",
        )


def _between_jumps(position: FloatArray, change: _Places, step: float) -> npt.NDArray[np.bool_]:
    """(c - 1,) whether the cart moves on between a change of the reading and the next one: from one jump of many
    encoder steps to another in the same direction. Where the cart turns around, two readings may be equal.

    Args:
        position: (n,) readings.
        change: (c,) indices of readings that differ from the one before.
        step: of the encoder; 0 where the readings lie on no grid.
    """
    jump = np.diff(position)[change - 1]
    if not jump.size:
        return np.zeros(0, dtype=np.bool_)
    least = _JUMP * (step or float(np.percentile(np.abs(jump), _SMALL)))
    onward = jump[:-1] * jump[1:] > 0.0
    return np.asarray(onward & (np.minimum(np.abs(jump[:-1]), np.abs(jump[1:])) >= least))


def _usual(size: _Places, moving: npt.NDArray[np.bool_]) -> int:
    """Usual samples of a stretch in which the cart moves; 0 unless most of these repeat a reading.

    An encoder that is read seldom repeats all of them; noise, rounding and a lost reading repeat one now and then.
    """
    short = size[moving]
    several = np.count_nonzero(short > 1)
    return 0 if several < _FEWEST or 2 * several <= short.size else int(np.median(short))


def _renewed(record: Record, change: _Places, resting: npt.NDArray[np.bool_], every: int) -> Record:
    """The record at its new readings; as it is where too few are left, or the cart follows the force at once.

    Args:
        record: the measurement.
        change: (c,) indices of readings that differ from the one before.
        resting: (c + 1,) whether the cart rests before and after each of them, for longer than an interval.
        every: usual samples from one new reading to the next.
    """
    late = _lateness(record, change, every)
    pulled = np.zeros(0, dtype=np.intp) if late is None else np.flatnonzero(np.diff(record.force)) + 1 - late
    kept = _new(np.concatenate(([0], change, [record.samples])), resting, every, pulled)
    if kept.size < MINIMUM_SAMPLES:
        return record
    time, position = record.time[kept], record.position[kept]
    if late is None:
        return replace(record, time=time, position=position)
    force = record.force[np.minimum(kept + max(late, 0), record.samples - 1)]
    if np.ptp(force) > 0.0 and abs(np.corrcoef(force, position)[0, 1]) > _FOLLOWS:
        return record
    return replace(record, time=time, position=position, force_time=time, force=force)


def _new(edges: _Places, resting: npt.NDArray[np.bool_], every: int, pulled: _Places) -> _Places:
    """Indices of new readings: where one differs, and at rest where a message brings another force, and each interval.

    Args:
        edges: (s + 1,) begins of the stretches of equal readings, and the end of the last.
        resting: (s,) whether the cart rests in each.
        every: samples from one new reading to the next.
        pulled: indices at which a message brings another force; empty where it comes on its own.
    """
    found = [edges[:-1]]
    for start, stop in zip(edges[:-1][resting].tolist(), edges[1:][resting].tolist(), strict=True):
        messages = pulled[(pulled > start) & (pulled < stop)]
        grid = np.arange(start + every, stop - every // 2, every)
        alone = np.searchsorted(messages, grid - every // 2) == np.searchsorted(messages, grid + every // 2 + 1)
        found += [messages, grid[alone]]
    return np.unique(np.concatenate(found))


def _lateness(record: Record, change: _Places, every: int) -> int | None:
    """Samples by which a force comes after the reading of its message, -1 to 1; None where it has a pace of its own.

    Changes of the force while the reading changes tell; all of them are as early or late.
    """
    if record.hold_known or not np.array_equal(record.force_time, record.time):
        return None
    pulled = np.flatnonzero(np.diff(record.force)) + 1
    after = np.searchsorted(change, pulled, side="right")
    ends = np.concatenate(([-record.samples], change, [2 * record.samples]))
    pulled = pulled[(pulled - ends[after] <= every) & (ends[after + 1] - pulled <= every)]
    if pulled.size < _FEWEST:
        return None
    shares = {late: float(np.mean(np.isin(pulled - late, change))) for late in (0, -1, 1)}
    late = max(shares, key=lambda one: shares[one])
    return late if shares[late] >= _TOGETHER else None
