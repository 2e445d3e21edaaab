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

#: Jump between two new readings of a moving cart, at least [encoder steps], and longest stretch without one [samples].
_JUMP, _LONGEST = 5, 20
#: Fewest repeated stretches, and part of the samples in them, that are no accident.
_FEWEST, _PART = 10, 0.05
#: Part of the force's changes that come with a new reading, a sample early or late, where one message brings both.
_TOGETHER = 0.9


@dataclass(frozen=True)
class Renewed:
    """A record without repeated readings.

    Attributes:
        record: the rest; the record as it is where readings do not repeat.
        every: samples from one new reading to the next; 0 where readings do not repeat.
    """

    record: Record
    every: int


def without_repeats(record: Record) -> Renewed:
    """Leave out the readings that an encoder repeats while the cart moves.

    A force that changes when a new reading comes was brought by the same message: its repeated values go too.
    """
    change = np.flatnonzero(np.diff(record.position)) + 1
    moving = _between_jumps(record.position, change, encoder_step(record))
    every = _usual(np.diff(change), moving)
    if np.sum(np.diff(change)[moving & (np.diff(change) > 1)]) <= _PART * record.samples or every < 2:
        return Renewed(record, 0)
    kept = _new(record.samples, change, moving, every)
    if kept.size < MINIMUM_SAMPLES:
        return Renewed(record, every)
    time = record.time[kept]
    rest = replace(record, time=time, position=record.position[kept])
    if _one_message(record, kept):
        rest = replace(rest, force_time=time, force=record.force_at(time))
    return Renewed(rest, every)


def repeated(record: Record, renewed: Renewed) -> Iterator[Finding]:
    """What was left out of a record."""
    if renewed.every:
        yield warning(
            "held_samples",
            f"the position changes only every {renewed.every} samples "
            f"({1e3 * record.period * renewed.every:.3g} ms) while the cart moves: the encoder is read more slowly "
            f"than it is published, or the table was resampled; only new readings are used ({renewed.record.samples} "
            f"of {record.samples})",
        )


def _between_jumps(position: FloatArray, change: npt.NDArray[np.intp], step: float) -> npt.NDArray[np.bool_]:
    """(c - 1,) whether the cart moves on between a change of the reading and the next one: short, and from one jump of
    many encoder steps to another in the same direction. Where the cart turns around, two readings may be equal.

    Args:
        position: (n,) readings.
        change: (c,) indices of readings that differ from the one before.
        step: of the encoder.
    """
    jump = np.diff(position)[change - 1]
    onward = jump[:-1] * jump[1:] > 0.0
    return onward & (np.minimum(np.abs(jump[:-1]), np.abs(jump[1:])) >= _JUMP * step) & (np.diff(change) <= _LONGEST)


def _usual(size: npt.NDArray[np.intp], moving: npt.NDArray[np.bool_]) -> int:
    """Usual samples of a stretch in which the cart moves; 0 unless most of these repeat a reading.

    An encoder that is read seldom repeats all of them; noise, rounding and a lost reading repeat one now and then.
    """
    short = size[moving]
    several = np.count_nonzero(short > 1)
    return 0 if several < _FEWEST or 2 * several <= short.size else int(np.median(short))


def _new(samples: int, change: npt.NDArray[np.intp], moving: npt.NDArray[np.bool_], every: int) -> npt.NDArray[np.intp]:
    """Indices of new readings: where one differs, and each interval after it where the cart rests."""
    edges = np.concatenate(([0], change, [samples]))
    moves = np.concatenate(([False], moving, [False]))
    stretches = zip(edges[:-1].tolist(), edges[1:].tolist(), moves.tolist(), strict=True)
    return np.concatenate([np.arange(start, start + 1 if on else stop, every) for start, stop, on in stretches])


def _one_message(record: Record, kept: npt.NDArray[np.intp]) -> bool:
    """Whether a force on the position's stamps changes where a new reading comes."""
    if record.hold_known or not np.array_equal(record.force_time, record.time):
        return False
    change = np.flatnonzero(np.diff(record.force)) + 1
    near = np.isin(change, np.concatenate((kept - 1, kept, kept + 1)))
    return bool(change.size) and float(np.mean(near)) >= _TOGETHER
