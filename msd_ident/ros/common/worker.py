"""A thread for long computations, so that the executor does not wait for them."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor
from rclpy.task import Future

from msd_ident import cancellation
from msd_ident.cancellation import Cancelled
from msd_ident.errors import UsageError

Result = TypeVar("Result")

#: Niceness of a patient worker's thread.
_YIELDING = 10
#: A patient worker rests while another's job runs, but no longer than this after that job began [s].
_REST = 0.25
#: While it rests, it looks so often whether it was stopped [s].
_LOOK = 0.05
#: Jobs that may wait; more are refused.
MOST_WAITING = 64


@dataclass
class _Job:
    work: Callable[[], None]
    future: Future
    executor: Executor | None
    key: Hashable = None
    stop: threading.Event = field(default_factory=threading.Event)


def deliver(end: Callable[..., None], *outcome: object) -> None:
    """End a future, with its outcome. An executor that has been shut down cannot wake those who wait: none is left."""
    with suppress(AttributeError, InvalidHandle):
        end(*outcome)


class Worker:
    """Does one job after the other in a thread; the outcome comes as a future to wait for in a coroutine.

    Args:
        name: of the thread.
        behind: the worker whose jobs go first. Python runs one thread at a time, so a short job of another thread takes
            three times as long beside two threads that compute. This worker therefore rests between two simulations
            while a job of ``behind`` is young, and on Linux its thread yields the cores to all others.
    """

    def __init__(self, name: str, behind: Worker | None = None) -> None:
        self._behind = behind
        self._begun = math.inf
        self._jobs: deque[_Job] = deque()
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name=name, daemon=True)
        self._closed = False
        self._thread.start()

    def submit(
        self,
        job: Callable[[], Result],
        executor: Executor | None = None,
        *,
        key: Hashable = None,
        stop: threading.Event | None = None,
    ) -> Future:
        """Queue a job. The future holds its result or its exception, and wakes the executor when done.

        Args:
            job: what to do.
            executor: of those who wait.
            key: a job that still waits with an equal one is the same: then its future is given. ``None`` is no key.
            stop: set by somebody who does not want the result any more: the job ends with ``Cancelled``.

        Raises:
            UsageError: too many wait.
        """
        future = Future(executor=executor)

        def do() -> None:
            """The job, in the worker's thread; its result or error goes to the executor."""
            try:
                result = job()
            except Cancelled as error:
                deliver(future.set_exception, error)
                future.exception()  # asked once: rclpy prints an error that nobody asked for, and this is none
            except Exception as error:
                deliver(future.set_exception, error)
            else:
                deliver(future.set_result, result)

        made = _Job(do, future, executor, key, stop or threading.Event())
        with self._changed:
            same = next((other for other in self._jobs if key is not None and other.key == key), None)
            if same is not None:
                return same.future
            if len(self._jobs) >= MOST_WAITING:
                raise UsageError(f"{len(self._jobs)} requests are waiting; expected fewer: try again later")
            self._jobs.append(made)
            self._changed.notify_all()
        return future

    @property
    def busy(self) -> bool:
        """Whether a job is in progress, or waits."""
        return bool(self._jobs) or self._begun != math.inf

    def close(self, patience: float = 2.0) -> bool:
        """Drop what waits, stop the job in progress; whether it ended in time."""
        with self._changed:
            self._closed = True
            dropped = list(self._jobs)
            self._jobs.clear()
            self._changed.notify_all()
        for job in dropped:
            deliver(job.future.cancel)
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _work(self) -> None:
        if self._behind is not None and sys.platform == "linux":
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _YIELDING)
        while (job := self._next()) is not None:
            with cancellation.cancel_when(partial(self._stopped, job)):
                job.work()
            if job.executor is not None:
                job.executor.wake()

    def _next(self) -> _Job | None:
        """The next job, once there is one; None when the worker is closed."""
        with self._changed:
            self._begun = math.inf
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._jobs or self._closed)
            if self._closed:
                return None
            self._begun = time.monotonic()
            return self._jobs.popleft()

    def _stopped(self, job: _Job) -> bool:
        """Whether nobody waits for a job any more; asked between two simulations."""
        if self._behind is not None:
            self._behind.let_pass(lambda: self._closed or job.stop.is_set())
        return self._closed or job.stop.is_set()

    def let_pass(self, stopped: Callable[[], bool]) -> None:
        """Wait in another thread while a young job of this worker runs, or until ``stopped`` is seen to be true."""
        if self._begun == math.inf:
            return
        with self._changed:
            while (left := self._begun + _REST - time.monotonic()) > 0.0 and self._begun != math.inf and not stopped():
                self._changed.wait(min(left, _LOOK))
