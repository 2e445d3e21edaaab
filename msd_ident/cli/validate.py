"""``msd validate``: a saved model tried on other records."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from msd_ident.cli import groups, options, progress, results, solving
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.workflow.saved_model import SavedModel
    from msd_ident.workflow.validation import Options, Validation


#: Panel of ``--help`` for simulations of the user's own.
SIMULATION = "Your own simulation"
simulation_option = partial(typer.Option, rich_help_panel=SIMULATION)


PathsArgument = Annotated[
    list[Path] | None, options.path_argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file")
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


@groups.grouped("json", "report", "figures", "quiet", "overwrite")
def validate(
    result: options.ResultArgument,
    source: groups.Source,
    paths: PathsArgument = None,
    line: options.LineOption = None,
    refit_zero: RefitZeroOption = False,
    require: RequireOption = None,
    mujoco: MujocoOption = None,
    joint: JointOption = "",
    function: FunctionOption = "",
    simulated: SimulatedOption = None,
    together: options.TogetherOption = False,
    *,
    output: results.Output,
) -> int:
    """Validate a saved model on other records (only their initial state is fitted), or check your own simulation."""
    if joint and mujoco is None:
        raise UsageError(
            f"--joint {joint} without --mujoco; expected a MuJoCo model that has the joint: leave --joint away"
        )
    output.check(*filter(None, (result, mujoco, simulated)), *(paths or ()))
    if mujoco is not None or function or simulated is not None:
        from msd_ident.cli import user_simulation

        if refit_zero or line is not None:
            raise UsageError(
                "--refit-zero or --line with a simulation of your own; expected neither: they are about a saved result"
            )
        chosen = user_simulation.Chosen(mujoco, joint, function, simulated)
        data = solving.Data([result, *(paths or ())], source, together)
        return user_simulation.compare(data, chosen, require, output)
    if not paths:
        raise UsageError("no record to try the model on; expected msd validate RESULT.json PATH…")
    from msd_ident.workflow import validation

    settings = validation.Options(refit_zero, require)
    return _validate(saved_model(result, line), settings, solving.Data(paths, source, together), output)


def _validate(saved: SavedModel, settings: Options, data: solving.Data, output: results.Output) -> int:
    """Validate a saved model on every path, or on all together; the exit code."""
    from msd_ident.report.validation import print_validation
    from msd_ident.workflow import validation

    def solve(records: Sequence[Record], report: progress.Progress) -> Validation:
        report("simulating the saved model", 0.5)
        return validation.validate(saved, records, settings)

    code, found = solving.work(data, output, solve, print_validation)
    return code or (0 if all(one.met for one in found) else 1)


def saved_model(path: Path, line: int | None) -> SavedModel:
    """The saved model of a file, of the line asked for."""
    from msd_ident.workflow import saved_model as saved

    if line is None:
        return saved.load(path)
    found = saved.load_all(path)
    if line > len(found):
        raise UsageError(f"{path} holds {len(found)} results; expected one with number {line}: give another --line")
    return found[line - 1]
