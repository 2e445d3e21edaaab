"""``msd watch``: parameters and causes over days, change points, and an alarm whose false-alarm rate is stated."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from msd_ident.cli import batch, many, options, run, sources
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.monitoring.watching import Options, Watch


KeepOption = Annotated[
    str,
    options.batch_option("--table", metavar="TABLE.parquet", help="table that keeps the results of records in folders"),
]
FalseAlarmsOption = Annotated[
    float, options.model_option("--false-alarms", metavar="RATE", help="accepted false alarms per robot and year")
]
PerYearOption = Annotated[
    float,
    options.model_option(
        "--records-per-year", help="records per robot and year; 0: from their time stamps, else daily"
    ),
]
CheckOption = Annotated[bool, options.output_option("--check", help="exit with code 1 after an alarm")]
FollowOption = Annotated[
    float, options.batch_option("--follow", metavar="SECONDS", help="repeat with this period until Ctrl-C")
]


@sources.reading
def watch(
    paths: many.TablesArgument,
    source: sources.Source,
    keep: KeepOption = "msd_watch.parquet",
    false_alarms: FalseAlarmsOption = 1.0,
    per_year: PerYearOption = 0.0,
    check: CheckOption = False,
    follow: FollowOption = 0.0,
    scheduler: options.SchedulerOption = "",
    workers: options.WorkersOption = 0,
    all_joints: options.AllJointsOption = False,
    label: options.LabelOption = None,
    covariate: options.CovariateOption = None,
    json: options.JsonOption = "",
    report: options.ReportOption = None,
    quiet: options.QuietOption = False,
    overwrite: options.OverwriteOption = False,
) -> int:
    """Find changes of parameters over days, and raise an alarm with a known false-alarm rate."""
    from msd_ident.monitoring.watching import Options

    settings = Options(false_alarms, per_year)
    if follow < 0.0 or (follow and json == "-"):
        raise UsageError("--follow takes seconds above 0 and not --json -; expected a number and a file")
    output = run.Output(json, quiet, overwrite)
    output.check()
    if report is not None:
        run.check_target(report, overwrite)
    job = batch.job_of(source, all_joints=all_joints, labels=label, covariates=covariate)

    def look() -> list[Watch]:
        table = many.table_of(paths, job, (scheduler, workers), quiet, keep)
        return _told(table, settings, output, report, ", ".join(paths))

    found = _again(look, follow) if follow else look()
    return 1 if check and any(one.alarms for one in found) else 0


def _told(table: Any, settings: Options, output: run.Output, report: Path | None, source: str) -> list[Watch]:
    """Watch all robots of a table, and say what was found."""
    from msd_ident.monitoring import rows, watching

    found, few = [], []
    for name, samples in rows.by_robot(table).items():
        try:
            found.append(watching.watch(name, samples, settings))
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
