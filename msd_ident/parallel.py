"""Work shared between the cores: the solver lets go of Python's lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from msd_ident import cancellation

_Task = TypeVar("_Task")
_Done = TypeVar("_Done")


def each(work: Callable[[_Task], _Done], tasks: Sequence[_Task]) -> list[_Done]:
    """What comes of each task, in their order."""
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        jobs = [pool.submit(cancellation.in_this_context(work), task) for task in tasks]
        return [job.result() for job in jobs]
