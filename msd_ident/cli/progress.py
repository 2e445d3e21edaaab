"""Progress bars on stderr: of the stages of one result, and of the records of a batch."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

#: Takes the stage and the fraction that is done.
Progress = Callable[[str, float], None]


@contextmanager
def stages(quiet: bool) -> Iterator[Progress]:
    """A progress bar on stderr that takes (stage, fraction); nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda stage, fraction: None
        return
    wide = Column(width=38, no_wrap=True, overflow="ellipsis")
    stage = TextColumn("{task.description}", table_column=wide)
    columns = (stage, BarColumn(bar_width=28), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda stage, fraction: bar.update(task, description=stage, completed=fraction)


@contextmanager
def records(dashboard: str, quiet: bool) -> Iterator[Callable[[int, int, Sequence[Any]], None]]:
    """A bar on stderr with rate and time left, and the dashboard's address; a line now and then where it is a file."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    if quiet:
        yield lambda done, total, rows: None
        return
    console = Console(stderr=True, highlight=False)
    if dashboard:
        console.print(f"dashboard: {dashboard}", soft_wrap=True)
    if not console.is_terminal:
        yield _lines()
        return
    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeElapsedColumn())
    began = time.monotonic()
    with Progress(*columns, TextColumn("left"), TimeRemainingColumn(), console=console, transient=True) as progress:
        task = progress.add_task("", total=None, rate="")

        def update(done: int, total: int, rows: Sequence[Any]) -> None:
            rate = done / max(time.monotonic() - began, 1e-3)
            progress.update(task, completed=done, total=total, rate=f"{rate:.3g} records/s")

        yield update


#: Seconds between two lines of progress in a file.
_LINE_SECONDS = 10.0


def _lines() -> Callable[[int, int, Sequence[Any]], None]:
    began = last = time.monotonic()

    def update(done: int, total: int, rows: Sequence[Any]) -> None:
        """Print a line about the progress, at most one in ``_LINE_SECONDS``."""
        nonlocal last
        now = time.monotonic()
        if now - last < _LINE_SECONDS and done < total:
            return
        last = now
        rate = done / max(now - began, 1e-3)
        left = (total - done) / rate
        print(f"{done} of {total} records, {rate:.3g} per second, {left:.0f} s left", file=sys.stderr, flush=True)

    return update
