"""``msd identify``: parameters with intervals from bags, MCAP files and CSV files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal, Optional, cast

import typer

from msd_ident.cli import exports, pages, run, sources, trials

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.workflow import pipeline
    from msd_ident.workflow.identification import Identification


@sources.reading
def identify(
    paths: sources.PathsArgument,
    source: sources.Source,
    model: sources.ModelOption = "auto",
    loss: Annotated[str, typer.Option(help="linear, or soft_l1 where single samples are wild")] = "linear",
    mass: Annotated[
        str,
        typer.Option("--mass", metavar="KG[±STD]", help="the moving mass, weighed; gives a free decay newtons"),
    ] = "",
    known: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option("--known", metavar="NAME=VALUE[±STD]", help="a parameter known beforehand; repeatable"),
    ] = None,
    together: sources.TogetherOption = False,
    on: trials.OnOption = None,
    export: exports.ExportOption = None,
    json: sources.JsonOption = "",
    report: pages.ReportOption = None,
    markdown: pages.MarkdownOption = None,
    figures: pages.FiguresOption = None,
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
) -> int:
    """Identify (ωn, ζ, K), then m, b, k and dry friction, each with its interval."""
    from msd_ident.report import tables
    from msd_ident.workflow import pipeline
    from msd_ident.workflow.known_parameters import parse_all

    options = pipeline.Options(model, cast(Literal["linear", "soft_l1"], loss), parse_all(known or (), mass))
    output = run.Output(json, quiet, overwrite)
    targets = pages.Pages(report, markdown, figures, source, output)
    targets.check()
    tried, exported = trials.Trials(on or (), source), exports.Exports(export or (), source, targets)
    exported.check(1 if together else len(paths))

    def solve(records: Sequence[Record], progress: pipeline.Progress) -> Identification:
        return pipeline.identify(records, options, progress)

    further = trials.both(tried, exported)
    code = run.work(paths, source, together, output, solve, tables.print_identification, exported.keep, further)
    targets.finish()
    return code
