"""How fast: a batch against one process, the overhead of a record, the scaling of slept tasks, memory, digits."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import time
import zlib
from functools import cache
from pathlib import Path
from typing import Any

from bench.batch.records import make
from msd_ident.batching import batch, table
from msd_ident.batching.job import Job
from msd_ident.batching.running import Link, Runner, Task
from msd_ident.batching.work import Work

#: Columns of a row that tell of the run and not of the record.
OF_THE_RUN = ("seconds", "diagnosis_seconds", "worker")
_ONE_BY_ONE = """
import json, sys, time
from msd_ident import parallel
parallel.one_blas_thread()  # as the `msd` command does, before numpy is imported
from msd_ident.batching.job import Job
from msd_ident.batching.work import Work
from msd_ident.batching import table
work, rows, began = Work(Job()), [], time.perf_counter()
for path in sys.argv[2:]:
    rows += work(path).rows
seconds = time.perf_counter() - began
table.Store(sys.argv[1]).finish(table.made(rows))
print(seconds)
"""


def speed(folder: Path, count: int) -> dict[str, Any]:
    """A batch on all cores against one process; both begin with loaded libraries, the batch's start is told apart."""
    paths = make(folder / "records", count)
    alone = folder / "one_by_one.parquet"
    command = [sys.executable, "-c", _ONE_BY_ONE, str(alone), *map(str, paths)]
    single = float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    began = time.perf_counter()
    with batch.linked() as link:
        started = time.perf_counter()
        found, _ = batch.run(
            [folder / "records"], Job(), link, batch.Plan(str(folder / "batch.parquet"), overwrite=True)
        )
        seconds = time.perf_counter() - started
    rows = found.to_pylist()
    inside = sum(row["diagnosis_seconds"] or 0.0 for row in rows)
    around = sum(row["seconds"] for row in rows)
    return {
        "records": len(rows),
        "one by one [s]": single,
        "batch [s]": seconds,
        "start of the processes [s]": started - began,
        "times as fast": single / seconds,
        "with the start": single / (seconds + started - began),
        "overhead inside the worker [% of the diagnosis]": 100.0 * (around / inside - 1.0),
        "overhead in all [% of the diagnosis]": 100.0 * (seconds * 2 / inside - 1.0),
        "rows with other digits": different(table.read(str(alone)).to_pylist(), rows),
    }


def different(one: list[dict[str, Any]], other: list[dict[str, Any]]) -> dict[str, list[str]]:
    """Rows that are not the same in every digit: the record, and each column with both values."""
    of = {(row["path"], row["joint"]): row for row in one}
    found: dict[str, list[str]] = {}
    for row in other:
        twin = of[row["path"], row["joint"]]
        apart = [name for name in row if name not in OF_THE_RUN and repr(row[name]) != repr(twin[name])]
        if apart:
            found[row["name"]] = [f"{name}: {twin[name]!r}, {row[name]!r}" for name in apart]
    return found


class Slept:
    """A task of a known length that computes nothing."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def __call__(self, path: str) -> str:
        time.sleep(self._seconds)
        return path


def scaling(tasks: int, seconds: float, workers: int = 8) -> dict[str, Any]:
    """Scheduler and workers on this machine with tasks that sleep."""
    with batch.linked(workers=workers) as link:
        list(Runner(link, [Task(str(n), Slept(0.0)) for n in range(4 * workers)]).answers())
        began = time.perf_counter()
        found = list(Runner(link, [Task(str(n), Slept(seconds)) for n in range(tasks)]).answers())
        wall = time.perf_counter() - began
    rounds = math.ceil(tasks / workers) * seconds
    return {
        "tasks": len(found), "length [s]": seconds, "workers": workers, "wall [s]": wall,
        "times as fast as one": tasks * seconds / wall, "of the possible": rounds / wall,
    }  # fmt: skip


class Copied:
    """A worker's answer without its work: a row of a table that was made before, under another path."""

    def __init__(self, made: Path) -> None:
        self._made = str(made)

    def __call__(self, path: str) -> Any:
        from msd_ident.batching.work import Done

        rows = _rows_of(self._made)
        row = rows[zlib.crc32(path.encode()) % len(rows)]
        return Done(({**row, "path": path, "name": Path(path).name, "robot": Path(path).parent.name},))


@cache
def _rows_of(made: str) -> list[dict[str, Any]]:
    return [dict(row) for row in table.read(made).to_pylist()]


def memory(folder: Path, count: int) -> dict[str, Any]:
    """Rows that come from workers into a table and a page; the client's largest memory is that of its own process."""
    made = folder / "made.parquet"
    one = [sys.executable, "-c", _ONE_BY_ONE, str(made), *map(str, make(folder / "records", 20))]
    subprocess.run(one, capture_output=True, check=True)
    command = [sys.executable, "-m", "bench.batch.speed", str(folder), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return {**found, "page opens in [s]": _opens(folder / "many.html")}


def _remembered(folder: Path, count: int) -> dict[str, Any]:
    import resource

    from msd_ident.report import batch_page

    paths = [f"/data/robot_{n % 50}/record_{n:06d}.csv" for n in range(count)]
    store = table.Store(str(folder / "many.parquet"))
    began = time.perf_counter()
    with batch.linked() as link:
        this = batch.Run(paths, Work(Job()), batch.Plan(), table.made([]))
        runner = Runner(Link(link.client), [Task(path, Copied(folder / "made.parquet")) for path in paths])
        for answer in runner.answers():
            this.keep(this.take(answer, runner) or ())
        whole = this.whole()
        store.finish(whole)
    wall = time.perf_counter() - began
    batch_page.save(whole, folder / "many.html", "many.parquet")
    return {
        "rows": whole.num_rows,
        "rows a second through the client": whole.num_rows / wall,
        "client's memory [MB]": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "table [MB]": (folder / "many.parquet").stat().st_size / 1e6,
        "page [MB]": (folder / "many.html").stat().st_size / 1e6,
    }


def _opens(page: Path) -> float:
    """Seconds until a page's table is there, in Chromium."""
    import shutil

    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        view = browser.new_page()
        began = time.perf_counter()
        view.goto(page.absolute().as_uri())
        view.wait_for_selector("html[data-ready=yes]")
        view.wait_for_selector("tr[data-row]")
        seconds = time.perf_counter() - began
        browser.close()
    return seconds


if __name__ == "__main__":
    print(json.dumps(_remembered(Path(sys.argv[1]), int(sys.argv[2]))))
