"""Order and timing of the messages of a replay. Without ROS."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from msd_ident.io import RawMessage

#: Period of ``/clock`` in a replay, in the bag's time [ns].
CLOCK_PERIOD_NS = 10_000_000


@dataclass(frozen=True)
class Tick:
    """An instant of the bag's time at which ``/clock`` is published [ns]."""

    log_time_ns: int


def with_ticks(messages: Iterable[RawMessage], period_ns: int) -> Iterator[RawMessage | Tick]:
    """The messages with ticks of the clock between them, the first before all of them."""
    due: int | None = None
    for message in messages:
        if due is None:
            due = message.log_time_ns
        while due <= message.log_time_ns:
            yield Tick(due)
            due += period_ns
        yield message


class ReplayRate:
    """Waits for the instants of a bag at a rate, counted from one start, so that no error adds up.

    Args:
        rate: playback speed.
        stop: ends every wait.
    """

    def __init__(self, rate: float, stop: threading.Event) -> None:
        self._rate = rate
        self._stop = stop
        self._begin: tuple[int, float] | None = None
        self.worst = 0.0

    def wait(self, log_time_ns: int) -> bool:
        """Wait until an instant [ns]; false when stopped. ``worst`` keeps the greatest delay [s]."""
        if self._begin is None:
            self._begin = log_time_ns, time.monotonic()
        first_ns, start = self._begin
        due = start + (log_time_ns - first_ns) / 1e9 / self._rate
        left = due - time.monotonic()
        if left > 0:
            self._stop.wait(left)
        else:
            self.worst = max(self.worst, -left)
        return not self._stop.is_set()
