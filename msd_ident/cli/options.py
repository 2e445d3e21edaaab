"""Options that several subcommands share: each is defined once, with its help text and its panel in ``--help``."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.design import Limits

#: Panels of ``--help``.
SOURCE, MODEL, OUTPUT, RIG, BATCH = "Source", "Model", "Output", "Rig", "Many records"

# An option of a panel.
source_option = partial(typer.Option, rich_help_panel=SOURCE)
model_option = partial(typer.Option, rich_help_panel=MODEL)
output_option = partial(typer.Option, rich_help_panel=OUTPUT)
rig_option = partial(typer.Option, rich_help_panel=RIG)
batch_option = partial(typer.Option, rich_help_panel=BATCH)


def _named(context: typer.Context, option: typer.CallbackParam, value: str) -> str:
    """The file of an option, which must have a name if it is given: an unset variable of a shell has none."""
    source = context.get_parameter_source(option.name or "")
    if not value and source is not None and source.name == "COMMANDLINE":
        raise UsageError(f"{option.opts[0]} names no file; expected a file's name, or - for standard output")
    return value


def path_of(text: str) -> Path:
    """A path of the command line; an empty one, as of an unset variable of a shell, would be the current folder.

    Raises:
        UsageError: it is empty.
    """
    if not text:
        raise UsageError("an empty path; expected a file or folder: check the variable that it comes from, or write .")
    return Path(text)


#: An argument that is a path.
path_argument = partial(typer.Argument, parser=path_of)

# Source: which records, and how they are read.
PathsArgument = Annotated[list[Path], path_argument(metavar="PATH…", help="rosbag2 folder, .mcap, .csv or .mat file")]
ResultArgument = Annotated[
    Path, path_argument(metavar="RESULT.json", help="file that --json of identify or diagnose wrote")
]
LineOption = Annotated[int | None, source_option("--line", min=1, help="line of RESULT.json to use, if it has several")]
ForceOption = Annotated[
    str, source_option("--force", metavar="TOPIC:FIELD|COLUMN|none", help="force signal; none: free decay")
]
PositionOption = Annotated[str, source_option("--position", metavar="TOPIC:FIELD|COLUMN", help="position signal")]
TimeOption = Annotated[str, source_option("--time", metavar="COLUMN", help="time column of a table")]
RateOption = Annotated[
    float | None, source_option("--rate", metavar="HZ", help="sampling rate of a table without a time column")
]
RunOption = Annotated[
    str,
    source_option(
        "--run", metavar="N|all", help="run to use, in a table with several side by side; all: each is a record"
    ),
]
ForceScaleOption = Annotated[
    float | None, source_option(help="factor from the source's force to --force-unit, or to the record's unit without")
]
PositionScaleOption = Annotated[
    float | None,
    source_option(
        help="factor from the source's position to --position-unit (m or rad without); negative inverts the sign"
    ),
]
TimeScaleOption = Annotated[float | None, source_option(help="factor from the time column to seconds")]
ForceUnitOption = Annotated[
    str,
    source_option(
        help="force unit after scaling: N or N·m (kN becomes N); any other (e.g. V) means that the gain is unknown"
    ),
]
PositionUnitOption = Annotated[
    str, source_option(help="position unit after scaling: m, rad or count; deg becomes rad, mm, cm, um and in become m")
]
HoldOption = Annotated[
    str,
    source_option(
        help="force between its samples: zero (held), linear, band_limited, centred; auto: inferred from a table's data"
    ),
]
StartOption = Annotated[float | None, source_option(help="start of the part to use, in seconds")]
EndOption = Annotated[float | None, source_option(help="end of the part to use, in seconds")]
TogetherOption = Annotated[bool, source_option("--together", help="treat all paths as one experiment with one model")]
AllJointsOption = Annotated[bool, source_option("--all-joints", help="treat every joint of a bag separately")]

# Model: what is fitted, and how the result is judged.
ModelOption = Annotated[str, model_option(help="auto, spring, or no_spring for an axis without a spring")]
ToleranceOption = Annotated[
    float, model_option("--tolerance", metavar="PERCENT", help="unexplained part of the motion that is acceptable")
]
CalibrateOption = Annotated[
    bool,
    model_option(
        "--calibrate", help="calibrate the probabilities on simulated copies of the record (takes about a minute)"
    ),
]

# Output: where results go.
JsonOption = Annotated[
    str,
    output_option(
        "--json",
        metavar="FILE|-",
        help="write results as JSON, one object per line; -: to standard output, without tables",
        callback=_named,
    ),
]
ReportOption = Annotated[
    Path | None,
    output_option("--report", metavar="FILE.html", help="write one self-contained page with plots and tables"),
]
MarkdownOption = Annotated[
    Path | None, output_option("--markdown", metavar="FILE.md", help="write a summary for the lab notebook")
]
FiguresOption = Annotated[
    Path | None,
    output_option("--figures", metavar="FOLDER", help="write the page's plots as PNG and SVG, one folder per result"),
]
ExportOption = Annotated[
    list[str] | None,
    output_option("--export", metavar="TARGET:FILE", help="also export the model, as msd export does; repeatable"),
]
OnOption = Annotated[
    list[Path] | None,
    output_option(
        "--on", metavar="PATH", help="also validate the model on this record, as msd validate does; repeatable"
    ),
]
QuietOption = Annotated[bool, output_option("--quiet", help="print no tables and no progress")]
OverwriteOption = Annotated[bool, output_option("--overwrite", help="replace files that already exist")]

# Rig: what a real or simulated rig is asked for.
LimitsOption = Annotated[
    Path | None,
    rig_option("--limits", metavar="FILE", help="YAML file with the rig's limits: force, travel, duration (and speed)"),
]
NamespaceOption = Annotated[str, rig_option(help="ROS namespace of the rig's topics")]
SilenceOption = Annotated[
    float, rig_option(help="longest time without an encoder sample before a run stops, in seconds")
]
LeadOption = Annotated[
    float,
    rig_option(min=0.0, help="send each force this long before it is due, in seconds; 0: for a rig that acts at once"),
]

# Many records: batch, and what compare and watch do with folders.
SchedulerOption = Annotated[
    str,
    batch_option(
        "--scheduler", metavar="tcp://HOST:8786", help="scheduler of a running Dask cluster; default: this machine"
    ),
]
WorkersOption = Annotated[int, batch_option("--workers", help="processes on this machine; 0: one per core")]
LabelOption = Annotated[
    list[str] | None,
    batch_option("--label", metavar="robot|day=REGEX", help="fill a column from the path, e.g. robot='arm_([0-9]+)'"),
]
CovariateOption = Annotated[
    list[str] | None,
    batch_option("--covariate", metavar="NAME=TOPIC:FIELD|COLUMN", help="signal of the temperature or the load"),
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
