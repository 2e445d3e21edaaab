"""Options that several subcommands share: each stands here once, with its help text and its panel in ``--help``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.design import Limits

#: Panels of ``--help``.
SOURCE, MODEL, OUTPUT, RIG, BATCH = "Source", "Model", "Output", "Rig", "Many records"

# typer reads these annotations at run time, also on Python 3.10: hence Optional.

# Source: which records, and how they are read.
PathsArgument = Annotated[list[Path], typer.Argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file")]
ResultArgument = Annotated[
    Path, typer.Argument(metavar="RESULT.json", help="file that --json of identify or diagnose wrote")
]
LineOption = Annotated[
    Optional[int],  # noqa: UP045
    typer.Option("--line", min=1, help="line of RESULT.json to use, if it has several", rich_help_panel=SOURCE),
]
ForceOption = Annotated[
    str,
    typer.Option(
        "--force", metavar="TOPIC:FIELD|COLUMN|none", help="force signal; none: free decay", rich_help_panel=SOURCE
    ),
]
PositionOption = Annotated[
    str, typer.Option("--position", metavar="TOPIC:FIELD|COLUMN", help="position signal", rich_help_panel=SOURCE)
]
TimeOption = Annotated[
    str, typer.Option("--time", metavar="COLUMN", help="time column of a table", rich_help_panel=SOURCE)
]
RateOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--rate", metavar="HZ", help="sampling rate of a table without a time column", rich_help_panel=SOURCE),
]
RunOption = Annotated[
    str,
    typer.Option(
        "--run",
        metavar="N|all",
        help="run to use, in a table with several side by side; all: each is a record",
        rich_help_panel=SOURCE,
    ),
]
ForceScaleOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(help="factor from the source's force to the force unit", rich_help_panel=SOURCE),
]
PositionScaleOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(
        help="factor from the source's position to the position unit; negative inverts the sign",
        rich_help_panel=SOURCE,
    ),
]
TimeScaleOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(help="factor from the time column to seconds", rich_help_panel=SOURCE),
]
ForceUnitOption = Annotated[
    str,
    typer.Option(
        help="force unit after scaling: N or N·m; any other (e.g. V) means that the gain is unknown",
        rich_help_panel=SOURCE,
    ),
]
PositionUnitOption = Annotated[
    str, typer.Option(help="position unit after scaling: m, rad or count", rich_help_panel=SOURCE)
]
HoldOption = Annotated[
    str,
    typer.Option(
        help="force between its samples: zero (held), linear, band_limited; auto: inferred from a table's data",
        rich_help_panel=SOURCE,
    ),
]
StartOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(help="start of the part to use, in seconds", rich_help_panel=SOURCE),
]
EndOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(help="end of the part to use, in seconds", rich_help_panel=SOURCE),
]
TogetherOption = Annotated[
    bool, typer.Option("--together", help="treat all paths as one experiment with one model", rich_help_panel=SOURCE)
]
AllJointsOption = Annotated[
    bool, typer.Option("--all-joints", help="treat every joint of a bag separately", rich_help_panel=SOURCE)
]

# Model: what is fitted, and how the result is judged.
ModelOption = Annotated[
    str, typer.Option(help="auto, spring, or no_spring for an axis without a spring", rich_help_panel=MODEL)
]
ToleranceOption = Annotated[
    float,
    typer.Option(
        "--tolerance",
        metavar="PERCENT",
        help="unexplained part of the motion that is acceptable",
        rich_help_panel=MODEL,
    ),
]
CalibrateOption = Annotated[
    bool,
    typer.Option(
        "--calibrate",
        help="calibrate the probabilities on simulated copies of the record (takes about a minute)",
        rich_help_panel=MODEL,
    ),
]

# Output: where results go.
JsonOption = Annotated[
    str,
    typer.Option(
        "--json",
        metavar="FILE|-",
        help="write results as JSON, one object per line; -: to standard output, without tables",
        rich_help_panel=OUTPUT,
    ),
]
ReportOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--report",
        metavar="FILE.html",
        help="write one self-contained page with plots and tables",
        rich_help_panel=OUTPUT,
    ),
]
MarkdownOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--markdown", metavar="FILE.md", help="write a summary for the lab notebook", rich_help_panel=OUTPUT),
]
FiguresOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--figures",
        metavar="FOLDER",
        help="write the page's plots as PNG and SVG, one folder per result",
        rich_help_panel=OUTPUT,
    ),
]
ExportOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(
        "--export",
        metavar="TARGET:FILE",
        help="also export the model, as msd export does; repeatable",
        rich_help_panel=OUTPUT,
    ),
]
OnOption = Annotated[
    Optional[list[Path]],  # noqa: UP045
    typer.Option(
        "--on",
        metavar="PATH",
        help="also validate the model on this record, as msd validate does; repeatable",
        rich_help_panel=OUTPUT,
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="print no tables and no progress", rich_help_panel=OUTPUT)]
OverwriteOption = Annotated[
    bool, typer.Option("--overwrite", help="replace files that already exist", rich_help_panel=OUTPUT)
]

# Rig: what a real or simulated rig is asked for.
LimitsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--limits",
        metavar="FILE",
        help="YAML file with the rig's limits: force, travel, duration (and speed)",
        rich_help_panel=RIG,
    ),
]
NamespaceOption = Annotated[str, typer.Option(help="ROS namespace of the rig's topics", rich_help_panel=RIG)]
SilenceOption = Annotated[
    float,
    typer.Option(help="longest time without an encoder sample before a run stops, in seconds", rich_help_panel=RIG),
]
LeadOption = Annotated[
    float,
    typer.Option(
        min=0.0,
        help="send each force this long before it is due, in seconds; 0: for a rig that acts at once",
        rich_help_panel=RIG,
    ),
]

# Many records: batch, and what compare and watch do with folders.
SchedulerOption = Annotated[
    str,
    typer.Option(
        "--scheduler",
        metavar="tcp://HOST:8786",
        help="scheduler of a running Dask cluster; default: this machine",
        rich_help_panel=BATCH,
    ),
]
WorkersOption = Annotated[
    int, typer.Option("--workers", help="processes on this machine; 0: one per core", rich_help_panel=BATCH)
]
LabelOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(
        "--label",
        metavar="robot|day=REGEX",
        help="fill a column from the path, e.g. robot='arm_([0-9]+)'",
        rich_help_panel=BATCH,
    ),
]
CovariateOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(
        "--covariate",
        metavar="NAME=TOPIC:FIELD|COLUMN",
        help="signal of the temperature or the load",
        rich_help_panel=BATCH,
    ),
]


def limits_of(path: Path | None) -> Limits:
    """The limits in the file that ``--limits`` names.

    Raises:
        UsageError: no file was named.
        DataError: it cannot be read, or a limit is missing.
    """
    from msd_ident.design import read_limits

    if path is None:
        raise UsageError("no limits; expected --limits FILE with force, travel and duration that the rig takes")
    return read_limits(path)
