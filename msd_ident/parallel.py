"""Work shared between the cores: compiled simulations run without Python's global lock, so threads are enough."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from msd_ident import cancellation

_Task = TypeVar("_Task")
_Done = TypeVar("_Done")


def one_blas_thread() -> None:
    """Limit OpenBLAS to one thread, unless the user set ``OPENBLAS_NUM_THREADS``. For entry points only.

    The matrices here are about ten by ten. Threads of BLAS do not speed them up, and they compete with the threads
    that fit: a diagnosis takes a fifth longer. OpenBLAS reads the variable when numpy is loaded, so an entry point
    calls this before anything imports numpy. Importing the package changes no setting of the process.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def each(work: Callable[[_Task], _Done], tasks: Sequence[_Task]) -> list[_Done]:
    """Results of ``work`` for all tasks, in the order of the tasks, computed by at most four threads.

    Args:
        work: called once for each task; a cancelled context cancels all of them.
        tasks: what is worked on.
    """
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        jobs = [pool.submit(cancellation.in_this_context(work), task) for task in tasks]
        return [job.result() for job in jobs]
