"""``msd watch``: parameters and causes over days, change points, and an alarm whose false-alarm rate is stated."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from msd_ident.cli import batch, many, run, sources
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.monitoring.watching import Options, Watch


@sources.reading
def watch(
    paths: many.TablesArgument,
    source: sources.Source,
    keep: Annotated[
        str, typer.Option("--table", metavar="TABLE.parquet", help="table that records of folders are kept in")
    ] = "msd_watch.parquet",
    false_alarms: Annotated[
        float, typer.Option("--false-alarms", metavar="RATE", help="false alarms a robot and year, at most")
    ] = 1.0,
    per_year: Annotated[
        float, typer.Option("--records-per-year", help="of a robot; 0: as their times say, else daily")
    ] = 0.0,
    check: Annotated[bool, typer.Option("--check", help="exit code 1 where there was an alarm")] = False,
    follow: Annotated[
        float, typer.Option("--follow", metavar="SECONDS", help="look again so often, until Ctrl-C")
    ] = 0.0,
    scheduler: batch.SchedulerOption = "",
    workers: batch.WorkersOption = 0,
    all_joints: Annotated[bool, typer.Option("--all-joints", help="every joint of a bag is watched")] = False,
    label: batch.LabelOption = None,
    covariate: batch.CovariateOption = None,
    json: Annotated[str, typer.Option("--json", metavar="FILE|-", help="one JSON object a robot")] = "",
    report: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--report", metavar="FILE.html", help="one page that needs no network"),
    ] = None,
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
) -> int:
    """Watch robots over days: what changed, when, how surely, and an alarm with a stated rate of false ones."""
    from msd_ident.monitoring.watching import Options

    options = Options(false_alarms, per_year)
    if follow < 0.0 or (follow and json == "-"):
        raise UsageError("--follow takes seconds above 0, and goes with --json FILE; expected both so")
    output = run.Output(json, quiet, overwrite)
    output.check()
    if report is not None:
        run.check_target(report, overwrite)
    job = batch.job_of(source, all_joints=all_joints, labels=label, covariates=covariate)

    def look() -> list[Watch]:
        table = many.table_of(paths, job, (scheduler, workers), quiet, keep)
        return _told(table, options, output, report, ", ".join(paths))

    found = _again(look, follow) if follow else look()
    return 1 if check and any(one.alarms for one in found) else 0


def _told(table: Any, options: Options, output: run.Output, report: Path | None, source: str) -> list[Watch]:
    """Watch all robots of a table, and say what was found."""
    from msd_ident.monitoring import rows, watching

    found, few = [], []
    for name, samples in rows.by_robot(table).items():
        try:
            found.append(watching.watch(name, samples, options))
        except DataError as error:
            few.append(error)
    if not found:
        raise few[0]
    run.write([one.to_json_dict() for one in found], output)
    if output.tables:
        for one in found:
            print(f"{one.name}: {one.sentence}")
        for missing in few:
            print(f"  left out: {missing}")
    if report is not None:
        from msd_ident.report import watch_page

        watch_page.save_watches(found, report, source)
    return found


def _again(look: Callable[[], list[Watch]], period: float) -> list[Watch]:
    """Look until somebody interrupts."""
    found: list[Watch] = []
    try:
        while True:
            found = look()
            time.sleep(period)
    except KeyboardInterrupt:
        return found
