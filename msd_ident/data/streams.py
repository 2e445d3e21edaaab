"""Records from streams: samples with stamps, in the order in which they arrived."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict, TypeVar

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Hold, Origin, Record, check_finite
from msd_ident.data.turns import unwrapped
from msd_ident.errors import DataError
from msd_ident.quantity import counted

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: A sample that comes later than this [s] behind a newer one was not merely overtaken on the way.
LATEST_SECONDS = 1.0


#: What a note says of samples that were dropped though they tell something, since another one has their stamp.
OTHER_VALUES = "with another value"


class About(TypedDict, total=False):
    """What a source says of its record beside the samples, as in ``Record``."""

    hold: Hold
    hold_known: bool
    force_unit: str
    position_unit: str
    name: str
    origins: tuple[Origin, ...]


def from_stamps(
    position_ns: npt.ArrayLike,
    position: npt.ArrayLike,
    force_ns: npt.ArrayLike,
    force: npt.ArrayLike,
    notes: tuple[str, ...] = (),
    **about: Unpack[About],
) -> Record:
    """Record from two streams with absolute stamps, as messages have them.

    A live buffer and a bag with the same samples give exactly the same record. Time 0 is the first position stamp. A
    few late samples are sorted in, and a wrapped angle is unwrapped, each with a note. Of positions with one stamp the
    first is kept; of forces too, but for those that were sent ahead of their instant and then once more.

    Args:
        position_ns: (n,) stamps of the positions [ns], in order of arrival.
        position: (n,), in ``position_unit``.
        force_ns: (p,) stamps of the forces [ns] on the same clock, in order of arrival.
        force: (p,), in ``force_unit``.
        notes: as in ``Record``; what was done to the samples is added.
        about: as in ``Record``.

    Raises:
        DataError: as for ``Record``, and when the stamps of a stream run backwards.
    """
    found: list[str] = list(notes)
    ns_x, x = _ordered(_Stream("position", 1e-9), np.asarray(position_ns, dtype=np.int64), position, found)
    told = _Stream("force", 1e-9, ns_x[0], replaced=True)
    ns_f, f = _ordered(told, np.asarray(force_ns, dtype=np.int64), force, found)
    start = int(ns_x[0])
    # Division by 1e9 rounds once, so that rint(time * 1e9) gives the stamp back; a product with 1e-9 does not.
    time = (ns_x - start) / 1e9
    x = _unwrapped(time, x, about, found)
    return Record(
        time=time,
        position=x,
        force_time=(ns_f - start) / 1e9,
        force=f,
        start_ns=start,
        notes=tuple(found),
        **about,
    )


def from_seconds(
    position_time: npt.ArrayLike,
    position: npt.ArrayLike,
    force_time: npt.ArrayLike,
    force: npt.ArrayLike,
    notes: tuple[str, ...] = (),
    **about: Unpack[About],
) -> Record:
    """Record from two streams with stamps in seconds, as a table has them; otherwise as ``from_stamps``.

    Of lines with one stamp the first is kept, for the force too.

    Args:
        position_time: (n,) stamps of the positions [s].
        position: (n,), in ``position_unit``.
        force_time: (p,) stamps of the forces [s] on the same clock.
        force: (p,), in ``force_unit``.
        notes, about: as of ``from_stamps``.

    Raises:
        DataError: as for ``from_stamps``.
    """
    found: list[str] = list(notes)
    t_x, x = _ordered(_Stream("position", 1.0), np.asarray(position_time, dtype=np.float64), position, found)
    t_f, f = _ordered(_Stream("force", 1.0, t_x[0]), np.asarray(force_time, dtype=np.float64), force, found)
    x = _unwrapped(t_x, x, about, found)
    return Record(
        time=t_x - t_x[0],
        position=x,
        force_time=t_f - t_x[0],
        force=f,
        notes=tuple(found),
        **about,
    )


def batch_stamps(first_ns: int, period_ns: int, count: int) -> npt.NDArray[np.int64]:
    """Stamps (count,) [ns] of samples that were taken at a fixed period and sent as one message.

    Args:
        first_ns: stamp of the first sample [ns].
        period_ns: period [ns].
        count: number of samples.
    """
    return np.asarray(first_ns + period_ns * np.arange(count, dtype=np.int64), dtype=np.int64)


def _unwrapped(time: FloatArray, position: FloatArray, about: About, notes: list[str]) -> FloatArray:
    """The position, unwrapped if it is a wrapped angle; ``notes`` grows."""
    if about.get("position_unit") != "rad":
        return position
    position, note = unwrapped(time, position)
    notes += [note] if note else []
    return position


Stamps = TypeVar("Stamps", npt.NDArray[np.int64], FloatArray)


@dataclass(frozen=True)
class _Stream:
    """What the samples of a stream are.

    Attributes:
        what: position or force.
        tick: unit of its stamps [s].
        begin: stamp of the first position, where these are forces.
        replaced: a sample may replace one with the same stamp, which was sent ahead of its instant.
    """

    what: str
    tick: float
    begin: float | None = None
    replaced: bool = False


def _ordered(stream: _Stream, stamps: Stamps, values: npt.ArrayLike, notes: list[str]) -> tuple[Stamps, FloatArray]:
    """Samples in rising order of their stamps, one each; ``notes`` grows."""
    what, tick = stream.what, stream.tick
    data = np.asarray(values, dtype=np.float64)
    if stamps.size != data.size:
        raise DataError(f"{stamps.size} stamps for {data.size} {what} values; expected as many of each")
    if stamps.size == 0:
        raise DataError(f"no {what} samples; expected at least one: check that the {what} was published and recorded")
    check_finite(np.asarray(stamps, dtype=np.float64), f"{what} time")
    again = _sent_again(stamps) if stream.replaced else np.zeros(stamps.size, dtype=np.bool_)
    taken_back = _taken_back(stamps, data, again)
    late = _late(stream, stamps, data, taken_back)
    if late:
        notes.append(f"{what}: {late} of {stamps.size} samples came late and were sorted by their stamps.")
    if stream.begin is not None and (early := _out_of_order(stamps, stream.begin)):
        notes.append(f"{what}: {early} samples from before the positions came out of order and were sorted.")
    unique, kept = _kept(stamps, again)
    dropped = stamps.size - unique.size
    if what == "position" and unique.size < MINIMUM_SAMPLES <= stamps.size:
        raise DataError(
            f"{stamps.size} position samples have only {unique.size} different stamps; expected one each: check the "
            f"time column, or what stamps the messages{_even(stamps, tick)}"
        )
    if dropped:
        differs = data != data[kept][np.searchsorted(unique, stamps)]
        back = int(np.count_nonzero(differs & np.isin(stamps, stamps[taken_back])))
        other = int(np.count_nonzero(differs)) - back
        differ = f", {back} of them replaced by a 0 that was sent later" if back else ""
        differ += f", {other} of them {OTHER_VALUES}" if other else ""
        if other > stamps.size // 10 and unique.size > 1:
            differ += f": {_shared(stamps, unique, tick)}"
        notes.append(f"{what}: {dropped} samples with duplicate stamps were dropped{differ}.")
    return unique, data[kept]


def _sent_again(stamps: Stamps) -> npt.NDArray[np.bool_]:
    """Which samples have a stamp that was there before an older one came: sent ahead of its instant, and once more.

    Neighbours with one stamp are not among them: they are samples of a clock that ticks rarely.
    """
    unique, first = np.unique(stamps, return_index=True)
    fell = np.diff(stamps, prepend=stamps[:1]) < 0
    fallen = np.maximum.accumulate(np.where(fell, np.arange(stamps.size), -1))
    return np.asarray(first[np.searchsorted(unique, stamps)] < fallen, dtype=np.bool_)


def _kept(stamps: Stamps, again: npt.NDArray[np.bool_]) -> tuple[Stamps, npt.NDArray[np.int64]]:
    """Rising stamps, and which sample counts for each: the last one that was sent again, or else the first."""
    unique, kept = np.unique(stamps, return_index=True)
    resent = np.flatnonzero(again)
    kept[np.searchsorted(unique, stamps[resent])] = resent
    return unique, kept


def _taken_back(stamps: Stamps, data: FloatArray, again: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Which forces are a 0 that takes the place of a force that was sent ahead of its instant.

    Who stops sends 0 with the present stamp, and then 0 with each stamp ahead, which is there already.
    """
    back = np.asarray(again & (data == 0.0), dtype=np.bool_)
    back[:-1] |= (data[:-1] == 0.0) & (stamps[:-1] < stamps[1:]) & back[1:]
    return back


