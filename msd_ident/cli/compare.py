"""``msd compare``: which parameters robots, joints or days share, and which one differs."""

from __future__ import annotations

from typing import Annotated

from msd_ident.cli import groups, many_records, options, results


@groups.grouped("json", "report", "quiet", "overwrite")
def compare(
    paths: many_records.TablesArgument,
    source: groups.Source,
    by: Annotated[str, options.source_option("--by", metavar="robot|joint|day", help="groups to compare")] = "robot",
    *,
    batching: many_records.Batching,
    output: results.Output,
) -> int:
    """Compare robots, joints or days: which parameters they share, and which differ."""
    from msd_ident.comparison import comparing, rows

    output.check(*many_records.read_from(paths))
    rows.check(by)
    table = batching.table(paths, source, output.quiet)
    measured, remarks = rows.measured(table, by)
    found = comparing.compare(measured, by, remarks)
    results.write([found.to_json_dict()], output)
    if output.tables:
        print(found.sentence)
        for warning in found.warnings:
            print(f"  {warning}")
    if output.report is not None:
        from msd_ident.report import compare_page

        compare_page.save_comparison(found, output.report, ", ".join(paths))
        if output.tables:
            print(f"report: {output.report}")
    return 0
