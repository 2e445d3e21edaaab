"""``msd validate``: a saved model tried on other records."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from msd_ident.cli import pages, run, sources
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.workflow.saved_model import SavedModel
    from msd_ident.workflow.validation import Options, Validation


@sources.reading
def validate(
    result: Annotated[Path, typer.Argument(metavar="RESULT.json", help="what --json of identify or diagnose wrote")],
    source: sources.Source,
    paths: Annotated[
        Optional[list[Path]],  # noqa: UP045
        typer.Argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file"),
    ] = None,
    line: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option("--line", min=1, help="which result of a file with several, one a line"),
    ] = None,
    refit_zero: Annotated[
        bool, typer.Option("--refit-zero", help="fit the encoder's zero too; it is kept from the result otherwise")
    ] = False,
    require: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option("--require", metavar="PERCENT", help="exit code 1 where less of the motion is explained"),
    ] = None,
    mujoco: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--mujoco", metavar="ROBOT.xml", help="try this MuJoCo model in place of a result; with --joint"),
    ] = None,
    joint: Annotated[str, typer.Option("--joint", metavar="NAME", help="joint of --mujoco")] = "",
    function: Annotated[
        str, typer.Option("--callable", metavar="MODULE:FUNCTION", help="try this Python function in place of a result")
    ] = "",
    simulated: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--simulated", metavar="FILE", help="try these simulated positions in place of a result"),
    ] = None,
    together: sources.TogetherOption = False,
    json: sources.JsonOption = "",
    report: pages.ReportOption = None,
    figures: pages.FiguresOption = None,
    quiet: sources.QuietOption = False,
    overwrite: sources.OverwriteOption = False,
) -> int:
    """Validate a saved model on other records, nothing refitted but their start, or name what your simulation lacks."""
    output = run.Output(json, quiet, overwrite)
    if mujoco is not None or function or simulated is not None:
        from msd_ident.cli import theirs

        chosen = theirs.Chosen(mujoco, joint, function, simulated)
        return theirs.compare([result, *(paths or ())], source, together, output, chosen)
    if not paths:
        raise UsageError("no record to try the model on; expected msd validate RESULT.json PATH…")
    from msd_ident.workflow import validation

    options = validation.Options(refit_zero, require)
    targets = pages.Pages(report, None, figures, source, output)
    targets.check()
    return _tried(saved_model(result, line), options, paths, together, targets)


def _tried(saved: SavedModel, options: Options, paths: Sequence[Path], together: bool, targets: pages.Pages) -> int:
    """Try a saved model on every path, or on all together; the exit code."""
    from msd_ident.report import validation as tables
    from msd_ident.workflow import validation

    met = []

    def solve(records: Sequence[Record], progress: run.Progress) -> Validation:
        progress("simulating the saved model", 0.5)
        found = validation.validate(saved, records, options)
        met.append(found.met)
        return found

    source, output = targets.source, targets.output
    code = run.work(paths, source, together, output, solve, tables.print_validation, targets.keep)
    targets.finish()
    return code or (0 if all(met) else 1)


def saved_model(path: Path, line: int | None) -> SavedModel:
    """The saved model of a file, of the line asked for."""
    from msd_ident.workflow import saved_model as saved

    if line is None:
        return saved.load(path)
    found = saved.load_all(path)
    if line > len(found):
        raise UsageError(f"{path} holds {len(found)} results; expected one with number {line}: give another --line")
    return found[line - 1]
