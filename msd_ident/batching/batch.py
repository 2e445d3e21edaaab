"""A batch: many records into one table; rows that exist are kept, the other records are diagnosed."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from msd_ident.batching import cluster, locations, table
from msd_ident.batching.job import Job
from msd_ident.batching.row import Row, identity
from msd_ident.batching.running import Answer, Link, Runner, Task
from msd_ident.batching.work import Done, Draw, Work
from msd_ident.data.provenance import fingerprint
from msd_ident.errors import MsdError, UsageError

if TYPE_CHECKING:
    import pyarrow as pa
    from distributed import Client, Future

#: Called with the number of records done, of all records, and the rows that came last.
Progress = Callable[[int, int, Sequence[Row]], None]


def _silent(done: int, total: int, rows: Sequence[Row]) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Plan:
    """Where the table of a batch goes, and its progress callback.

    Attributes:
        out: the table's file; empty to keep none.
        resume: keep the rows of an earlier run and add to them.
        overwrite: replace an existing table.
        draw: makes the page of a record, if the job asks for pages.
        progress: called with the records done, the number of all records, and new rows.
    """

    out: str = ""
    resume: bool = False
    overwrite: bool = False
    draw: Draw | None = None
    progress: Progress = _silent

    def store(self) -> table.Store | None:
        """Where the rows go.

        Raises:
            UsageError: something stands there already, or the table cannot be there.
            SetupError: the disk does not take it.
        """
        if not self.out:
            return None
        found = table.Store(self.out)
        stands = found.stands()
        if stands and not (self.resume or self.overwrite):
            of = "an interrupted run: --resume goes on" if stands.endswith(".parts") else "--resume adds to it"
            raise UsageError(f"{stands} exists; expected a new name ({of}, --overwrite begins anew)")
        found.check_place()
        if self.overwrite and not self.resume:
            found.clear()
        return found


@dataclass
class Run:
    """One batch in progress.

    Attributes:
        paths: of all records.
        work: what is done with each.
        plan: where the table goes.
        earlier: rows of earlier runs.
        reused: number of records whose rows were known already.
    """

    paths: Sequence[str]
    work: Work
    plan: Plan
    earlier: pa.Table
    reused: int = 0

    def __post_init__(self) -> None:
        self._rows: list[Row] = []
        self._tables: list[pa.Table] = []
        self._digest: dict[str, str] = {}
        self._places: dict[str, list[int]] = defaultdict(list)
        self._like: dict[str, str] = {}
        columns = (self.earlier.column(name).to_pylist() for name in ("path", "job", "sha256"))
        for place, (path, job, digest) in enumerate(zip(*columns, strict=True)):
            if digest and job == self.work.job.digest:
                self._digest[path] = digest
                self._places[path].append(place)
                self._like.setdefault(digest, path)

    def keep(self, rows: Sequence[Row]) -> None:
        """Keep rows, as columns once they are many, which take a tenth of the memory."""
        self._rows += rows
        if len(self._rows) >= table.PART_ROWS:
            self._tables.append(table.made(self._rows))
            self._rows = []

    def whole(self) -> pa.Table:
        """All rows: those made now, and earlier ones of records that have no new ones."""
        fresh = table.joined([*self._tables, table.made(self._rows)])
        again = set(fresh.column("path").to_pylist())
        keep = [place for place, path in enumerate(self.earlier.column("path").to_pylist()) if path not in again]
        order = {path: place for place, path in enumerate(self.paths)}
        return table.merged(table.joined([table.rows_at(self.earlier, keep), fresh]), order)

    def tasks(self) -> Iterator[Task]:
        """A task for each record: its diagnosis, or its digest first if earlier rows may have the same content."""
        for path in self.paths:
            if path in self._digest:
                yield Task(path, replace(self.work, known=(self._digest[path],)))
            else:
                yield Task(path, content if self._like else self.work)

    def take(self, answer: Answer, runner: Runner) -> Sequence[Row] | None:
        """Rows of an answer.

        Args:
            answer: what came of a task.
            runner: gets the diagnosis of the record as a new task, if no earlier row has the content that the answer
                reports.

        Returns:
            None if the record was handed out again.
        """
        path, found = answer.task.path, answer.result
        if answer.error:
            job = self.work.job
            row = {**identity(path, job.labels), "code": job.code, "job": job.digest, "options": job.changes()}
            return [{**row, "error": answer.error}]
        if isinstance(found, Done):
            self.reused += bool(found.known)
            return found.rows
        if found not in self._like:
            runner.add(Task(path, self.work))
            return None
        self.reused += 1
        labels = identity(path, self.work.job.labels)
        same = table.rows_at(self.earlier, self._places[self._like[found]]).to_pylist()
        return [{**row, **labels, "joint": row["joint"], "day": labels["day"] or row["day"]} for row in same]


def content(path: str) -> str:
    """Digest of a record's content; empty where it cannot be read, which its diagnosis will say."""
    try:
        with locations.local(path) as copy:
            return fingerprint(copy)[1]
    except Exception:
        return ""


