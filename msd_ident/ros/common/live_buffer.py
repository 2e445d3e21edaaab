"""The live buffer: the latest samples of force and position, bounded, of one recording. Without ROS.

Stamps are not trusted. A clock that is set, a replay in a loop, a publisher that restarts: each begins a new
recording, since no model runs across it. A single stamp from elsewhere, a sample that comes twice and a stamp that
stands still are left out. All of it is counted and reported.
"""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Hold, Record
from msd_ident.data.streams import LATEST_SECONDS, from_stamps
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.ring_buffer import Ring, StampArray

__all__ = ["Counts", "LiveBuffer", "Ring", "StampArray"]

#: A stamp this much behind the newest one is no late sample but of a clock that was set back [ns].
_SET_BACK_NS = int(LATEST_SECONDS * 1e9)
#: A position this much after the one before does not belong to the same recording [ns].
_PAUSE_NS = 10 * 10**9
#: A force that acts so much later than the newest position is stamped by another clock [ns].
_AHEAD_NS = 600 * 10**9
#: Messages in a row that come late in their order, over this time [ns]: the clock was set back by less than a second.
_BEHIND_MESSAGES, _BEHIND_NS = 10, 50_000_000
#: Samples with one stamp that are kept, for the record's own note.
_STANDING = 5
#: Latest samples among which one that comes again is looked for.
_TAIL = 1000


@dataclass(frozen=True)
class Counts:
    """What the buffer has seen since it was made.

    Attributes:
        positions: position samples that came.
        forces: force samples that came.
        late: samples older than one before them.
        duplicates: samples that came twice.
        restarts: times that a new recording starts.
        wild: samples left out because their stamps belong nowhere.
    """

    positions: int = 0
    forces: int = 0
    late: int = 0
    duplicates: int = 0
    restarts: int = 0
    wild: int = 0


@dataclass(frozen=True)
class Units:
    """Units of the values that come, as those of a ``Record``."""

    force: str = "N"
    position: str = "m"


