"""``msd identify``: parameters with intervals from bags, MCAP files and CSV files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Optional, cast

import typer

from msd_ident.cli import sources

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident import pipeline
    from msd_ident.identification import Identification
    from msd_ident.record import Record


def identify(
    paths: sources.PathsArgument,
    force: sources.ForceOption = "",
    position: sources.PositionOption = "",
    time: sources.TimeOption = "",
    force_scale: sources.ForceScaleOption = None,
    position_scale: sources.PositionScaleOption = None,
    time_scale: sources.TimeScaleOption = None,
    force_unit: sources.ForceUnitOption = "",
    position_unit: sources.PositionUnitOption = "",
    hold: sources.HoldOption = "zero",
    start: sources.StartOption = None,
    end: sources.EndOption = None,
    model: Annotated[str, typer.Option(help="auto, spring, or no_spring for a plain axis")] = "auto",
    loss: Annotated[str, typer.Option(help="linear, or soft_l1 where single samples are wild")] = "linear",
    together: sources.TogetherOption = False,
    json: sources.JsonOption = "",
    figures: Annotated[Optional[Path], typer.Option(help="folder for Figures 7 and 8 as PNG")] = None,  # noqa: UP045
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
) -> int:
    """Identify (ωn, ζ, K), then m, b, k and dry friction, each with its interval."""
    from msd_ident import pipeline
    from msd_ident.cli import run
    from msd_ident.report import tables

    source = sources.options(
        force, position, time, force_scale, position_scale, time_scale, force_unit, position_unit, hold, start, end
    )
    options = pipeline.Options(model, cast(Literal["linear", "soft_l1"], loss))
    output = run.Output(json, quiet, overwrite)

    if figures is not None:
        run.make_folder(figures)

    def solve(records: Sequence[Record], progress: pipeline.Progress) -> Identification:
        found = pipeline.identify(records, options, progress)
        if figures is not None:
            _draw(found, figures, overwrite)
        return found

    def show(found: Identification, console: Console) -> None:
        tables.print_identification(found, console)
        if figures is not None:
            console.print(f"figures: {figures / found.name}", soft_wrap=True)

    return run.work(paths, source, together, output, solve, show)


def _draw(found: Identification, folder: Path, overwrite: bool) -> None:
    from msd_ident.cli import run
    from msd_ident.report import figures

    target = folder / found.name
    if target.is_dir():
        for path in figures.paths(found, target):
            run.check_target(path, overwrite)
    figures.save(found, target)