def run(paths: Iterable[str | os.PathLike[str]], job: Job, link: Link, plan: Plan) -> tuple[pa.Table, Run]:
    """Diagnose all records.

    Args:
        paths: folders, patterns and records, here or in object stores.
        job: how records are read and diagnosed.
        link: to the cluster.
        plan: where the table goes, and the progress callback.

    Returns:
        The table, and the run with its counts.

    Raises:
        DataError, UsageError, SetupError: nothing to do, a label that no path has, no place for the table, a cluster
            that cannot be used.
    """
    found = locations.records(paths)
    job.check_labels(found)
    store = plan.store()
    earlier = store.earlier() if store is not None and plan.resume else table.made([])
    this = Run(found, Work(job, draw=plan.draw, threads=1), plan, earlier)
    try:
        _work_through(this, Runner(link, this.tasks()), store)
        whole = this.whole()
    except BaseException:
        if store is not None:
            with suppress(MsdError):  # the error to report is why the work ended
                store.flush()
        raise
    if store is not None:
        store.finish(whole)
    return whole, this


def _work_through(this: Run, runner: Runner, store: table.Store | None) -> None:
    done = 0
    for answer in runner.answers():
        rows = this.take(answer, runner)
        if rows is None:
            continue
        done += 1
        this.keep(rows)
        if store is not None:
            store.add(rows)
        this.plan.progress(done, len(this.paths), rows)


@contextmanager
def linked(scheduler: str = "", workers: int = 0) -> Iterator[Link]:
    """A link to a cluster.

    Args:
        scheduler: address of one that runs; empty for a cluster on this machine.
        workers: processes on this machine; 0 for one a core.

    Raises:
        SetupError: it cannot be used.
    """
    if not scheduler:
        with cluster.this_machine(workers) as client:
            yield Link(client)
        return
    with cluster.quiet():
        link = Link(cluster.connect(scheduler), scheduler)
        try:
            cluster.check_workers(link.client)
            yield link
        finally:
            link.close()


def batch(
    paths: Iterable[str | os.PathLike[str]],
    *,
    client: Client | None = None,
    job: Job = Job(),  # noqa: B008 - frozen
    plan: Plan = Plan(),  # noqa: B008 - frozen
) -> pa.Table:
    """A table with a row for each record, as ``msd batch`` makes it.

    Only paths travel to the workers, and only rows travel back: the arrays of a record are nowhere but in the process
    that diagnoses it.

    Args:
        paths: folders, patterns and records, here or in object stores; the workers must see them under the same names.
        client: of a Dask cluster; without one the cores of this machine work.
        job: how records are read and diagnosed.
        plan: whether the table is kept in a file, and the progress callback.

    Raises:
        DataError, UsageError, SetupError: nothing to do, no place for the table, a cluster that cannot be used.
    """
    if client is None:
        with linked() as link:
            return run(paths, job, link, plan)[0]
    cluster.check_workers(client)
    return run(paths, job, Link(client), plan)[0]


def futures(
    paths: Iterable[str | os.PathLike[str]],
    client: Client,
    job: Job = Job(),  # noqa: B008 - frozen
) -> dict[str, Future]:
    """A future for each record, for use in a Dask graph of the caller.

    Args:
        paths: folders, patterns and records, here or in object stores.
        client: of a Dask cluster.
        job: how records are read and diagnosed.

    Returns:
        By path, the future of a list of the record's rows: plain values by column.

    Raises:
        DataError, SetupError: as ``batch``.
    """
    cluster.check_workers(client)
    work = partial(_rows, Work(job, threads=1))
    return {path: client.submit(work, path, pure=False) for path in locations.records(paths)}


def _rows(work: Work, path: str) -> list[dict[str, Any]]:
    return list(work(path).rows)