class LiveBuffer:
    """Latest samples of both signals; safe for one writing and several reading threads.

    Args:
        capacity: samples of either signal that are kept.
        hold: how the force goes on between its samples.
        units: of force and position values.
        free: no force acts (free decay), so that none is waited for.
        watch: counts what goes wrong.
    """

    def __init__(
        self,
        capacity: int,
        *,
        hold: Hold = "zero",
        units: Units = Units(),  # noqa: B008 - frozen
        free: bool = False,
        watch: FaultLog | None = None,
    ) -> None:
        self.position = Ring(capacity)
        self.force = Ring(capacity)
        self._hold: Hold = hold
        self._units = units
        self._free = free
        self._watch = watch or FaultLog()
        self._lock = threading.RLock()
        self._positions = self._forces = self._late = self._duplicates = self._restarts = self._wild = 0
        self._suspect: tuple[StampArray, FloatArray] | None = None
        self._other_forces: deque[tuple[int, float]] = deque(maxlen=_TAIL)
        self._standing = self._dropped = 0
        self._behind = (0, 0, 0)  # messages, first stamp, last stamp
        self._acting: tuple[int, float] | None = None  # newest force before the samples were forgotten

    @property
    def counts(self) -> Counts:
        """What was seen so far."""
        seen = (self._positions, self._forces, self._late, self._duplicates, self._restarts, self._wild)
        return Counts(*seen)

    def add_position(self, ns: int, value: float) -> None:
        """Take one position sample."""
        with self._lock:
            if self._suspect is None and self.position.newest_ns < ns <= self.position.newest_ns + _PAUSE_NS:
                self._positions += 1
                self._standing, self._behind = 0, (0, 0, 0)
                self.position.append(ns, value)
            else:
                self.add_positions(np.array([ns], dtype=np.int64), np.array([value]))

    def add_positions(self, ns: StampArray, values: FloatArray) -> None:
        """Take the samples of one batch, whose stamps rise."""
        if not ns.size:
            return
        with self._lock:
            self._positions += int(ns.size)
            first, newest = int(ns[0]), self.position.newest_ns
            if not self.position.size or newest < first <= newest + _PAUSE_NS:
                self._leave_out_suspect()
                self._standing, self._behind = 0, (0, 0, 0)
                self.position.extend(ns, values)
            elif self._suspect is not None and 0 <= first - int(self._suspect[0][-1]) <= _PAUSE_NS:
                self._begin_with_suspect()
                self.position.extend(ns, values)
            elif not newest - _SET_BACK_NS <= first <= newest + _PAUSE_NS:
                self._leave_out_suspect()
                self._suspect = (ns, values)
            elif first == newest:
                self._stand(ns, values)
            else:
                self._fall_behind(ns, values)

    def add_force(self, ns: int, value: float) -> None:
        """Take one force sample; one of another clock waits until the position follows it."""
        with self._lock:
            self._forces += 1
            if self.force.size and ns < self.force.newest_ns - _SET_BACK_NS and not self._takes_back(ns, value):
                self._other_force(ns, value, "behind the one before it", self.force.newest_ns - ns)
            elif self.position.size and ns > self.position.newest_ns + _AHEAD_NS:
                self._other_force(ns, value, "ahead of the position", ns - self.position.newest_ns)
            else:
                self._duplicates += ns == self.force.newest_ns
                self._late += ns < self.force.newest_ns
                self.force.append(ns, value)

    def _takes_back(self, ns: int, value: float) -> bool:
        """Whether a force may be a 0 that replaces one that was sent ahead, as where a run is stopped."""
        return value == 0.0 and bool(self.position.size) and ns >= self.position.newest_ns - _SET_BACK_NS

    def recent(self, seconds: float) -> tuple[StampArray, FloatArray]:
        """Position samples of the last seconds by stamp, in order of arrival."""
        with self._lock:
            ns, values = self.position.samples()
            newest = self.position.newest_ns
        keep = ns >= newest - round(seconds * 1e9)
        return ns[keep], values[keep]

    def record(self) -> Record:
        """All that is in the buffer, made into a record as the bag reader does it.

        Raises:
            DataError: as ``streams.from_stamps``.
        """
        with self._lock:
            ns_x, x = self.position.samples()
            ns_f, f = self.force.samples()
            dropped, acting = self._dropped, self._acting
            if self.position.size == self.position.capacity:  # what acted before the first sample has gone with it
                first = np.flatnonzero(ns_f <= ns_x.min())[-1:]
                ns_f, f = ns_f[first[0] if first.size else 0 :], f[first[0] if first.size else 0 :]
        notes: tuple[str, ...] = ()
        if self._free and ns_x.size:
            ns_f, f = ns_x.min(keepdims=True), np.zeros(1)
        elif acting is not None and ns_x.size and not np.any(ns_f <= ns_x.min()):
            ns_f, f = np.append(min(acting[0], int(ns_x.min())), ns_f), np.append(acting[1], f)
        if dropped:
            notes = (f"position: {dropped} repeated samples, or samples with a repeated stamp, were left out.",)
        return from_stamps(
            ns_x,
            x,
            ns_f,
            f,
            hold=self._hold,
            force_unit=self._units.force,
            position_unit=self._units.position,
            name="live",
            notes=notes,
        )

    def clear(self) -> None:
        """Forget all samples; the counts go on, and so do the force that acts, which is not told again, and forces that
        were sent ahead.
        """
        with self._lock:
            sent, forces = self.force.samples()
            ns, latest = np.unique(sent[::-1], return_index=True)  # of one stamp, the one that came last counts
            values = forces[::-1][latest]
            now = self.position.newest_ns if self.position.size else np.iinfo(np.int64).max
            if (acted := np.count_nonzero(ns <= now)) > 0:
                self._acting = (int(ns[acted - 1]), float(values[acted - 1]))
            self.position.clear()
            self.force.clear()
            self.force.extend(ns[acted:], values[acted:])
            self._suspect, self._dropped = None, 0

    def begin_anew(self) -> None:
        """A new recording begins: the positions so far go, the force that acts stays."""
        with self._lock:
            self._restarts += 1
            self.position.clear()
            self._suspect, self._dropped = None, 0
            self._standing, self._behind = 0, (0, 0, 0)

    def _leave_out_suspect(self) -> None:
        if self._suspect is None:
            return
        ns, _ = self._suspect
        self._suspect = None
        self._wild += int(ns.size)
        apart = (int(ns[0]) - self.position.newest_ns) / 1e9
        self._watch.note("wild stamps", f"a stamp {apart:+.6g} s from the others, left out", int(ns.size))

    def _begin_with_suspect(self) -> None:
        """Two in a row agree that the clock was set: what came first begins the new recording."""
        assert self._suspect is not None
        ns, values = self._suspect
        first = int(ns[0])
        apart = (first - self.position.newest_ns) / 1e9
        self.begin_anew()
        if self.force.size:
            self._acting = None
        self.force.keep_before(first)
        for at, force in self._other_forces:
            if abs(at - first) <= _AHEAD_NS:
                self.force.append(at, force)
        self._other_forces.clear()
        self.position.extend(ns, values)
        way = "back" if apart < 0 else "forward"
        self._watch.note(f"clock set {way}", f"the clock jumped {way} by {abs(apart):.6g} s: a new recording starts")

    def _stand(self, ns: StampArray, values: FloatArray) -> None:
        """The stamp is the one before again."""
        self._duplicates += int(ns.size)
        self._standing += 1
        if self._standing <= _STANDING:
            self._watch.note("duplicates", "samples come twice", int(ns.size))
            self.position.extend(ns, values)
            return
        self._dropped += int(ns.size)
        self._watch.note("stamps stand still", f"the stamps of {self._standing} samples in a row stand still")

    def _fall_behind(self, ns: StampArray, values: FloatArray) -> None:
        """Older than the newest by less than a second: again, late, or of a clock that was set back a little."""
        again = self._had(ns, values)
        messages, first, last = self._behind
        follows = messages and int(ns[0]) > last
        if not again.all():
            self._behind = (messages + 1, first, int(ns[-1])) if follows else (1, int(ns[0]), int(ns[-1]))
        messages, first, last = self._behind
        if messages >= _BEHIND_MESSAGES and last - first >= _BEHIND_NS:
            back = (self.position.newest_ns - int(ns[-1])) / 1e9
            self.begin_anew()
            self._watch.note("clock set back", f"the clock jumped back by {back:.3g} s: a new recording starts")
            self.position.extend(ns, values)
            return
        fresh = ~again
        self._duplicates += int(again.sum())
        self._dropped += int(again.sum())
        self._late += int(fresh.sum())
        if again.any():
            self._watch.note("duplicates", "samples come twice", int(again.sum()))
        if fresh.any():
            self._watch.note("late", "samples come late, behind newer ones", int(fresh.sum()))
            self.position.extend(ns[fresh], values[fresh])

    def _had(self, ns: StampArray, values: FloatArray) -> npt.NDArray[np.bool_]:
        """Which of the samples are among the latest already, stamp and value."""
        stamps, had = self.position.samples(_TAIL)
        order = np.argsort(stamps, kind="stable")
        place = np.minimum(np.searchsorted(stamps[order], ns), stamps.size - 1)
        found = order[place]
        return np.asarray((stamps[found] == ns) & (had[found] == values))

    def _other_force(self, ns: int, value: float, where: str, apart_ns: int) -> None:
        self._other_forces.append((ns, value))
        sentence = (
            f"a force is stamped {apart_ns / 1e9:.6g} s {where}: are there two clocks? It waits for a position at "
            "that time"
        )
        self._watch.note("forces of another clock", sentence)
