"""Counts missing samples by the publisher's sequence numbers and by the stamps. Without ROS."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field
from statistics import median

#: Intervals that are looked at together, and how many of them must be alike for their median to be a period.
_TOGETHER, _ALIKE = 50, 0.7
#: An interval within this part of the period is a regular one, one beyond this many periods a hole.
_REGULAR, _HOLE = 0.25, 1.5
#: A longer interval is a pause or a clock that was set, no hole [ns].
_PAUSE_NS = 10 * 10**9
#: Messages, and messages a second, from which on they count as a stream, and the silence [s] that ends it.
_STREAM, _STREAM_RATE, SILENCE = 50, 5.0, 2.0
#: Holes that are remembered one by one.
_REMEMBERED = 10_000


@dataclass
class TopicCount:
    """Messages of one topic so far.

    Attributes:
        received: messages handed over.
        lost: messages that their publisher numbered and that never came, as far as they came from one publisher: two
            number each its own messages, and nothing tells them apart.
        restarts: numbers that fell: a publisher restarted, or there are two.
        holes: samples that a regular train of stamps lacks.
        last_received: when the last one came, on the monotonic clock [s]; 0.0: never.
    """

    received: int = 0
    lost: int = 0
    restarts: int = 0
    holes: int = 0
    last_received: float = 0.0
    _times: deque[float] = field(default_factory=lambda: deque(maxlen=_STREAM), repr=False)
    _last: int | None = field(default=None, repr=False)
    _stamp: int | None = field(default=None, repr=False)
    _intervals: list[int] = field(default_factory=list, repr=False)

    def count(self, sequence: int | None, stamp_ns: int | None = None, *, alone: bool = True) -> int:
        """Count a message by its publisher's number and its stamp [ns]; how many before it are lost by the number.

        ``alone``: the topic has one publisher, whose numbers tell what is lost.
        """
        self.received += 1
        self.last_received = time.monotonic()
        self._times.append(self.last_received)
        if stamp_ns is not None:
            self._follow(stamp_ns)
        if sequence is None:
            return 0
        lost = 0
        if self._last is not None and sequence <= self._last:
            self.restarts += 1
        elif self._last is not None and alone:
            lost = sequence - self._last - 1
        self.lost += lost
        self._last = sequence
        return lost

    def jumps(self, sequence: int | None) -> bool:
        """Whether a message with this number would be counted as one after lost ones."""
        return sequence is not None and self._last is not None and sequence > self._last + 1

    @property
    def rate(self) -> float:
        """Messages a second, over the latest ones; 0.0 when there are too few to tell."""
        if len(self._times) < _STREAM:
            return 0.0
        return (_STREAM - 1) / max(self._times[-1] - self._times[0], 1e-9)

    @property
    def silence(self) -> float:
        """Time since the last message [s], where they came in a stream and do no more; else 0.0."""
        silent = time.monotonic() - self.last_received
        return silent if self.rate > _STREAM_RATE and silent > max(SILENCE, 20.0 / self.rate) else 0.0

    def _follow(self, stamp_ns: int) -> None:
        if self._stamp is not None and 0 < stamp_ns - self._stamp < _PAUSE_NS:
            self._intervals.append(stamp_ns - self._stamp)
        self._stamp = stamp_ns
        if len(self._intervals) == _TOGETHER:
            self.holes += _missing(self._intervals)
            self._intervals.clear()


def _missing(intervals: list[int]) -> int:
    """Samples that these intervals [ns] lack; 0 when they are no train with a period."""
    period = median(intervals)
    regular = sum(abs(interval - period) < _REGULAR * period for interval in intervals)
    if regular < _ALIKE * len(intervals):
        return 0
    return sum(round(interval / period) - 1 for interval in intervals if interval > _HOLE * period)


class Holes:
    """Where samples are missing, so that those of a window can be counted."""

    def __init__(self) -> None:
        self._at: deque[tuple[int, int]] = deque(maxlen=_REMEMBERED)

    def add(self, stamp_ns: int, samples: int) -> None:
        """So many are missing before the sample with this stamp [ns]."""
        if samples > 0:
            self._at.append((stamp_ns, samples))

    def since(self, stamp_ns: int) -> int:
        """Missing after this stamp [ns]."""
        return sum(samples for at, samples in tuple(self._at) if at > stamp_ns)
