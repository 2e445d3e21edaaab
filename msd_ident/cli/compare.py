"""``msd compare``: which parameters robots, joints or days share, and which one differs."""

from __future__ import annotations

from typing import Annotated

from msd_ident.cli import batch, many, options, run, sources


@sources.reading
def compare(
    paths: many.TablesArgument,
    source: sources.Source,
    by: Annotated[str, options.source_option("--by", metavar="robot|joint|day", help="groups to compare")] = "robot",
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
    """Compare robots, joints or days: which parameters they share, and which differ."""
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
