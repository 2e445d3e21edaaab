"""``msd diagnose``: what the simulation gets wrong, the name of the cause, the extended model and its gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from msd_ident.cli import groups, options, results, solving
from msd_ident.cli.further import Further

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.workflow import pipeline


@groups.grouped("json", "report", "markdown", "figures", "quiet", "overwrite")
def diagnose(
    paths: options.PathsArgument,
    source: groups.Source,
    model: options.ModelOption = "auto",
    tolerance: options.ToleranceOption = 1.0,
    calibrate: options.CalibrateOption = False,
    together: options.TogetherOption = False,
    on: options.OnOption = None,
    export: options.ExportOption = None,
    *,
    output: results.Output,
    all_joints: options.AllJointsOption = False,
) -> int:
    """Find what the model of mass, damping and stiffness lacks: causes, probabilities, extended model, gain."""
    from msd_ident.report import diagnosis as tables
    from msd_ident.workflow import pipeline

    settings = pipeline.Options(model=model, tolerance=tolerance, calibrate=calibrate)
    if all_joints:
        from msd_ident.cli.joints import diagnose_joints

        others = (source.force, source.position, output.report, output.markdown, output.figures, together, on, export)
        return diagnose_joints(paths, source, settings, output, others)

    def solve(records: Sequence[Record], progress: pipeline.Progress) -> Diagnosis:
        def tell(stage: str, fraction: float, cause: str) -> None:
            progress(f"{stage}: {cause}" if cause else stage, fraction)

        return pipeline.diagnose(records, settings, tell)

    further = Further(on or (), export or (), source)
    return solving.work(solving.Data(paths, source, together), output, solve, tables.print_diagnosis, further)[0]
