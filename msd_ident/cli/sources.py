"""Options that every subcommand reading measurements shares, written once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Optional, cast

import typer

if TYPE_CHECKING:
    from msd_ident.bag import SourceOptions

# typer reads these annotations at run time, also on Python 3.10: hence Optional.
PathsArgument = Annotated[list[Path], typer.Argument(metavar="PATH…", help="rosbag2 folder, .mcap file or .csv file")]
ForceOption = Annotated[
    str, typer.Option("--force", metavar="TOPIC:FIELD|COLUMN|none", help="where the force is; none: a free decay")
]
PositionOption = Annotated[str, typer.Option("--position", metavar="TOPIC:FIELD|COLUMN", help="where the position is")]
TimeOption = Annotated[str, typer.Option("--time", metavar="COLUMN", help="time column of a CSV file")]
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
StartOption = Annotated[Optional[float], typer.Option(help="first second to use")]  # noqa: UP045
EndOption = Annotated[Optional[float], typer.Option(help="last second to use")]  # noqa: UP045
ModelOption = Annotated[str, typer.Option(help="auto, spring, or no_spring for a plain axis")]
TogetherOption = Annotated[bool, typer.Option("--together", help="all paths are one experiment: one model for all")]
JsonOption = Annotated[
    str, typer.Option("--json", metavar="FILE|-", help="one JSON object a path; -: and nothing else on stdout")
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="no tables, no progress")]
OverwriteOption = Annotated[bool, typer.Option("--overwrite", help="replace files that exist")]


def options(
    force: str,
    position: str,
    time: str,
    force_scale: float | None,
    position_scale: float | None,
    time_scale: float | None,
    force_unit: str,
    position_unit: str,
    hold: str,
    start: float | None,
    end: float | None,
) -> SourceOptions:
    """The reader's options from the command line's words.

    Raises:
        UsageError: what the reader's options refuse.
    """
    from msd_ident.bag import SourceOptions

    return SourceOptions(
        force=force,
        position=position,
        time=time,
        force_scale=force_scale,
        position_scale=position_scale,
        time_scale=time_scale,
        force_unit=force_unit,
        position_unit=position_unit,
        hold=cast(Literal["auto", "zero", "linear", "band_limited"], hold),
        start=start,
        end=end,
    )
