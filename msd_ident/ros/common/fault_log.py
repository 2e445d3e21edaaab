"""Faults of the data: counted since the start, reported for a while. Without ROS."""

from __future__ import annotations

import threading
import time
from collections import Counter


class FaultLog:
    """Faults by kind, from any thread.

    Args:
        remember: how long a fault that is over is still reported [s].
    """

    def __init__(self, remember: float = 10.0) -> None:
        self._remember = remember
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()
        self._latest: dict[str, tuple[float, str]] = {}

    def note(self, kind: str, sentence: str, count: int = 1) -> None:
        """Count a fault; the sentence is what is reported."""
        with self._lock:
            self._counts[kind] += count
            self._latest[kind] = (time.monotonic(), sentence)

    @property
    def counts(self) -> dict[str, int]:
        """How often each kind was seen."""
        with self._lock:
            return dict(self._counts)

    @property
    def recent(self) -> tuple[str, ...]:
        """Sentences of the last while, the latest first; of each kind the last one."""
        since = time.monotonic() - self._remember
        with self._lock:
            latest = sorted(self._latest.values(), reverse=True)
        return tuple(sentence for at, sentence in latest if at >= since)
