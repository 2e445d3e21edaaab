"""Other people's simulations: a MuJoCo model, a Python function, or positions in a file."""

from __future__ import annotations

import importlib
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError, UsageError
from msd_ident.estimate import Initial
from msd_ident.export import mujoco_replay, robot


class Simulation(Protocol):
    """What turns a record's force into positions."""

    @property
    def name(self) -> str:
        """For sentences and tables."""

    def check(self, record: Record) -> None:
        """Refuse a record that it cannot be run on, before any work."""

    def how(self, record: Record) -> str:
        """How it is run on a record, a sentence."""

    def positions(self, record: Record, initial: Initial) -> FloatArray:
        """Simulated readings (n,) at the record's samples, in the position unit.

        Args:
            record: gives stamps and force.
            initial: state and zero at the first sample, as fitted to the rig. A simulation may start elsewhere.
        """


@dataclass(frozen=True)
class MujocoSimulation:
    """One joint of a MuJoCo model.

    Attributes:
        path: the model.
        joint: name of the joint.
    """

    path: Path
    joint: str

    @property
    def name(self) -> str:
        """Name for sentences and tables."""
        return f"{self.path.name}, joint {self.joint}"

    def check(self, record: Record) -> None:
        """Raises UsageError or DataError: no such model or joint, further degrees of freedom, another unit."""
        robot.joint(robot.parsed(self.path), self.path, self.joint, record.position_unit)
        mujoco_replay.load(self.path)

    def how(self, record: Record) -> str:
        """Where the force acts, and the time step."""
        mujoco, model = mujoco_replay.library(), mujoco_replay.load(self.path)
        pusher = _pusher(mujoco, model, model.joint(self.joint).id)
        through = "directly on the joint" if pusher is None else f"through the actuator {model.actuator(pusher).name!r}"
        own, used = model.opt.timestep, record.period / _steps(model, record)
        step = f"steps of {1e3 * used:.4g} ms" + ("" if math.isclose(own, used) else f", not {1e3 * own:.4g} ms")
        return f"The record's force acted {through}, in {step}, from the state that the record begins with."

    def positions(self, record: Record, initial: Initial) -> FloatArray:
        """Simulated readings (n,) at the record's samples, in the position unit."""
        mujoco, model = mujoco_replay.library(), mujoco_replay.load(self.path)
        steps = _steps(model, record)
        model.opt.timestep = record.period / steps
        data = mujoco.MjData(model)
        joint = model.joint(self.joint)
        place, dof = joint.qposadr[0], joint.dofadr[0]
        data.time = float(record.time[0]) - record.origin
        data.qpos[place], data.qvel[dof] = initial.position + initial.zero, initial.velocity
        pusher = _pusher(mujoco, model, joint.id)
        force = mujoco_replay.averages(record, steps)
        with mujoco_replay.quiet():
            out = _stepped(mujoco, model, data, (place, dof, pusher), force)
        return mujoco_replay.at_samples(record, _finite(out, self.name))


def _steps(model: Any, record: Record) -> int:
    """Steps of the model in one of the record."""
    return max(math.ceil(record.period / float(model.opt.timestep) - 1e-6), 1)


def _stepped(mujoco: Any, model: Any, data: Any, at: tuple[int, int, int | None], force: FloatArray) -> FloatArray:
    """Joint positions after each row of forces, from the state given on; ``at``: position, freedom and actuator."""
    place, dof, pusher = at
    out = np.empty(force.shape[0] + 1)
    out[0] = data.qpos[place]
    for i, row in enumerate(force):
        for value in row:
            if pusher is None:
                data.qfrc_applied[dof] = value
            else:
                data.ctrl[pusher] = value
            mujoco.mj_step(model, data)
        out[i + 1] = data.qpos[place]
    return out


def _pusher(mujoco: Any, model: Any, joint: int) -> int | None:
    """The actuator that turns a control into a force on the joint; without just one, forces are applied directly."""
    on_joint = [
        i
        for i in range(model.nu)
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT and model.actuator_trnid[i, 0] == joint
        and model.actuator_biastype[i] == mujoco.mjtBias.mjBIAS_NONE
        and model.actuator_gaintype[i] == mujoco.mjtGain.mjGAIN_FIXED
    ]  # fmt: skip
    return on_joint[0] if len(on_joint) == 1 else None


