"""Readings that no motion explains: outliers are left out, jumps of the encoder's zero are corrected.

The speed limits how far a cart moves between two samples. So a reading that leaves its neighbours and comes back is not
a position of the cart, and a jump after which the motion goes on with the same speed is a change of the zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from msd_ident.data.compiled import ranked
from msd_ident.data.noise import noise_of
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Record

#: A wild reading is this many usual steps from its neighbours, and so many times the noise; a run of them is short.
_WILD_STEPS, _WILD_NOISE, _LONGEST_RUN = 8.0, 30.0, 3
#: Times that the search is repeated, each time with the worst left out: they hide each other.
_PASSES = 5
#: More than this part of the readings is no accident but another signal.
_MOST_WILD = 0.05
#: A jump of the zero is so many times the noise and the change of speed beside it; there are few of them.
_JUMP_NOISE, _JUMP_STEPS, _JUMP_BENDS, _MOST_JUMPS = 14.0, 8.0, 2.5, 3
#: A jump of the force is this part of its range. So many others are looked at, each this part of it at least.
_WITH_FORCE, _ALIKE, _MOST_STEPS = 0.1, 0.2, 20
#: Samples to each side from which speed and size of a jump are estimated.
_SIDE = 10
#: Steps to each side that a sudden one is compared with.
_BESIDE = 3


@dataclass(frozen=True)
class Jump:
    """The zero moved by ``size`` [unit of the position] between the sample ``index - 1`` and ``index``."""

    index: int
    size: float


@dataclass(frozen=True)
class Cleaned:
    """A record without what no motion makes.

    Attributes:
        record: the rest.
        wild: (w,) indices of the readings left out.
        height: how far the furthest of them was from its neighbours.
        jumps: of the zero, indices of ``record``; taken back.
    """

    record: Record
    wild: npt.NDArray[np.intp]
    height: float
    jumps: tuple[Jump, ...]


def clean(record: Record) -> Cleaned:
    """Leave out outliers and take back jumps of the zero; a record without any is returned as it is."""
    wild, height = _wild(record)
    if wild.size > _MOST_WILD * record.samples or record.samples - wild.size < MINIMUM_SAMPLES:
        wild, height = wild[:0], 0.0
    kept = record
    if wild.size:
        chosen = np.ones(record.samples, dtype=bool)
        chosen[wild] = False
        kept = replace(record, time=record.time[chosen], position=record.position[chosen])
    jumps = _jumps(kept)
    if jumps:
        position = kept.position.copy()
        for jump in jumps:
            position[jump.index :] -= jump.size
        kept = replace(kept, position=position)
    return Cleaned(kept, wild, height, jumps)


def as_it_is(record: Record) -> Cleaned:
    """A record from which nothing is left out."""
    return Cleaned(record, np.zeros(0, dtype=np.intp), 0.0, ())


def removed(record: Record, cleaned: Cleaned) -> Iterator[Finding]:
    """Wild readings that were left out, and jumps of the zero that were taken back."""
    unit, wild = record.position_unit, cleaned.wild
    if wild.size:
        many = wild.size > 1
        what, whose = ("single readings jump", "their") if many else ("single reading jumps", "its")
        first = f"the first at {record.time[wild[0]]:.3f} s" if many else f"at {record.time[wild[0]]:.3f} s"
        yield warning(
            "outliers",
            f"{wild.size} {what} away from {whose} neighbours, by up to {cleaned.height:.4g} {unit} ({first}): left "
            "out; check the encoder's cable",
        )
    for jump in cleaned.jumps:
        at = cleaned.record.time[jump.index]
        yield warning(
            "zero_shift",
            f"the position jumps by {jump.size:.4g} {unit} within one sample at {at:.3f} s and goes on with the same "
            "speed: the encoder's zero moved; what follows was shifted back, check cable and coupling",
        )


def _wild(record: Record) -> tuple[npt.NDArray[np.intp], float]:
    """Indices of readings that leave their neighbours and come back, and how far the furthest did."""
    if not np.ptp(record.position):
        return np.zeros(0, dtype=np.intp), 0.0
    noise = noise_of(record)
    least = _WILD_NOISE * max(noise.floor, noise.step)
    left = np.arange(record.samples)
    highest = 0.0
    for _ in range(_PASSES):
        position = record.position[left]
        usual = _usual(np.abs(np.diff(position)), 0.6)
        height = _ends(position)
        for run in range(1, _LONGEST_RUN + 1):
            height = np.maximum(height, _excursion(position, run))
        bad = height > np.maximum(_WILD_STEPS * usual, least)
        if not np.any(bad):
            break
        highest = max(highest, float(np.max(height[bad])))
        left = left[~bad]
    return np.setdiff1d(np.arange(record.samples), left), highest


def _excursion(position: FloatArray, run: int) -> FloatArray:
    """How far each reading stands off both neighbours of a run of so many that leave and come back, else 0.

    A longer run must come back to where it left.
    """
    out = position[1:-run] - position[: -run - 1]
    back = position[run:-1] - position[run + 1 :]
    away = np.minimum(np.abs(out), np.abs(back))
    returns = (out * back > 0) & ((run == 1) | (np.abs(out - back) < 0.5 * away))
    away = np.where(returns, away, 0.0)
    height = np.zeros(position.size)
    for i in range(1, run + 1):
        part = height[i : i + away.size]
        np.maximum(part, away, out=part)
    return height


def _ends(position: FloatArray) -> FloatArray:
    """How far the first and the last reading stand off their only neighbour, where no motion beside them does; else 0.

    A record may end a few samples after a push: what is usual there is no more than rest.
    """
    height = np.zeros(position.size)
    steps = np.abs(np.diff(position))
    for end, beside in ((0, steps[: _LONGEST_RUN + 1]), (-1, steps[: -_LONGEST_RUN - 2 : -1])):
        if beside[0] > _WILD_STEPS * np.max(beside[1:], initial=0.0):
            height[end] = beside[0]
    return height


def _usual(steps: FloatArray, share: float) -> FloatArray:
    """Step that is usual around each reading: larger than this share of those around it, however wild the others."""
    reach = min(2 * _SIDE, steps.size)
    typical = ranked(steps, int(share * reach), reach)
    index = np.clip(np.arange(steps.size + 1) - reach // 2, 0, typical.size - 1)
    return typical[index]


@dataclass(frozen=True)
class Sudden:
    """Places where the readings go on from another place with the same speed.

    Attributes:
        index: (q,) of the reading behind each.
        size: (q,) step there beyond the usual one.
        usual: (q,) mean step of the readings beside it.
        least: size below which noise may do it.
    """

    index: npt.NDArray[np.intp]
    size: FloatArray
    usual: FloatArray
    least: float


def sudden(record: Record) -> Sudden:
    """Steps far beyond those around them, which do not change the speed."""
    position, reach = record.position, _BESIDE
    if position.size < 4 * _SIDE:
        return Sudden(np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros(0), 0.0)
    steps = np.diff(position)
    kernel = np.full(reach, 1.0 / reach)
    mean = np.convolve(steps, kernel, mode="valid")  # of steps i to i + reach - 1
    before, after = mean[: -reach - 1], mean[reach + 1 :]
    inner = steps[reach : steps.size - reach]
    beside = 0.5 * (before + after)
    off, change = inner - beside, np.abs(after - before)
    noise = noise_of(record)
    shaking = max(noise.floor, noise.step / 2)
    least = _JUMP_NOISE * shaking
    usual = _usual(np.abs(off), 0.5)[:-1]  # a jump is seen in seven of twenty
    # An encoder that was stuck and comes back to where the cart is stood still before and moves on after.
    stuck = np.abs(before) + 3.0 * shaking < np.abs(after)
    found = (np.abs(off) > np.maximum(_JUMP_STEPS * usual, least)) & (change < 0.3 * np.abs(off))
    interval = np.diff(record.time)[reach : steps.size - reach]
    chosen = np.flatnonzero(found & ~((before == 0.0) & stuck) & (interval < 2.5 * record.period))
    return Sudden(chosen + reach + 1, off[chosen], beside[chosen], least)


def _jumps(record: Record) -> tuple[Jump, ...]:
    """Jumps of the zero: there are few of them."""
    places = sudden(record)
    found = [int(i) for i in places.index]
    if not 0 < len(found) <= _MOST_JUMPS:
        return ()
    steps, least = np.diff(record.position), places.least
    # The force may do the same to a cart that is read seldom: its steps show what acceleration can do elsewhere.
    bends = np.abs(np.diff(steps))
    for index in found:
        bends[max(index - _BESIDE - 2, 0) : index + _BESIDE] = 0.0
    least = max(least, _JUMP_BENDS * float(np.max(bends)))
    sizes = ((index, _size(record, index)) for index in found)
    return tuple(Jump(i, size) for i, size in sizes if abs(size) > least and not _with_force(record, i, size))


def _with_force(record: Record, index: int, size: float) -> bool:
    """Whether a jump comes with one of the force, and others of the force make alike ones: the sensor hears the force.

    Args:
        record: the measurement.
        index, size: of the jump of the position [m].
    """
    force = np.asarray(record.force_at(record.time))
    steps = np.diff(force)
    near = slice(max(index - 2, 0), index + 1)
    step = float(steps[near][np.argmax(np.abs(steps[near]))])
    if not abs(step) > _WITH_FORCE * float(np.ptp(force)):
        return False
    others = np.flatnonzero(np.abs(steps) > _ALIKE * abs(step)) + 1
    others = others[(np.abs(others - index) > _SIDE) & (others > _SIDE) & (others < force.size - _SIDE)][:_MOST_STEPS]
    alike = [_size(record, int(i)) / float(steps[i - 1]) for i in others]
    return not alike or abs(float(np.median(alike)) - size / step) < 0.5 * abs(size / step)


def _size(record: Record, index: int) -> float:
    """Height of a jump: a parabola through the samples around it, and a step."""
    part = slice(max(index - _SIDE, 0), index + _SIDE)
    time = record.time[part] - record.time[index]
    time = time / float(np.max(np.abs(time)))
    columns = np.stack([np.ones_like(time), time, time**2, time**3, (np.arange(time.size) >= index - part.start) * 1.0])
    solution = np.linalg.lstsq(columns.T, record.position[part], rcond=None)[0]
    return float(solution[-1])
