"""A MuJoCo model run on a record: the force on its actuator, the joint's position read at the record's samples."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError, SetupError
from msd_ident.export.mujoco_elements import ACTUATOR, SECOND, SENSOR
from msd_ident.export.plan import Plan
from msd_ident.export.target import InitialState
from msd_ident.model.effects.law import DELAY, LAG


def library() -> Any:
    """MuJoCo's Python package.

    Raises:
        SetupError: it is not installed.
    """
    try:
        import mujoco
    except ImportError:
        raise SetupError("MuJoCo is not installed; expected its Python package: pip install 'mujoco>=4.0'") from None
    return mujoco


@contextmanager
def quiet() -> Iterator[None]:
    """No warnings of MuJoCo on the terminal or in a log file: a model that diverges is reported anyway."""
    mujoco = library()
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def load(path: Path) -> Any:
    """A model from a file.

    Raises:
        DataError: MuJoCo refuses it.
        SetupError: MuJoCo is not installed.
    """
    mujoco = library()
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        why = " ".join(str(error).split())[:200]
        raise DataError(f"MuJoCo cannot load {path}: {why}; expected a model that it loads") from None


def run(path: Path, callback: Path | None, plan: Plan, start: InitialState) -> FloatArray:
    """Readings (n,) of an exported MuJoCo model at the record's samples.

    Args:
        path: of the model.
        callback: file with its callbacks; None without.
        plan: what was exported.
        start: record, and state at its first sample.
    """
    mujoco, model = library(), load(path)
    model.opt.timestep = start.record.period / plan.steps
    data = mujoco.MjData(model)
    _begin(mujoco, model, data, plan, start)
    force = plan.force_scale * plan.saved.force_sign * averages(start.record, plan.steps)
    with quiet(), _installed(callback, model):
        return at_samples(start.record, _stepped(mujoco, model, data, force, plan))


def averages(record: Record, steps: int) -> FloatArray:
    """Mean force of each solver step, which keeps the impulse of the force whatever its stamps are.

    Args:
        record: the measurement.
        steps: solver steps in each sample period.

    Returns:
        (periods, steps), in the force unit. The periods are even and cover the record, even if its samples are uneven.
    """
    periods = round(record.duration / record.period)
    periods += periods * record.period < record.duration - 1e-3 * record.period
    edges = record.time[0] + record.period / steps * np.arange(periods * steps + 1)
    impulse = impulses(record, edges)
    return np.asarray(np.diff(impulse).reshape(periods, steps) * (steps / record.period))


def at_samples(record: Record, positions: FloatArray) -> FloatArray:
    """Positions (n,) at the record's samples, by a cubic spline where these are uneven.

    Args:
        record: gives the stamps.
        positions: (periods + 1,) at even periods from the record's first sample on.

    Returns:
        NaN at all samples if the samples are uneven and a position is not finite.
    """
    even = record.time[0] + record.period * np.arange(positions.size)
    if positions.size == record.samples and float(np.max(np.abs(even - record.time))) < 1e-3 * record.period:
        return positions
    from scipy.interpolate import CubicSpline

    good = np.isfinite(positions)
    if not good.all():
        return np.full(record.samples, np.nan)
    return np.asarray(CubicSpline(even, positions)(record.time), dtype=np.float64)


def impulses(record: Record, at: FloatArray) -> FloatArray:
    """Integral of the force (n,) [N·s] from its first stamp on; 0 before it.

    Args:
        record: the measurement.
        at: (n,) instants [s].
    """
    stamps, values = record.force_time, record.force
    linear = record.hold == "linear"
    means = 0.5 * (values[1:] + values[:-1]) if linear else values[:-1]
    whole = np.concatenate([[0.0], np.cumsum(means * np.diff(stamps))])
    place = np.clip(np.searchsorted(stamps, at, side="right") - 1, 0, stamps.size - 1)
    since = np.maximum(at - stamps[place], 0.0)
    here = values[place]
    if linear and stamps.size > 1:
        slopes = np.concatenate([np.diff(values) / np.diff(stamps), [0.0]])
        return np.asarray(whole[place] + since * (here + 0.5 * slopes[place] * since))
    return np.asarray(whole[place] + since * here)


def _begin(mujoco: Any, model: Any, data: Any, plan: Plan, start: InitialState) -> None:
    """The state at the record's first sample: joint, second mass, what the actuator has filtered and delays."""
    record, initial = start.record, start.initial
    data.time = float(record.time[0])
    joint = model.joint(plan.joint)
    data.qpos[joint.qposadr[0]] = initial.position + plan.zero
    data.qvel[joint.dofadr[0]] = initial.velocity
    if any(model.joint(i).name == SECOND for i in range(model.njnt)):
        data.qpos[model.joint(SECOND).qposadr[0]] = 0.0
    number = model.actuator(ACTUATOR).id
    if model.actuator_actadr[number] >= 0:
        data.act[model.actuator_actadr[number]] = plan.saved.force_sign * lagged(record, plan)
    samples = int(model.actuator_history[number, 0]) if model.nhistory else 0
    if samples:
        step = model.opt.timestep
        times = float(record.time[0]) + step * np.arange(-samples, 0.0)
        before = plan.force_scale * plan.saved.force_sign * record.force_at(times + 0.5 * step)
        mujoco.mj_initCtrlHistory(model, data, number, times.reshape(-1, 1), before.reshape(-1, 1))


