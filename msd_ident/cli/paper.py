"""``msd paper``: the paper's tables from its Table 1, and what its model cannot reproduce."""

from __future__ import annotations

from msd_ident.cli import groups, progress, results


@groups.grouped("json", "quiet", "overwrite")
def paper(output: results.Output) -> int:
    """Compute Tables 2 and 3 of the paper from its Table 1, and show what no viscous + Coulomb model reproduces."""
    from rich.console import Console

    from msd_ident.paper.method import study
    from msd_ident.report.paper_tables import print_paper

    output.check()
    with progress.stages(output.quiet) as report:
        found = study(progress=report)
    if output.tables:
        print_paper(found, Console(highlight=False))
    results.write([found.to_json_dict()], output)
    return 0
