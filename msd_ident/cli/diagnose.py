"""``msd diagnose``: what the simulation gets wrong, the name of the cause, the extended model and its gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from msd_ident.cli import exports, options, pages, run, sources, trials

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.workflow import pipeline


@sources.reading
def diagnose(
    paths: options.PathsArgument,
    source: sources.Source,
    model: options.ModelOption = "auto",
    tolerance: options.ToleranceOption = 1.0,
    calibrate: options.CalibrateOption = False,
    together: options.TogetherOption = False,
    on: options.OnOption = None,
    export: options.ExportOption = None,
    json: options.JsonOption = "",
    report: options.ReportOption = None,
    markdown: options.MarkdownOption = None,
    figures: options.FiguresOption = None,
    quiet: options.QuietOption = False,
    overwrite: options.OverwriteOption = False,
    all_joints: options.AllJointsOption = False,
) -> int:
    """Find what the model of mass, damping and stiffness lacks: causes, probabilities, extended model, gain."""
    from msd_ident.report import diagnosis as tables
    from msd_ident.workflow import pipeline

    settings = pipeline.Options(model=model, tolerance=tolerance, calibrate=calibrate)
    output = run.Output(json, quiet, overwrite)
    if all_joints:
        from msd_ident.cli.joints import diagnose_joints

        others = (source.force, source.position, report, markdown, figures)
        return diagnose_joints(paths, source, settings, output, others)
    targets = pages.Pages(report, markdown, figures, source, output)
    targets.check()
    tried, exported = trials.Trials(on or (), source), exports.Exports(export or (), source, targets)
    exported.check(1 if together else len(paths))

    def solve(records: Sequence[Record], progress: pipeline.Progress) -> Diagnosis:
        def tell(stage: str, fraction: float, cause: str) -> None:
            progress(f"{stage}: {cause}" if cause else stage, fraction)

        return pipeline.diagnose(records, settings, tell)

    further = trials.both(tried, exported)
    after = run.After(tables.print_diagnosis, exported.keep, further)
    code = run.work(run.Data(paths, source, together), output, solve, after)
    targets.finish()
    return code
