"""Tasks on a cluster: handed out a few ahead, repeated if a worker or the scheduler is lost, each result once."""

from __future__ import annotations

import itertools
import queue
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from msd_ident.batching import cluster
from msd_ident.errors import MsdError, SetupError

if TYPE_CHECKING:
    from distributed import Client, Future

#: Tasks handed out for each that runs: enough that no worker waits for the client, few enough to hold.
AHEAD = 4
#: Results that are fetched at once.
MOST_AT_ONCE = 256
#: How often the client looks whether the cluster grew [s], and how long it waits for a scheduler that went [s].
LOOK_SECONDS, PATIENCE_SECONDS = 2.0, 120.0
#: Times that a task may be handed out; each time Dask itself gives it to four workers before it gives up.
MOST_TRIES = 3


@dataclass(frozen=True)
class Task:
    """A function of one path.

    Attributes:
        path: argument of the function.
        function: to be called on a worker.
        tries: how often the task was handed out.
    """

    path: str
    function: Callable[[str], Any]
    tries: int = 0


@dataclass(frozen=True)
class Answer:
    """Result of a task.

    Attributes:
        task: the task.
        result: what the function returned.
        error: why there is no result, in words; else empty.
    """

    task: Task
    result: Any = None
    error: str = ""


class Link:
    """A client, and how to connect again if its scheduler is lost.

    Args:
        client: to begin with.
        address: of the scheduler; empty if it cannot come back.
    """

    def __init__(self, client: Client, address: str = "") -> None:
        self.client, self.address = client, address

    @property
    def lost(self) -> bool:
        """Whether the scheduler does not answer."""
        return bool(self.client.status != "running")

    def renew(self) -> None:
        """Wait for the scheduler to be there again.

        Raises:
            SetupError: it is not, after a while.
        """
        if not self.address:
            raise SetupError("the scheduler is gone; finished records are kept: continue with --resume")
        self.close()
        until = time.monotonic() + PATIENCE_SECONDS
        while True:
            try:
                self.client = cluster.connect(self.address, cluster.ANSWER_SECONDS)
                cluster.check_workers(self.client)
                return
            except MsdError as error:
                if time.monotonic() > until:
                    raise SetupError(
                        f"the scheduler at {self.address} went away and is not back after {PATIENCE_SECONDS:g} s; what "
                        "is done is kept: go on with --resume"
                    ) from error
                time.sleep(1.0)

    def close(self) -> None:
        """Let go of a client whose scheduler may be gone."""
        try:
            self.client.close(timeout=2.0)
        except Exception:  # it has no scheduler to say goodbye to
            return


class Runner:
    """Hands out tasks to a cluster and collects their answers."""

    def __init__(self, link: Link, tasks: Iterable[Task] = ()) -> None:
        self._link = link
        self._waiting: deque[Task] = deque(tasks)
        self._running: dict[str, tuple[Task, Future]] = {}
        self._arrived: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._prefix, self._numbers = f"msd-{uuid.uuid4().hex[:8]}", itertools.count()
        self._room, self._looked = 0, -LOOK_SECONDS

    def add(self, task: Task) -> None:
        """A further task, before those that wait."""
        self._waiting.appendleft(task)

    def answers(self) -> Iterator[Answer]:
        """Answers as they come, until there is no task left.

        Raises:
            SetupError: the cluster is lost, or runs another version of the code.
        """
        try:
            while self._waiting or self._running:
                if self._link.lost:
                    self._again()
                self._hand_out()
                yield from self._next()
        finally:
            for _, future in self._running.values():
                future.release()

    def _hand_out(self) -> None:
        now = time.monotonic()
        if now - self._looked > LOOK_SECONDS:
            try:
                self._room = max(AHEAD * cluster.threads(self._link.client), AHEAD)
            except Exception:  # lost just now: seen at the next turn
                return
            self._looked = now
        while self._waiting and len(self._running) < self._room:
            task = self._waiting.popleft()
            key = f"{self._prefix}-{next(self._numbers)}"
            try:
                future = self._link.client.submit(task.function, task.path, key=key, pure=False)
            except Exception:
                self._waiting.appendleft(task)
                if self._link.lost:
                    return
                raise
            self._running[key] = (task, future)
            future.add_done_callback(self._arrived.put)

    def _next(self) -> list[Answer]:
        """What has arrived, fetched at once: one trip for each would be the slowest part of a large cluster."""
        futures = self._drained()
        tasks = {future.key: self._running.pop(future.key)[0] for future in futures}
        gathered: dict[str, Any] = {}
        finished = {future.key: future for future in futures if future.status == "finished"}
        if len(finished) > 1:
            with suppress(Exception):  # then each on its own, which says what is wrong with which
                gathered = self._link.client.gather(finished, errors="skip")
        found = [self._answer(future, tasks[future.key], gathered) for future in futures]
        return [answer for answer in found if answer is not None]

    def _drained(self) -> list[Future]:
        """Futures that are done: at least one, or none within half a second."""
        found: list[Future] = []
        try:
            found.append(self._arrived.get(timeout=0.5))
            while len(found) < MOST_AT_ONCE:
                found.append(self._arrived.get_nowait())
        except queue.Empty:
            pass
        return [future for future in found if future.key in self._running]  # others are of a scheduler that is gone

    def _answer(self, future: Future, task: Task, gathered: dict[str, Any]) -> Answer | None:
        try:
            if future.key in gathered:
                return Answer(task, gathered[future.key])
            if future.status not in ("finished", "error"):
                self._waiting.appendleft(task)
                return None
            return Answer(task, future.result(timeout=60.0))
        except Exception as error:
            return self._failed(task, error)
        finally:
            future.release()

    def _failed(self, task: Task, error: Exception) -> Answer | None:
        kind = type(error).__name__
        if isinstance(error, MsdError):
            raise error
        if kind == "KilledWorker" and task.tries + 1 >= MOST_TRIES:
            return Answer(
                task,
                error=f"every worker that took it died, {MOST_TRIES} times over; expected one that survives: the "
                "record may need more memory than a worker has: give fewer workers",
            )
        if kind == "KilledWorker" or kind in _LOST:
            again = replace(task, tries=task.tries + (kind == "KilledWorker"))
            self._waiting.append(again)  # behind the others: whom its worker took along comes through first
            return None
        reason = " ".join(str(error).split())[:300]
        return Answer(task, error=f"internal error, please report it: {kind}: {reason}")

    def _again(self) -> None:
        """Hand out again what was in progress, once the scheduler is back."""
        tasks = [task for task, _ in self._running.values()]
        self._running.clear()
        self._waiting.extendleft(reversed(tasks))
        self._link.renew()
        self._looked = -LOOK_SECONDS


#: What a result that was lost on its way raises.
_LOST = (
    "CancelledError",
    "FutureCancelledError",
    "FuturesCancelledError",
    "TimeoutError",
    "CommClosedError",
    "OSError",
)
