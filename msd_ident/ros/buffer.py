"""The live buffer: the latest samples of force and position, bounded, without ROS."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.errors import UsageError
from msd_ident.record import LATEST_SECONDS, FloatArray, Hold, Origin, Record, from_stamps

StampArray = npt.NDArray[np.int64]

#: A stamp this much behind the newest one is no late sample but a clock that was set back [ns].
_SET_BACK_NS = int(LATEST_SECONDS * 1e9)


class Ring:
    """Stamped values in order of arrival; when full, the oldest go out. Not safe for threads by itself."""

    def __init__(self, capacity: int) -> None:
        if capacity < 1:
            raise UsageError(f"a buffer of {capacity} samples; expected at least 1")
        self._ns = np.zeros(capacity, dtype=np.int64)
        self._values = np.zeros(capacity)
        self._next = 0
        self.size = 0
        self.newest_ns = 0

    @property
    def capacity(self) -> int:
        """Samples that fit."""
        return int(self._ns.size)

    def append(self, ns: int, value: float) -> None:
        """Take one sample."""
        self.newest_ns = max(ns, self.newest_ns) if self.size else ns
        self._ns[self._next] = ns
        self._values[self._next] = value
        self._next = (self._next + 1) % self.capacity
        self.size = min(self.size + 1, self.capacity)

    def extend(self, ns: StampArray, values: FloatArray) -> None:
        """Take samples in the order given; of more than fit, the last ones."""
        if not ns.size:
            return
        self.newest_ns = max(int(ns.max()), self.newest_ns) if self.size else int(ns.max())
        ns, values = ns[-self.capacity :], values[-self.capacity :]
        at = (self._next + np.arange(ns.size)) % self.capacity
        self._ns[at], self._values[at] = ns, values
        self._next = int(at[-1] + 1) % self.capacity
        self.size = min(self.size + int(ns.size), self.capacity)

    def samples(self, last: int | None = None) -> tuple[StampArray, FloatArray]:
        """Copies of stamps and values, oldest first; of the ``last`` ones only when given."""
        count = self.size if last is None else min(last, self.size)
        at = (self._next - count + np.arange(count)) % self.capacity
        return self._ns[at], self._values[at]

    def clear(self) -> None:
        """Forget all samples."""
        self._next = self.size = self.newest_ns = 0

    def keep_before(self, ns: int) -> None:
        """Forget the samples at or after a stamp."""
        stamps, values = self.samples()
        old = stamps < ns
        self.clear()
        self.extend(stamps[old], values[old])


@dataclass(frozen=True)
class Counts:
    """What the buffer has seen since it was made.

    Attributes:
        positions: position samples taken.
        forces: force samples taken.
        late: samples older than one before them.
        duplicates: samples with the stamp of the one before them.
        restarts: times that the clock jumped back and the buffer began anew.
    """

    positions: int = 0
    forces: int = 0
    late: int = 0
    duplicates: int = 0
    restarts: int = 0


class LiveBuffer:
    """Latest samples of both signals; safe for one writing and several reading threads.

    Args:
        capacity: samples of either signal that are kept.
        hold: how the force goes on between its samples.
        force_unit: of the force values.
        position_unit: of the position values.
        free: no force acts (free decay), so that none is waited for.
    """

    def __init__(
        self,
        capacity: int,
        *,
        hold: Hold = "zero",
        force_unit: str = "N",
        position_unit: str = "m",
        free: bool = False,
    ) -> None:
        self.position = Ring(capacity)
        self.force = Ring(capacity)
        self._hold: Hold = hold
        self._units = (force_unit, position_unit)
        self._free = free
        self._lock = threading.Lock()
        self._positions = self._forces = self._late = self._duplicates = self._restarts = 0

    @property
    def counts(self) -> Counts:
        """What was seen so far."""
        return Counts(self._positions, self._forces, self._late, self._duplicates, self._restarts)

    def add_position(self, ns: int, value: float) -> None:
        """Take one position sample."""
        with self._lock:
            self._positions += 1
            self._watch(self.position, ns)
            self.position.append(ns, value)

    def add_positions(self, ns: StampArray, values: FloatArray) -> None:
        """Take the samples of one batch."""
        if not ns.size:
            return
        with self._lock:
            self._positions += int(ns.size)
            self._watch(self.position, int(ns[0]))
            self.position.extend(ns, values)

    def add_force(self, ns: int, value: float) -> None:
        """Take one force sample."""
        with self._lock:
            self._forces += 1
            self._watch(self.force, ns)
            self.force.append(ns, value)

    def recent(self, seconds: float) -> tuple[StampArray, FloatArray]:
        """Position samples of the last seconds by stamp, in order of arrival."""
        with self._lock:
            ns, values = self.position.samples()
            newest = self.position.newest_ns
        keep = ns >= newest - round(seconds * 1e9)
        return ns[keep], values[keep]

    def record(self, notes: tuple[str, ...] = (), origins: tuple[Origin, ...] = ()) -> Record:
        """All that is in the buffer, made into a record as the bag reader does it.

        Raises:
            DataError: as ``record.from_stamps``.
        """
        with self._lock:
            ns_x, x = self.position.samples()
            ns_f, f = self.force.samples()
        if self._free and ns_x.size:
            ns_f, f = ns_x.min(keepdims=True), np.zeros(1)
        force_unit, position_unit = self._units
        return from_stamps(
            ns_x,
            x,
            ns_f,
            f,
            hold=self._hold,
            force_unit=force_unit,
            position_unit=position_unit,
            name="live",
            notes=notes,
            origins=origins,
        )

    def clear(self) -> None:
        """Forget all samples; the counts go on."""
        with self._lock:
            self.position.clear()
            self.force.clear()

    def _watch(self, ring: Ring, ns: int) -> None:
        """Count what is out of order; a clock that was set back (a replay in a loop) begins a new recording."""
        if not ring.size or ns > ring.newest_ns:
            return
        if ns < ring.newest_ns - _SET_BACK_NS:
            self._restarts += 1
            self.position.clear()
            self.force.keep_before(ns)
        elif ns == ring.newest_ns:
            self._duplicates += 1
        else:
            self._late += 1