def lagged(record: Record, plan: Plan) -> float:
    """Force [N] behind the actuator's lag at the first sample, computed from the force before it.

    A first stamp before the record is taken for a force that has acted for long. Without one the force is 0.

    Args:
        record: gives the force, in its own unit and with the sign of the model.
        plan: its scale makes newtons of that unit, its model gives lag, delay and gain of the actuator.
    """
    tau, shift = (sum(plan.model.structure(role)) for role in (LAG, DELAY))
    begin = float(record.time[0])
    stamps = record.force_time + shift
    if tau <= 0.0 or stamps[0] >= begin:
        return 0.0
    levels = np.array([_mapped(plan, value) for value in plan.force_scale * record.force])
    force = float(levels[0])
    for i in np.flatnonzero(stamps < begin):
        end = min(begin, float(stamps[i + 1])) if i + 1 < stamps.size else begin
        force = float(levels[i]) + (force - float(levels[i])) * math.exp(-(end - float(stamps[i])) / tau)
    return force


def _mapped(plan: Plan, force: float) -> float:
    """What the actuator makes of a command [N]."""
    for effect in plan.model.effects:
        force = effect.pushes(force)
    return force


def _stepped(mujoco: Any, model: Any, data: Any, force: FloatArray, plan: Plan) -> FloatArray:
    """Readings after each step of the record; NaN from where the motion leaves all bounds."""
    number, place, steps = model.actuator(ACTUATOR).id, model.joint(plan.joint).qposadr[0], plan.steps
    sensor = any(model.sensor(i).name == SENSOR for i in range(model.nsensor))
    read = model.sensor(SENSOR).adr[0] if sensor else 0
    out = np.full(force.shape[0] + 1, np.nan)
    mujoco.mj_forward(model, data)
    out[0] = data.sensordata[read] if sensor else data.qpos[place]
    even = bool(np.all(np.ptp(force, axis=1) == 0.0))
    for i, row in enumerate(force):
        try:
            for value in row[:1] if even else row:
                data.ctrl[number] = value
                mujoco.mj_step(model, data, steps if even else 1)
            if sensor:
                mujoco.mj_forward(model, data)
        except (ArithmeticError, ValueError):
            break  # a law of the callback file was asked for what no motion reaches
        if not np.isfinite(data.qpos[place]) or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            break
        out[i + 1] = data.sensordata[read] if sensor else data.qpos[place]
    return out


@contextmanager
def _installed(callback: Path | None, model: Any) -> Iterator[None]:
    """The callbacks of a generated file while a model runs."""
    if callback is None:
        yield
        return
    module = imported(callback)
    module.install(model)
    try:
        yield
    finally:
        module.remove()


def imported(path: Path) -> ModuleType:
    """A generated file as a module, whatever folder it lies in."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
