"""Work shared between the cores: compiled simulations run without Python's global lock, so threads are enough."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Lock
from typing import TypeVar

from msd_ident import cancellation

_Task = TypeVar("_Task")
_Done = TypeVar("_Done")

#: Threads that one process starts at most: beyond this, they wait for Python's lock.
MOST_THREADS = 8
#: Longest time for which a thread keeps the interpreter from the others [s]: a simulation takes a fraction of a
#: millisecond, and would otherwise wait for Python's 5 ms.
_TURN = 5e-5

#: Threads that the work in this context may use; 0: as many as there are cores.
_given: ContextVar[int] = ContextVar("threads", default=0)


def one_blas_thread() -> None:
    """Limit OpenBLAS to one thread, unless the user set ``OPENBLAS_NUM_THREADS``. For entry points only.

    The matrices here are about ten by ten. Threads of BLAS do not speed them up, and they compete with the threads
    that fit: a diagnosis takes a fifth longer. OpenBLAS reads the variable when numpy is loaded, so an entry point
    calls this before anything imports numpy. Importing the package changes no setting of the process.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def threads() -> int:
    """How many threads ``each`` uses here: one a core that this process may use, unless ``limited_to`` says fewer."""
    return _given.get() or min(len(os.sched_getaffinity(0)), MOST_THREADS)


@contextmanager
def limited_to(count: int) -> Iterator[None]:
    """Work inside the block uses at most ``count`` threads: for processes that share the cores.

    Two processes with two threads each on two cores need a sixth more processor time than with one thread each.
    """
    token = _given.set(max(count, 1))
    try:
        yield
    finally:
        _given.reset(token)


def each(
    work: Callable[[_Task], _Done], tasks: Sequence[_Task], told: Callable[[int, _Task], None] | None = None
) -> list[_Done]:
    """Results of ``work`` for all tasks, in the order of the tasks, begun in their order on all cores.

    The threads are shared: work that calls ``each`` itself gets its part of them.

    Args:
        work: called once for each task; a cancelled context cancels all of them.
        tasks: what is worked on.
        told: called in this thread after each task, with how many are done, and the task; what it raises ends the work.
    """
    count = min(threads(), len(tasks))
    if count < 2:
        return [_one(work, task, number, told) for number, task in enumerate(tasks, start=1)]
    with limited_to(threads() // count), _short_turns, ThreadPoolExecutor(max_workers=count) as pool:
        jobs = {pool.submit(cancellation.in_this_context(work), task): i for i, task in enumerate(tasks)}
        results: dict[int, _Done] = {}
        try:
            for number, job in enumerate(as_completed(jobs), start=1):
                results[jobs[job]] = job.result()
                if told is not None:
                    told(number, tasks[jobs[job]])
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return [results[i] for i in range(len(tasks))]


def _one(work: Callable[[_Task], _Done], task: _Task, number: int, told: Callable[[int, _Task], None] | None) -> _Done:
    result = work(task)
    if told is not None:
        told(number, task)
    return result


class _ShortTurns:
    """Threads of this process take turns sooner while any block of it runs; nested and side by side as well."""

    def __init__(self) -> None:
        self._lock, self._inside, self._before = Lock(), 0, 0.0

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._before = sys.getswitchinterval()
                sys.setswitchinterval(min(self._before, _TURN))
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                sys.setswitchinterval(self._before)


_short_turns = _ShortTurns()
