"""``msd compare``: which parameters robots, joints or days share, and which one differs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

from msd_ident.cli import batch, many, run, sources


@sources.reading
def compare(
    paths: many.TablesArgument,
    source: sources.Source,
    by: Annotated[str, typer.Option("--by", metavar="robot|joint|day", help="what the groups are")] = "robot",
    scheduler: batch.SchedulerOption = "",
    workers: batch.WorkersOption = 0,
    all_joints: Annotated[bool, typer.Option("--all-joints", help="every joint of a bag is a record")] = False,
    label: batch.LabelOption = None,
    covariate: batch.CovariateOption = None,
    json: Annotated[str, typer.Option("--json", metavar="FILE|-", help="one JSON object; -: nothing else")] = "",
    report: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--report", metavar="FILE.html", help="one page that needs no network"),
    ] = None,
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
) -> int:
    """Compare robots, joints or days: what they share, what differs, and whether it is the robot at all."""
    from msd_ident.comparison import comparing, rows

    output = run.Output(json, quiet, overwrite)
    output.check()
    if report is not None:
        run.check_target(report, overwrite)
    rows.check(by)
    job = batch.job_of(source, all_joints=all_joints, labels=label, covariates=covariate)
    table = many.table_of(paths, job, (scheduler, workers), quiet)
    measured, said = rows.measured(table, by)
    found = comparing.compare(measured, by, said)
    run.write([found.to_json_dict()], output)
    if output.tables:
        print(found.sentence)
        for warning in found.warnings:
            print(f"  {warning}")
    if report is not None:
        from msd_ident.report import compare_page

        compare_page.save_comparison(found, report, ", ".join(paths))
        if output.tables:
            print(f"report: {report}")
    return 0
