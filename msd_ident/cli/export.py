"""``msd export``: a saved model as a file that another simulation reads, with proof by replay."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from msd_ident.cli import groups, options, pages, results
from msd_ident.cli.validate import saved_model
from msd_ident.errors import MsdError, UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.io import SourceOptions
    from msd_ident.workflow.saved_model import SavedModel

ToOption = Annotated[
    str,
    options.output_option(
        "--to",
        metavar="TARGET",
        help="format: mujoco, mujoco-xml (no callbacks), mujoco-fragment (a joint), sdf, urdf, python, python-msd, "
        "fmu, gains, draws",
    ),
]
ReplayOption = Annotated[
    list[Path] | None,
    options.source_option(
        "--replay", metavar="PATH", help="record for the proof by replay; repeatable; default: the result's own"
    ),
]


OutOption = Annotated[
    Path, options.output_option("--out", metavar="FILE", help="main file; further files are written next to it")
]
NoReplayOption = Annotated[bool, options.source_option("--no-replay", help="write the file without a proof by replay")]
JointOption = Annotated[str, options.model_option("--joint", metavar="NAME", help="name of the joint")]
IntoOption = Annotated[
    Path | None,
    options.model_option(
        "--into", metavar="ROBOT.xml", help="insert the model into a joint of this MuJoCo model; --out is the new file"
    ),
]
FragmentOption = Annotated[
    bool, options.output_option("--fragment", help="of --to mujoco, write only the joint's elements, to paste")
]
MassOption = Annotated[
    float | None, options.model_option("--mass", metavar="KG", help="moving mass, for a result that has only ratios")
]
DrawsOption = Annotated[
    int | None,
    options.output_option("--draws", metavar="N", help="number of parameter sets of --to draws; default: 1000"),
]
StepsOption = Annotated[
    int | None,
    options.output_option(
        "--steps", min=1, max=1000, help="solver steps per sample of the record; default: as many as the replay needs"
    ),
]


@groups.grouped("json", "report", "figures", "quiet", "overwrite")
def export(
    result: options.ResultArgument,
    source: groups.Source,
    to: ToOption,
    out: OutOption,
    replay: ReplayOption = None,
    no_replay: NoReplayOption = False,
    joint: JointOption = "x",
    into: IntoOption = None,
    fragment: FragmentOption = False,
    mass: MassOption = None,
    draws: DrawsOption = None,
    steps: StepsOption = None,
    line: options.LineOption = None,
    *,
    output: results.Output,
) -> int:
    """Export a saved model to MuJoCo, SDF, URDF, Python, FMU, gains or draws, and check it by replay."""
    from msd_ident import export as exports
    from msd_ident.io import read_all
    from msd_ident.report import export as tables

    chosen = exports.chosen(to, into, fragment)
    chosen.check_name(out)
    if no_replay and replay:
        raise UsageError(f"--no-replay with --replay {replay[0]}; expected one of the two: leave --no-replay away")
    saved = saved_model(result, line)
    written, read = (out, *chosen.beside(out)), (result, *(replay or ()), *_own(saved, result), *filter(None, (into,)))
    settings = exports.Options(joint, mass, draws, steps)
    settings.check(chosen)
    json = None if output.json in ("", "-") else Path(output.json)
    results.check_apart([*written, *filter(None, (json, output.report))], read)
    output.check(*read)
    results.check_targets(output.overwrite, *written)
    paths, why = _replayed(saved, result, replay, source, no_replay)
    if not replay and paths:
        source = source.beside(saved.read_with)
    records = [record for path in paths for record in read_all(path, source)]
    found = exports.export(saved, chosen, out, settings, records)
    if why and found.proof is None and found.target.library is not None:
        found = found.unproven(why)
    if output.tables:
        tables.print_export(found, results.console())
    results.write([found.to_json_dict()], output)
    pages.write([(tuple(paths), found)], source, output)
    return 0


def _own(saved: SavedModel, result: Path) -> list[Path]:
    """Places where the records of a result are; none where there are none."""
    return [place for name in _records(saved) for place in _places(name, result)]


def _records(saved: SavedModel) -> list[str]:
    """Records of a result as it names them: ``a.csv + b.csv`` are two, or one with this name."""
    return [saved.path, *saved.path.split(" + ")] if " + " in saved.path else [saved.path]


def _places(record: str, result: Path) -> list[Path]:
    """Where a record is: as the result names it or beside the result, without the name of a run (``log.csv run 2``)
    where there is one.
    """
    names = [name for name in (record, record.rpartition(" run ")[0]) if name]
    try:
        return [place for name in names for place in (Path(name), result.parent / name) if place.exists()]
    except OSError:  # a path that is too long for the disk
        return []


def _replayed(
    saved: SavedModel, result: Path, replay: Sequence[Path] | None, source: SourceOptions, no_replay: bool
) -> tuple[Sequence[Path], str]:
    """Records to replay: those given, or those of the result where they are still there; else why there are none."""
    from msd_ident.io import read_all

    if no_replay:
        return (), "--no-replay"
    if replay:
        return replay, ""
    whole, *parts = (_places(name, result)[:1] for name in _records(saved))
    own = whole or [place for part in parts for place in part]
    if not whole and (not parts or len(own) < len(parts)):
        return (), f"its own record {saved.path} is not here: give --replay PATH"
    try:
        for path in own:
            for record in read_all(path, source.beside(saved.read_with)):
                _check(saved, record)
    except MsdError as error:
        return (), f"its own record cannot be replayed ({error}): give --replay PATH and how to read it"
    return own, ""


def _check(saved: SavedModel, record: Record) -> None:
    """Refuse a record in other units than the result before anything is written."""
    if record.position_unit != saved.position_unit:
        raise UsageError(f"it is read in {record.position_unit}; expected {saved.position_unit}")