@dataclass(frozen=True)
class FunctionSimulation:
    """A Python function ``simulate(time, force, position, velocity)`` that returns positions.

    ``time`` (n,) [s] is the record's, with its gaps; ``force`` (n,) has one value for each of these instants, the mean
    until the next one, and the last is that at the last instant. ``position`` and ``velocity`` are those at the first
    sample. It returns (n,) readings.

    Attributes:
        name: ``module:function``; the module may lie in the present folder.
    """

    name: str

    def check(self, record: Record) -> None:
        """Raises UsageError: there is no such function."""
        self._function()

    def how(self, record: Record) -> str:
        """What it was called with."""
        return f"{self.name} was called with time and force of the record, and with the state at its first sample."

    def _function(self) -> Any:
        module, _, function = self.name.partition(":")
        if not module or not function:
            raise UsageError(f"--callable {self.name}; expected module:function, e.g. --callable my_rig:simulate")
        here = str(Path.cwd())
        if here not in sys.path:
            sys.path.insert(0, here)
        try:
            found = getattr(importlib.import_module(module), function, None)
        except ImportError as error:
            raise UsageError(f"cannot import {module} ({error}); expected a module here or installed") from None
        except (Exception, SystemExit) as error:
            raise UsageError(f"importing {module} {_failed(error)}; expected a module that can be imported") from None
        if not callable(found):
            raise UsageError(f"module {module} has no function {function}; expected module:function that it has")
        return found

    def positions(self, record: Record, initial: Initial) -> FloatArray:
        """Simulated readings (n,) at the record's samples, in the position unit."""
        function = self._function()
        time = record.time.copy()
        means = np.diff(mujoco_replay.impulses(record, time)) / np.diff(time)
        force = np.append(means, record.force_at(time[-1:]))
        try:
            given = function(time, force, initial.position + initial.zero, initial.velocity)
            made = np.asarray(given, dtype=np.float64)
        except (Exception, SystemExit) as error:
            raise DataError(
                f"{self.name} {_failed(error, f' on {record.name}')}; expected positions: call it with (time, force, "
                "position, velocity) by itself"
            ) from None
        if made.shape != time.shape:
            raise DataError(f"{self.name} returned shape {made.shape}; expected {time.shape}, a position a sample")
        return _finite(made, self.name)


@dataclass(frozen=True)
class TableSimulation:
    """Positions that were simulated elsewhere.

    Attributes:
        name: of the file.
        time: (m,) [s] on the record's clock.
        position: (m,) in the position unit.
        unit: position unit that the file names; empty where it names none.
    """

    name: str
    time: FloatArray
    position: FloatArray
    unit: str = ""

    def check(self, record: Record) -> None:
        """Raises DataError: it is in another unit, ends before the record does, or begins after it."""
        if self.unit and self.unit != record.position_unit:
            raise DataError(
                f"{self.name} is in {self.unit}, and {record.name} in {record.position_unit}; expected one unit: "
                "name it in the headings, or give --position-unit for the record"
            )
        first, last = float(self.time[0]), float(self.time[-1])
        slack = 1.5 * record.period
        if first > record.time[0] + slack or last < record.time[-1] - slack:
            raise DataError(
                f"{self.name} goes from {first:.4g} to {last:.4g} s, and {record.name} from {record.time[0]:.4g} to "
                f"{record.time[-1]:.4g} s; expected a simulation of all of it: simulate longer, or cut the record "
                "with --start and --end"
            )

    def how(self, record: Record) -> str:
        """That nothing was run."""
        return f"The simulated positions are those of {self.name}, on the record's clock."

    def positions(self, record: Record, initial: Initial) -> FloatArray:
        """Simulated readings (n,) at the record's samples, in the position unit."""
        del initial
        return np.asarray(np.interp(record.time, self.time, self.position), dtype=np.float64)


def _failed(error: BaseException, where: str = "") -> str:
    """What somebody's code did, as part of a sentence."""
    if isinstance(error, SystemExit):
        return f"ended the process{where} (SystemExit {error.code})"
    return f"failed{where} with {type(error).__name__} ({error})"


def _finite(positions: FloatArray, name: str) -> FloatArray:
    if not np.all(np.isfinite(positions)) or float(np.max(np.abs(positions))) > 1e12:
        raise DataError(f"the simulation {name} blows up; expected positions that stay finite: make its step smaller")
    return positions
