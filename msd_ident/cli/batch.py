"""``msd batch``: many records, a row each, on all cores of this machine or on a cluster."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli import options, run, sources
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.batching.job import Job
    from msd_ident.io import SourceOptions

ManyArgument = Annotated[
    list[str] | None,
    typer.Argument(metavar="PATHS…", help="folders, patterns and records; also in object stores, e.g. s3://bucket/dir"),
]
ListOption = Annotated[str, options.source_option("--list", metavar="FILE|-", help="file with one path per line")]


OutOption = Annotated[
    str, options.output_option("--out", metavar="TABLE.parquet", help="table to write; also in an object store")
]
ResumeOption = Annotated[
    bool, options.batch_option("--resume", help="continue an interrupted batch; finished records are kept")
]
RecordPagesOption = Annotated[
    Path | None,
    options.output_option(
        "--pages", metavar="FOLDER", help="also write a page for each record; the report links to them"
    ),
]


@sources.reading
def batch(
    source: sources.Source,
    out: OutOption,
    paths: ManyArgument = None,
    listed: ListOption = "",
    scheduler: options.SchedulerOption = "",
    workers: options.WorkersOption = 0,
    all_joints: options.AllJointsOption = False,
    label: options.LabelOption = None,
    covariate: options.CovariateOption = None,
    model: options.ModelOption = "auto",
    tolerance: options.ToleranceOption = 1.0,
    resume: ResumeOption = False,
    report: options.ReportOption = None,
    record_pages: RecordPagesOption = None,
    quiet: options.QuietOption = False,
    overwrite: options.OverwriteOption = False,
) -> int:
    """Diagnose many records into one table with a row for each; a record that fails is a row with the reason."""
    from msd_ident.workflow import pipeline

    folder = ""
    if record_pages is not None:
        run.make_folder(record_pages)
        folder = str(record_pages.absolute())
    job = job_of(
        source,
        options=pipeline.Options(model=model, tolerance=tolerance),
        all_joints=all_joints,
        labels=label,
        covariates=covariate,
        pages=folder,
    )
    target = _Target(out, resume, overwrite, report, quiet)
    return make([*(paths or ()), *_listed(listed)], job, target, (scheduler, workers))


def job_of(
    source: SourceOptions, *, labels: Sequence[str] | None, covariates: Sequence[str] | None, **given: Any
) -> Job:
    """A job as the command line's options say it.

    Raises:
        UsageError: a label or a covariate that is none.
    """
    from msd_ident.batching.job import Job

    beside = {"temperature": "", "load": "", **_pairs("--covariate", covariates)}
    return Job(source=source, labels=_pairs("--label", labels), covariates=beside, **given)


class _Target:
    """Where the results of a batch go, and whether anything is said meanwhile."""

    def __init__(self, out: str, resume: bool, overwrite: bool, report: Path | None, quiet: bool) -> None:
        from msd_ident.batching.table import is_table

        if not is_table(out):
            raise UsageError(f"{out} is no table's name; expected one that ends in .parquet")
        if report is not None:
            run.check_target(report, overwrite or resume)
        self.out, self.resume, self.overwrite, self.report, self.quiet = out, resume, overwrite, report, quiet


def make(paths: Sequence[str], job: Job, target: _Target, where: tuple[str, int]) -> int:
    """Run the batch and tell how it went; exit code 0, whatever single records are like."""
    from msd_ident.batching import batch as many
    from msd_ident.batching import locations

    found = locations.records(paths)
    with many.linked(*where) as link, bar(link.client.dashboard_link, target.quiet) as tell:
        plan = many.Plan(target.out, target.resume, target.overwrite, _draw if job.pages else None, tell)
        table, this = many.run(found, job, link, plan)
    failed = sum(error is not None for error in table.column("error").to_pylist())
    if not target.quiet:
        print(f"{target.out}: {table.num_rows} rows, {failed} with an error, {this.reused} records done before")
    if target.report is not None:
        from msd_ident.report import batch_page

        batch_page.save(table, target.report, target.out)
        if not target.quiet:
            print(f"report: {target.report}")
    return 0


def _draw(found: Any, path: str, target: Path) -> None:
    """A record's own page, on the worker."""
    from msd_ident.report import page

    page.save([found], target)


def _listed(name: str) -> Sequence[str]:
    from msd_ident.batching import locations

    if not name:
        return ()
    try:
        text = sys.stdin.read() if name == "-" else Path(name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"cannot read the list {name}: {error}; expected a text file with a path a line") from None
    return locations.listed(text)


def _pairs(option: str, given: Sequence[str] | None) -> dict[str, str]:
    found = {}
    for text in given or ():
        name, sign, value = text.partition("=")
        if not (name and sign and value):
            raise UsageError(f"{option} {text!r}; expected NAME=VALUE")
        found[name] = value
    return found


@contextmanager
def bar(dashboard: str, quiet: bool) -> Iterator[Callable[[int, int, Sequence[Any]], None]]:
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

        def tell(done: int, total: int, rows: Sequence[Any]) -> None:
            rate = done / max(time.monotonic() - began, 1e-3)
            progress.update(task, completed=done, total=total, rate=f"{rate:.3g} records/s")

        yield tell


#: Seconds between two lines of progress in a file.
_LINE_SECONDS = 10.0


def _lines() -> Callable[[int, int, Sequence[Any]], None]:
    began = last = time.monotonic()

    def tell(done: int, total: int, rows: Sequence[Any]) -> None:
        """Print a line about the progress, at most one in ``_LINE_SECONDS``."""
        nonlocal last
        now = time.monotonic()
        if now - last < _LINE_SECONDS and done < total:
            return
        last = now
        rate = done / max(now - began, 1e-3)
        left = (total - done) / rate
        print(f"{done} of {total} records, {rate:.3g} per second, {left:.0f} s left", file=sys.stderr, flush=True)

    return tell
