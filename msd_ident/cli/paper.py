"""``msd paper``: the paper's tables from its Table 1, and what its model cannot reproduce."""

from __future__ import annotations

from msd_ident.cli import options


def paper(
    json: options.JsonOption = "", quiet: options.QuietOption = False, overwrite: options.OverwriteOption = False
) -> int:
    """Compute Tables 2 and 3 of the paper from its Table 1, and show what no viscous + Coulomb model reproduces."""
    from rich.console import Console

    from msd_ident.cli import run
    from msd_ident.paper.method import study
    from msd_ident.report.paper_tables import print_paper

    output = run.Output(json, quiet, overwrite)
    output.check()
    with run.progress(quiet) as progress:
        found = study(progress=progress)
    if output.tables:
        print_paper(found, Console(highlight=False))
    run.write([found.to_json_dict()], output)
    return 0
