"""``msd validate`` with a user's own simulation: a MuJoCo model, a Python function, or simulated positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.cli import progress, results, solving
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.external import Comparison, Simulation
    from msd_ident.io import SourceOptions

#: How near to a power of 1000 the spans of two positions must be, in such powers, to suggest a wrong unit: 40 %.
NEAR = 0.05


@dataclass(frozen=True)
class Chosen:
    """What is to be compared: one of a model with its joint, a function, a file.

    Raises:
        UsageError: none or several of them, or a model without a joint.
    """

    mujoco: Path | None
    joint: str
    function: str
    simulated: Path | None

    def __post_init__(self) -> None:
        given = [self.mujoco is not None, bool(self.function), self.simulated is not None]
        if sum(given) != 1:
            raise UsageError("several of --mujoco, --callable and --simulated; expected one simulation at a time")
        if self.mujoco is not None and not self.joint:
            raise UsageError("--mujoco without --joint; expected the joint that the record is of: --joint NAME")

    def simulation(self, source: SourceOptions) -> Simulation:
        """The simulation.

        Raises:
            DataError, UsageError: the file of positions cannot be read.
        """
        from msd_ident import external

        if self.mujoco is not None:
            return external.MujocoSimulation(self.mujoco, self.joint)
        if self.function:
            return external.FunctionSimulation(self.function)
        assert self.simulated is not None
        return table(self.simulated, source)


def table(path: Path, source: SourceOptions) -> Simulation:
    """Simulated positions of a file: the first reading that works, with the default columns or with the record's.

    Scales and units are those of the record's options, where the file's own headings name none.
    """
    from dataclasses import replace

    from msd_ident.errors import DataError
    from msd_ident.external import TableSimulation
    from msd_ident.io import SourceOptions, read

    scales = {name: getattr(source, name) for name in ("position_scale", "position_unit", "time_scale")}
    try:
        options, unit = _by_headings(path, SourceOptions(force="none", **scales))
        found = read(path, options)
    except (DataError, UsageError):
        options, unit = _by_headings(path, replace(source, force="none"))
        found = read(path, options)
    return TableSimulation(str(path), found.time, found.position, unit)


def _by_headings(path: Path, options: SourceOptions) -> tuple[SourceOptions, str]:
    """The options without those scales that the headings of the file's own columns tell, and the position's unit that
    they tell; empty for none.

    A heading in counts tells none: what a count is, the options say.
    """
    from dataclasses import replace

    from msd_ident.io import runs, units
    from msd_ident.io.bag import is_bag
    from msd_ident.io.columns import open_columns
    from msd_ident.io.csv_file import choose_columns

    if is_bag(path):
        return options, ""
    columns = runs.select(open_columns(path), options.run, str(path))
    chosen = choose_columns(columns, str(path), options)
    own, _ = units.POSITION.known.get(units.unit(columns.header[chosen.position])[0], ("", 1.0))
    told = own if own in units.POSITION.plain else ""
    if told:
        options = replace(options, position_scale=None, position_unit=options.as_position[0])
    if chosen.time is not None and units.time_factor(columns.header[chosen.time]) is not None:
        options = replace(options, time_scale=None)
    return options, told


def _doubted(record: Record, simulation: Simulation) -> Record:
    """The record, with a note where the simulated positions of a file look as if they were in other units."""
    import math
    from dataclasses import replace

    import numpy as np

    from msd_ident.external import TableSimulation

    if not isinstance(simulation, TableSimulation):
        return record
    inside = (simulation.time >= record.time[0]) & (simulation.time <= record.time[-1])
    theirs = float(np.ptp(simulation.position[inside])) if np.any(inside) else 0.0
    if theirs == 0.0:
        return record
    powers = math.log10(theirs / float(np.ptp(record.position))) / 3.0
    if round(powers) == 0 or abs(powers - round(powers)) > NEAR:
        return record
    said = (
        f"The positions of {simulation.name} span {theirs:.3g} {record.position_unit}, those of {record.name} "
        f"{float(np.ptp(record.position)):.3g} {record.position_unit}: is a unit wrong by a factor of 1000? Name the "
        "unit in the heading of each file, such as position_mm; where a heading names none, --position-unit and "
        "--position-scale hold for both."
    )
    return replace(record, notes=(*record.notes, said))


def compare(data: solving.Data, chosen: Chosen, require: float | None, output: results.Output) -> int:
    """Compare every path, or all together, with the simulation.

    Returns:
        The exit code; 1 if the simulation explains less of the motion [%] than required.

    Raises:
        UsageError: a demand that is no percentage.
        DataError: the simulated positions cannot be read.
    """
    from msd_ident import external
    from msd_ident.report.external import print_comparison
    from msd_ident.workflow import validation

    validation.Options(require=require)  # refuses a demand that is no percentage
    simulation = chosen.simulation(data.source)

    def solve(records: Sequence[Record], report: progress.Progress) -> Comparison:
        return external.compare(simulation, [_doubted(one, simulation) for one in records], report)

    code, found = solving.work(data, output, solve, print_comparison)
    return code or (0 if require is None or all(one.explained_percent >= require for one in found) else 1)
