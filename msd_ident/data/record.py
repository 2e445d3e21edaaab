"""Record: one measurement of force and position, validated when it is made, and immutable.

Force and position may have stamps of their own: a robot graph sends a force when it
changes and an encoder value every millisecond. ``time`` belongs to ``position``,
``force_time`` to ``force``; where both share one clock the two are equal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from msd_ident.errors import DataError

FloatArray = npt.NDArray[np.float64]
Hold = Literal["zero", "linear"]

#: Fewest position samples that any estimate may be made from.
MINIMUM_SAMPLES = 20

#: Sizes of force and position, and shortest and longest times [s], beyond which nothing mechanical was measured.
SMALLEST, LARGEST = 1e-20, 1e20
SHORTEST_PERIOD, LONGEST_DURATION = 1e-10, 1e12

_Made = TypeVar("_Made")
#: Samples of a record up to which it keeps what was found out about it: on these, models are tried by the hundred.
_ROOM = 50_000


def _frozen(values: npt.ArrayLike, what: str) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    if array.ndim != 1:
        raise DataError(f"{what} has {array.ndim} dimensions; expected one value per sample")
    array.setflags(write=False)
    return array


def check_finite(array: FloatArray, what: str) -> None:
    """Refuse values that are not finite.

    Args:
        array: (n,).
        what: name of the values for the message.

    Raises:
        DataError: a value is NaN or infinite.
    """
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise DataError(
            f"{what} holds {bad.size} values that are not finite (first: {array[bad[0]]} at sample "
            f"{bad[0]}); expected numbers only: remove or repair those samples"
        )


def _check_size(array: FloatArray, what: str, unit: str) -> None:
    largest = float(np.max(np.abs(array)))
    if largest > LARGEST or 0.0 < largest < SMALLEST:
        raise DataError(
            f"{what} reaches {largest:.3g} {unit}; expected sizes from {SMALLEST:g} to {LARGEST:g}: repair the "
            "samples, or check the scale"
        )


def _check_duration(time: FloatArray) -> None:
    duration = float(time[-1] - time[0])
    period = duration / (time.size - 1)
    if period < SHORTEST_PERIOD or duration > LONGEST_DURATION:
        raise DataError(
            f"{time.size} position samples in {duration:.3g} s; expected times in seconds: check the time column and "
            "its scale"
        )


def _check_increasing(array: FloatArray, what: str) -> None:
    step = np.diff(array)
    back = np.flatnonzero(step < 0)
    if back.size:
        i = int(back[0])
        raise DataError(
            f"{what} runs backwards {back.size} times (first: {array[i]:.6f} s then {array[i + 1]:.6f} s at "
            f"sample {i + 1}); expected rising stamps: cut the record there or use one recording at a time"
        )
    same = np.flatnonzero(step == 0)
    if same.size:
        i = int(same[0])
        raise DataError(
            f"{what} holds {same.size} duplicate stamps (first: {array[i]:.6f} s at sample {i + 1}); "
            "expected one sample an instant: drop the duplicates"
        )


@dataclass(frozen=True)
class Origin:
    """Where a signal came from.

    Attributes:
        signal: ``position`` or ``force``.
        topic: its topic; empty for a column of a file.
        lost: what its publisher numbered and never came: samples of batches, else messages.
    """

    signal: Literal["position", "force"]
    topic: str
    lost: int = 0


@dataclass(frozen=True)
class Record:
    """Force in, position out.

    Attributes:
        time: (n,) stamps of the position samples [s], rising; usually from 0.
        position: (n,) measured position, in ``position_unit``.
        force_time: (p,) stamps of the force values [s], rising, on the same clock as ``time``.
        force: (p,) commanded or measured force, in ``force_unit``.
        hold: how the force goes on between its stamps: ``zero`` (held until the next value)
            or ``linear``. Before the first stamp it is 0, after the last one it is held.
        hold_known: False where the source does not say how the force goes on (a measured force in a table), so that
            ``hold`` is a guess which the data may correct (``msd_ident.workflow.force_hold``).
        lead: time [s] by which the stamps of the force stand earlier than they were told, because each value begins to
            act before its stamp (``resampling.led``).
        upsampled: force values per measured one: above 1 where a band-limited force was interpolated.
        force_unit: ``N``, ``N·m``, or whatever the source has when the gain is unknown (``V``).
        position_unit: ``m`` or ``rad``, or ``count`` when the scale is unknown.
        name: short name for tables (a file name, a topic).
        start_ns: absolute stamp of ``time == 0`` [ns], 0 when there is none.
        origin: instant from which laws of time (a drift, a disturbance) count it [s]: where the part in use begins.
        notes: what the reader had to do to get here, one sentence each; shown with every result.
        origins: where the signals came from, and what was lost on the way.

    Raises:
        DataError: fewer than ``MINIMUM_SAMPLES`` samples, lengths that differ, values that are not
            finite or of a size that nothing has, stamps that do not rise, or force and position that do not overlap
            in time.
    """

    time: FloatArray
    position: FloatArray
    force_time: FloatArray
    force: FloatArray
    hold: Hold = "zero"
    hold_known: bool = True
    lead: float = 0.0
    upsampled: int = 1
    force_unit: str = "N"
    position_unit: str = "m"
    name: str = "record"
    start_ns: int = 0
    origin: float = 0.0
    notes: tuple[str, ...] = field(default=())
    origins: tuple[Origin, ...] = ()

    def __post_init__(self) -> None:
        for key in ("time", "position", "force_time", "force"):
            object.__setattr__(self, key, _frozen(getattr(self, key), key.replace("_", " ")))
        if self.hold not in ("zero", "linear"):
            raise DataError(f"hold is {self.hold!r}; expected 'zero' or 'linear'")
        if self.time.size != self.position.size:
            raise DataError(f"{self.time.size} stamps for {self.position.size} positions; expected as many of each")
        if self.force_time.size != self.force.size:
            raise DataError(f"{self.force_time.size} stamps for {self.force.size} forces; expected as many of each")
        if self.time.size < MINIMUM_SAMPLES:
            raise DataError(
                f"{self.time.size} position samples; expected at least {MINIMUM_SAMPLES}: record longer or faster"
            )
        if self.force.size < 1:
            raise DataError("no force samples; expected at least one: record the force, or say that it is zero")
        check_finite(self.time, "time")
        check_finite(self.force_time, "force time")
        check_finite(self.position, "position")
        check_finite(self.force, "force")
        _check_increasing(self.time, "time")
        _check_increasing(self.force_time, "force time")
        _check_size(self.position, "position", self.position_unit)
        _check_size(self.force, "force", self.force_unit)
        _check_duration(self.time)
        if self.force_time[0] > self.time[-1]:
            raise DataError(
                f"force starts at {self.force_time[0]:.3f} s, after the last position at {self.time[-1]:.3f} s; "
                "expected signals that overlap in time: check the clocks of the two publishers"
            )
        dense = self.force.size > 10
        if dense and self.force_time[-1] < self.time[0]:
            raise DataError(
                f"force ends at {self.force_time[-1]:.3f} s, before the first position at {self.time[0]:.3f} s; "
                "expected signals that overlap in time: check the clocks of the two publishers"
            )

    @property
    def samples(self) -> int:
        """Number of position samples."""
        return int(self.time.size)

    @property
    def duration(self) -> float:
        """Time from the first to the last position sample [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def period(self) -> float:
        """Median time between position samples [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def shared_clock(self) -> bool:
        """Whether force and position have the same stamps."""
        return self.time.size == self.force_time.size and bool(np.array_equal(self.time, self.force_time))

    def kept(self, name: Hashable, make: Callable[[], _Made], *, small: bool = False) -> _Made:
        """Result of ``make``, kept with the record so that it is computed once.

        Results of a record with many samples are not kept, for the sake of memory.

        Args:
            name: key of the result.
            make: computes the result from this record alone.
            small: the result is small, and kept whatever the number of samples.
        """
        if self.samples > _ROOM and not small:
            return make()
        if name not in self._kept:
            self._kept[name] = make()
        made: _Made = self._kept[name]
        return made

    @cached_property
    def _kept(self) -> dict[Hashable, Any]:
        return {}

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_kept"}

    def force_at(self, time: npt.ArrayLike) -> FloatArray:
        """Force at any instants [s], as ``hold`` says; 0 before the first stamp."""
        at = np.asarray(time, dtype=np.float64)
        if self.hold == "linear":
            return np.asarray(np.interp(at, self.force_time, self.force, left=0.0), dtype=np.float64)
        index = np.searchsorted(self.force_time, at, side="right") - 1
        return np.where(index < 0, 0.0, self.force[np.maximum(index, 0)])

    def window(self, start: float, end: float) -> Record:
        """The part of the record between two instants, with the force that acts at its start. Its clock stays the same.

        Args:
            start, end: [s]; samples at both instants are included.

        Raises:
            DataError: fewer than ``MINIMUM_SAMPLES`` samples lie inside.
        """
        keep = (self.time >= start) & (self.time <= end)
        if np.count_nonzero(keep) < MINIMUM_SAMPLES:
            raise DataError(
                f"{np.count_nonzero(keep)} position samples {_between(start, end)}; expected at least "
                f"{MINIMUM_SAMPLES} of the record's {self.time[0]:.3f} s to {self.time[-1]:.3f} s: choose another "
                "start or end"
            )
        first = max(int(np.searchsorted(self.force_time, start, side="right")) - 1, 0)
        last = int(np.searchsorted(self.force_time, end, side="right"))
        last = min(last + (self.hold == "linear"), self.force.size)
        force_time, force = self.force_time[first : max(last, first + 1)], self.force[first : max(last, first + 1)]
        time = self.time[keep]
        if force_time[0] > time[-1]:  # there is none before the first stamp
            force_time, force = time[:1], np.zeros(1)
        if np.max(np.abs(force)) < SMALLEST:  # what a filter has left of a force long before, or leads it in with
            force = np.zeros(force.size)
        return replace(self, time=time, position=self.position[keep], force_time=force_time, force=force)

    def cut(self, start: float, end: float) -> Record:
        """A window whose laws of time begin with it: what was before it has no part in what it shows.

        Args:
            start, end: as of ``window``.

        Raises:
            DataError: as ``window``.
        """
        part = self.window(start, end)
        return replace(part, origin=float(part.time[0]))

    def from_origin(self) -> Record:
        """The same record on the clock of laws of time, which is 0 at ``origin``."""
        if self.origin == 0.0:
            return self
        return replace(self, time=self.time - self.origin, force_time=self.force_time - self.origin, origin=0.0)


def _between(start: float, end: float) -> str:
    """A window in words; an end that is infinite is none."""
    if not math.isfinite(end):
        return f"from {start:.3f} s on"
    return f"between {start:.3f} s and {end:.3f} s" if math.isfinite(start) else f"up to {end:.3f} s"


def from_samples(
    time: npt.ArrayLike, force: npt.ArrayLike, position: npt.ArrayLike, *, hold: Hold = "zero", name: str = "record"
) -> Record:
    """Record whose force and position share their stamps.

    Args:
        time: stamps [s] (n,), rising.
        force: force [N] (n,) at the stamps.
        position: position [m] (n,) at the stamps.
        hold: force between the stamps, ``zero`` (held) or ``linear``; for a band-limited one see ``resampling``.
        name: of the record, for sentences and files.

    Raises:
        DataError: as for ``Record``.
    """
    return Record(
        time=np.asarray(time),
        position=np.asarray(position),
        force_time=np.asarray(time),
        force=np.asarray(force),
        hold=hold,
        name=name,
    )
