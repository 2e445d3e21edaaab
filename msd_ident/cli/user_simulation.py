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
    """Simulated positions of a file: the first reading that works, with the record's options or with none."""
    from dataclasses import replace

    from msd_ident.errors import DataError
    from msd_ident.external import TableSimulation
    from msd_ident.io import SourceOptions, read

    plain = SourceOptions(force="none", position_unit=source.as_position[0])
    try:
        found = read(path, plain)
    except (DataError, UsageError):
        found = read(path, replace(source, force="none"))
    return TableSimulation(str(path), found.time, found.position)


def compare(data: solving.Data, chosen: Chosen, require: float | None, output: results.Output) -> int:
    """Compare every path, or all together, with the simulation.

    Returns:
        The exit code; 1 if the simulation explains less of the motion [%] than required.
    """
    from msd_ident import external
    from msd_ident.report.external import print_comparison

    simulation = chosen.simulation(data.source)

    def solve(records: Sequence[Record], report: progress.Progress) -> Comparison:
        return external.compare(simulation, records, report)

    code, found = solving.work(data, output, solve, print_comparison)
    return code or (0 if require is None or all(one.explained_percent >= require for one in found) else 1)
