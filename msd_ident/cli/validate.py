"""``msd validate``: a saved model tried on other records."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from msd_ident.cli import options, pages, run, sources
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.workflow.saved_model import SavedModel
    from msd_ident.workflow.validation import Options, Validation


#: Panel of ``--help`` for simulations of the user's own.
SIMULATION = "Your own simulation"
simulation_option = partial(typer.Option, rich_help_panel=SIMULATION)


PathsArgument = Annotated[
    list[Path] | None, typer.Argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file")
]
RefitZeroOption = Annotated[
    bool, options.model_option("--refit-zero", help="also fit the encoder's zero; default: the zero of the result")
]
RequireOption = Annotated[
    float | None,
    options.model_option(
        "--require", metavar="PERCENT", help="exit with code 1 if the model explains less of the motion"
    ),
]
MujocoOption = Annotated[
    Path | None,
    simulation_option(
        "--mujoco",
        metavar="ROBOT.xml",
        help="compare this MuJoCo model with the record, instead of a result; needs --joint",
    ),
]
JointOption = Annotated[str, simulation_option("--joint", metavar="NAME", help="joint of --mujoco")]
FunctionOption = Annotated[
    str,
    simulation_option(
        "--callable",
        metavar="MODULE:FUNCTION",
        help="compare this Python function with the record, instead of a result",
    ),
]
SimulatedOption = Annotated[
    Path | None,
    simulation_option(
        "--simulated", metavar="FILE", help="compare these simulated positions with the record, instead of a result"
    ),
]


@sources.reading
def validate(
    result: options.ResultArgument,
    source: sources.Source,
    paths: PathsArgument = None,
    line: options.LineOption = None,
    refit_zero: RefitZeroOption = False,
    require: RequireOption = None,
    mujoco: MujocoOption = None,
    joint: JointOption = "",
    function: FunctionOption = "",
    simulated: SimulatedOption = None,
    together: options.TogetherOption = False,
    json: options.JsonOption = "",
    report: options.ReportOption = None,
    figures: options.FiguresOption = None,
    quiet: options.QuietOption = False,
    overwrite: options.OverwriteOption = False,
) -> int:
    """Validate a saved model on other records (only their initial state is fitted), or check your own simulation."""
    targets = pages.Pages(report, None, figures, source, run.Output(json, quiet, overwrite))
    if mujoco is not None or function or simulated is not None:
        from msd_ident.cli import theirs

        if refit_zero or line is not None:
            raise UsageError(
                "--refit-zero or --line with a simulation of your own; expected neither: they are about a saved result"
            )
        chosen = theirs.Chosen(mujoco, joint, function, simulated)
        return theirs.compare([result, *(paths or ())], chosen, together, require, targets)
    if not paths:
        raise UsageError("no record to try the model on; expected msd validate RESULT.json PATH…")
    from msd_ident.workflow import validation

    settings = validation.Options(refit_zero, require)
    targets.check()
    return _tried(saved_model(result, line), settings, paths, together, targets)


def _tried(saved: SavedModel, settings: Options, paths: Sequence[Path], together: bool, targets: pages.Pages) -> int:
    """Try a saved model on every path, or on all together; the exit code."""
    from msd_ident.report import validation as tables
    from msd_ident.workflow import validation

    met = []

    def solve(records: Sequence[Record], progress: run.Progress) -> Validation:
        progress("simulating the saved model", 0.5)
        found = validation.validate(saved, records, settings)
        met.append(found.met)
        return found

    source, output = targets.source, targets.output
    after = run.After(tables.print_validation, targets.keep)
    code = run.work(run.Data(paths, source, together), output, solve, after)
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