def _shared(stamps: Stamps, unique: Stamps, tick: float) -> str:
    """Why many samples share their stamps, in words: the clock stood still, or ticks rarely."""
    times = np.unique(stamps, return_counts=True)[1]
    most = int(np.argmax(times))
    if np.median(times) == 1 and times[most] > (stamps.size - unique.size) // 2:
        at = tick * float(unique[most] - unique[0])
        return f"the clock stood still at {at:.3f} s, for {times[most]} samples, which say nothing of when they were"
    ticks = tick * float(np.median(np.diff(unique)))
    said = f"their clock ticks every {ticks:.3g} s, so force and position may be as far apart"
    return said + _even(stamps, tick)


def _even(stamps: Stamps, tick: float) -> str:
    """What to do with a table whose samples were taken evenly, in words; a bag has stamps of messages."""
    span = float(np.max(stamps) - np.min(stamps))
    last = int(np.count_nonzero(stamps == np.max(stamps)))
    if tick != 1.0 or span <= 0.0:
        return ""
    return (
        f"; if the samples were taken evenly, give their rate, about {(stamps.size - last) / span:.4g} Hz, with --rate"
    )


def _late(stream: _Stream, stamps: Stamps, data: FloatArray, taken_back: npt.NDArray[np.bool_]) -> int:
    """Number of samples that are older than one before them.

    Not of forces that were there before, as where a rig tells what it was told, nor of those from before the positions
    (``_from_before``), nor of those that are ``taken_back``.

    Raises:
        DataError: they are more than chance delays on the way explain, or one is late by more than
            ``LATEST_SECONDS`` and no repetition of an earlier one.
    """
    what, tick = stream.what, stream.tick
    behind = (np.maximum.accumulate(stamps) - stamps) * tick
    late = np.flatnonzero((behind > 0) & ~taken_back)
    repeated = _repeated(stamps, data, late)
    if stream.begin is not None:
        kept = ~(_from_before(stamps, stream.begin)[late] | repeated)
        late, repeated = late[kept], repeated[kept]
    far = behind[late] > LATEST_SECONDS
    if late.size > max(5, stamps.size // 100) or np.any(far & ~repeated):
        i = int(late[np.argmax(far)])  # the first one if none is far
        raise DataError(
            f"{what} stamps run backwards: {behind[i]:.3f} s back at sample {i + 1} of {stamps.size} "
            f"({counted(int(late.size), 'sample')} in all); expected rising stamps: {_why_late(stamps)}"
        )
    return int(late.size)


def _why_late(stamps: Stamps) -> str:
    """Why stamps run backwards, and what to do."""
    steps = np.diff(stamps)
    if np.all(steps <= 0):
        return "they run from the end to the beginning, sort them by time"
    looped = "the recording was looped or its clock was reset, use one pass of it"
    fell = int(np.flatnonzero(steps < 0)[0])
    for alone in (fell, fell + 1):  # too late a stamp, or too early a one
        if np.all(np.diff(np.delete(stamps, alone)) > 0):
            return f"sample {alone + 1} alone is out of place, remove it; or {looped}"
    intervals = np.diff(np.sort(stamps))
    even = np.abs(intervals - np.median(intervals)) < 0.25 * np.median(intervals)
    if np.count_nonzero(steps < 0) > max(10, stamps.size // 10) and np.mean(even) > 0.9:
        return "their order is that of something else, sort them by time"
    return looped


def _repeated(stamps: Stamps, data: FloatArray, late: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Whether each of some samples was there before, with the same stamp and value."""
    unique, first = np.unique(stamps, return_index=True)
    before = first[np.searchsorted(unique, stamps[late])]
    return np.asarray((before < late) & (data[before] == data[late]), dtype=np.bool_)


def _from_before(stamps: Stamps, begin: float) -> npt.NDArray[np.bool_]:
    """Which forces are from before the first position, where the stream ends within the record or never gets there.

    A publisher that keeps its commands sends them all to one who listens late, and goes on. A clock that is set back
    stays there.
    """
    before = np.asarray(stamps < begin, dtype=np.bool_)
    return before if not before[-1] or before.all() else np.zeros(before.size, dtype=np.bool_)


def _out_of_order(stamps: Stamps, begin: float) -> int:
    """Number of forces from before the first position that came behind newer ones."""
    return int(np.count_nonzero(_from_before(stamps, begin) & (np.maximum.accumulate(stamps) > stamps)))
