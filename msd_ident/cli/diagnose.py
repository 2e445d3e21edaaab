"""``msd diagnose``: what the simulation gets wrong, the name of the cause, the extended model and its gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from msd_ident.cli import exports, pages, run, sources, trials

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.workflow import pipeline


@sources.reading
def diagnose(
    paths: sources.PathsArgument,
    source: sources.Source,
    model: sources.ModelOption = "auto",
    tolerance: sources.ToleranceOption = 1.0,
    calibrate: sources.CalibrateOption = False,
    together: sources.TogetherOption = False,
    on: trials.OnOption = None,
    export: exports.ExportOption = None,
    json: sources.JsonOption = "",
    report: pages.ReportOption = None,
    markdown: pages.MarkdownOption = None,
    figures: pages.FiguresOption = None,
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
    all_joints: Annotated[bool, typer.Option("--all-joints", help="every joint of a bag, each on its own")] = False,
) -> int:
    """Diagnose: what the model lacks, how sure that is, what it costs, what was gained, what is still open."""
    from msd_ident.report import diagnosis as tables
    from msd_ident.workflow import pipeline

    options = pipeline.Options(model=model, tolerance=tolerance, calibrate=calibrate)
    output = run.Output(json, quiet, overwrite)
    if all_joints:
        from msd_ident.cli.joints import diagnose_joints

        others = (source.force, source.position, report, markdown, figures)
        return diagnose_joints(paths, source, options, output, others)
    targets = pages.Pages(report, markdown, figures, source, output)
    targets.check()
    tried, exported = trials.Trials(on or (), source), exports.Exports(export or (), source, targets)
    exported.check(1 if together else len(paths))

    def solve(records: Sequence[Record], progress: pipeline.Progress) -> Diagnosis:
        def tell(stage: str, fraction: float, cause: str) -> None:
            progress(f"{stage}: {cause}" if cause else stage, fraction)

        return pipeline.diagnose(records, options, tell)

    further = trials.both(tried, exported)
    code = run.work(paths, source, together, output, solve, tables.print_diagnosis, exported.keep, further)
    targets.finish()
    return code
