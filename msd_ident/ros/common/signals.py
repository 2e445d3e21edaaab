"""Ctrl-C and other signals, noted from the first moment and as often as they come. Imports nothing heavy on purpose.

A handler that only takes a note cannot interrupt anything half-way: a second Ctrl-C inside a shutdown has no effect.
"""

from __future__ import annotations

import queue
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

#: Signals that end a node.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Signals:
    """The signals that have come, in order; ``finish`` ends the waiting as a signal does."""

    def __init__(self) -> None:
        self._queue: queue.SimpleQueue[int] = queue.SimpleQueue()
        self.ended = False

    def take(self, number: int, frame: FrameType | None = None) -> None:
        """Note a signal; safe at any instant."""
        self._queue.put(number)
        self.ended = self.ended or number in ENDING

    def finish(self) -> None:
        """End the waiting from inside: the work is done."""
        self.take(signal.SIGTERM)

    def finish_after(self, seconds: float) -> None:
        """End the waiting some time from now."""
        timer = threading.Timer(seconds, self.finish)
        timer.daemon = True
        timer.start()

    def wait(self) -> Iterator[int]:
        """The other signals as they come, until one that ends."""
        while True:
            number = self._queue.get()
            if number in ENDING:
                return
            yield number


@contextmanager
def handled(handler: Callable[[int, FrameType | None], object], *numbers: signal.Signals) -> Iterator[None]:
    """Handle signals within the block; only in the main thread."""
    kept = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, before in kept.items():
            signal.signal(number, before)


@contextmanager
def noted_signals(*others: signal.Signals) -> Iterator[Signals]:
    """Hear the ending signals and ``others``; only in the main thread. Once the work is done, they have no effect.

    They are ignored then, since an interpreter that ends gives back their deadly defaults to those that are handled.
    """
    signals = Signals()
    for number in (*ENDING, *others):
        signal.signal(number, signals.take)
    try:
        yield signals
    finally:
        for number in (*ENDING, *others):
            signal.signal(number, signal.SIG_IGN)
