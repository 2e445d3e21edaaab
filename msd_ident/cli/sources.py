"""Options that every subcommand reading measurements shares, written once."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

if TYPE_CHECKING:
    from msd_ident.io import SourceOptions

    Source = SourceOptions
else:
    Source = Any  # evaluated at run time, when the readers are not to be loaded yet

# typer reads these annotations at run time, also on Python 3.10: hence Optional.
PathsArgument = Annotated[list[Path], typer.Argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file")]
ForceOption = Annotated[
    str, typer.Option("--force", metavar="TOPIC:FIELD|COLUMN|none", help="where the force is; none: a free decay")
]
PositionOption = Annotated[str, typer.Option("--position", metavar="TOPIC:FIELD|COLUMN", help="where the position is")]
TimeOption = Annotated[str, typer.Option("--time", metavar="COLUMN", help="time column of a table")]
ForceScaleOption = Annotated[Optional[float], typer.Option(help="force unit per unit of the source")]  # noqa: UP045
PositionScaleOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(help="position unit per unit of the source; negative turns the sign"),
]
TimeScaleOption = Annotated[Optional[float], typer.Option(help="seconds per unit of the time column")]  # noqa: UP045
ForceUnitOption = Annotated[
    str, typer.Option(help="unit after scaling: N, N·m; any other, e.g. V, says that the gain is unknown")
]
PositionUnitOption = Annotated[str, typer.Option(help="unit after scaling: m, rad or count")]
HoldOption = Annotated[
    str, typer.Option(help="force between its stamps: zero (held), linear, band_limited; auto asks the data of a table")
]
RateOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--rate", metavar="HZ", help="samples a second of a table without times"),
]
RunOption = Annotated[
    str, typer.Option("--run", metavar="N|all", help="run of a table with several side by side; all: each a record")
]
StartOption = Annotated[Optional[float], typer.Option(help="first second to use")]  # noqa: UP045
EndOption = Annotated[Optional[float], typer.Option(help="last second to use")]  # noqa: UP045
ModelOption = Annotated[str, typer.Option(help="auto, spring, or no_spring for a plain axis")]
ToleranceOption = Annotated[
    float,
    typer.Option("--tolerance", metavar="PERCENT", help="part of the motion that may stay unexplained"),
]
CalibrateOption = Annotated[
    bool,
    typer.Option(
        "--calibrate", help="correct the probabilities by diagnosing simulated copies of the record (a minute)"
    ),
]
TogetherOption = Annotated[bool, typer.Option("--together", help="all paths are one experiment: one model for all")]
JsonOption = Annotated[
    str, typer.Option("--json", metavar="FILE|-", help="one JSON object a path; -: and nothing else on stdout")
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="no tables, no progress")]
OverwriteOption = Annotated[bool, typer.Option("--overwrite", help="replace files that exist")]


#: Options that say how measurements are read: name of a ``SourceOptions`` field → annotation and default.
READING: dict[str, tuple[Any, Any]] = {
    "force": (ForceOption, ""),
    "position": (PositionOption, ""),
    "time": (TimeOption, ""),
    "rate": (RateOption, None),
    "run": (RunOption, ""),
    "force_scale": (ForceScaleOption, None),
    "position_scale": (PositionScaleOption, None),
    "time_scale": (TimeScaleOption, None),
    "force_unit": (ForceUnitOption, ""),
    "position_unit": (PositionUnitOption, ""),
    "hold": (HoldOption, "auto"),
    "start": (StartOption, None),
    "end": (EndOption, None),
}


def reading(command: Callable[..., int]) -> Callable[..., int]:
    """Give a subcommand all options of ``READING``, which it takes as one: its parameter ``source``.

    The command line refuses, as ``UsageError``, what ``SourceOptions`` refuses.
    """

    def told(**given: Any) -> int:
        from msd_ident.io import SourceOptions

        source = SourceOptions(**{name: given.pop(name) for name in READING})
        return command(source=source, **given)

    keyword = inspect.Parameter.KEYWORD_ONLY
    shared = [
        inspect.Parameter(name, keyword, default=default, annotation=annotation)
        for name, (annotation, default) in READING.items()
    ]
    own = inspect.signature(command, eval_str=True)
    parameters = [
        one
        for name, parameter in own.parameters.items()
        for one in (shared if name == "source" else [parameter.replace(kind=keyword)])
    ]
    told.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    told.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    told.__name__, told.__doc__, told.__module__ = command.__name__, command.__doc__, command.__module__
    return told
