"""``msd batch``: many records, a row each, on all cores of this machine or on a cluster."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli import groups, many_records, options, progress, results
from msd_ident.errors import DataError, Interrupted, UsageError

if TYPE_CHECKING:
    from msd_ident.batching.batch import Plan
    from msd_ident.batching.job import Job

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


@groups.grouped()
def batch(
    source: groups.Source,
    out: OutOption,
    paths: ManyArgument = None,
    listed: ListOption = "",
    *,
    batching: many_records.Batching,
    model: options.ModelOption = "auto",
    tolerance: options.ToleranceOption = 1.0,
    resume: ResumeOption = False,
    report: options.ReportOption = None,
    record_pages: RecordPagesOption = None,
    quiet: options.QuietOption = False,
    overwrite: options.OverwriteOption = False,
) -> int:
    """Diagnose many records into one table with a row for each; a record that fails is a row with the reason."""
    from msd_ident.batching import batch as batches
    from msd_ident.batching import locations
    from msd_ident.batching.table import is_table
    from msd_ident.workflow import pipeline

    folder = ""
    if record_pages is not None:
        results.make_folder(record_pages)
        folder = str(record_pages.absolute())
    job = batching.job(source, options=pipeline.Options(model=model, tolerance=tolerance), pages=folder)
    if not is_table(out):
        raise UsageError(f"{out} is no table's name; expected one that ends in .parquet")
    output = results.Output(quiet=quiet, overwrite=overwrite or resume, report=report)
    records = locations.records([*(paths or ()), *_listed(listed)])
    job.check_labels(records)  # at once, and not behind the start of a cluster
    listing = [listed] if listed not in ("", "-") else []
    output.check(*many_records.here([*records, *listing]), written=many_records.here([out]))
    plan = batches.Plan(out, resume, overwrite, _draw if job.pages else None)
    return _run(records, job, plan, output, batching)


def _run(paths: Sequence[str], job: Job, plan: Plan, output: results.Output, batching: many_records.Batching) -> int:
    """Run the batch and say how it went; exit code 0, whatever single records are like.

    Raises:
        DataError: no record at all has a result; the table with the reasons is written.
    """
    from msd_ident.batching import batch as batches

    try:
        with (
            batches.linked(batching.scheduler, batching.workers) as link,
            progress.records(link.client.dashboard_link, output.quiet) as tell,
        ):
            table, this = batches.run(paths, job, link, replace(plan, progress=tell))
    except KeyboardInterrupt:
        raise Interrupted(_kept(plan.out)) from None
    errors = [error for error in table.column("error").to_pylist() if error is not None]
    failed = len(errors)
    if not output.quiet:
        print(f"{plan.out}: {table.num_rows} rows, {failed} with an error, {this.reused} records done before")
    if output.report is not None:
        from msd_ident.report import batch_page

        batch_page.save(table, output.report, plan.out)
        if not output.quiet:
            print(f"report: {output.report}")
    if failed and failed == table.num_rows:
        raise DataError(
            f"no record of {plan.out} has a result ({errors[0]}); expected one at least: the reason of each is in its "
            "column error"
        )
    return 0


def _kept(out: str) -> str:
    """What an interrupted batch leaves, and how to go on with it."""
    from msd_ident.batching.table import Store

    stands = Store(out).stands()
    if not stands.endswith(".parts"):
        return "no record was finished"
    return f"finished records are in {stands}: go on with --resume"


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
