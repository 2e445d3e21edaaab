"""One thread for the work that takes long, so that the executor never waits for it."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import TypeVar

from rclpy.executors import Executor
from rclpy.task import Future

Result = TypeVar("Result")


class Worker:
    """Does one job after the other in a thread; the outcome comes as a future to wait for in a coroutine."""

    def __init__(self, name: str) -> None:
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, name=name, daemon=True)
        self._closed = False
        self._thread.start()

    def submit(self, job: Callable[[], Result], executor: Executor | None = None) -> Future:
        """Queue a job. The future holds its result or its exception, and wakes the executor when done."""
        future = Future(executor=executor)

        def do() -> None:
            if self._closed:
                future.cancel()
                return
            try:
                future.set_result(job())
            except Exception as error:
                future.set_exception(error)
            if executor is not None:
                executor.wake()

        self._jobs.put(do)
        return future

    def close(self, patience: float = 2.0) -> bool:
        """Drop what waits; whether the job in progress ended in time."""
        self._closed = True
        self._jobs.put(None)
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()
