"""A rig in MuJoCo, and its record as a CSV file.

MuJoCo solves dry friction and limits as constraints. Frictionloss becomes dry friction when its reference velocity
decays at once: ``solreffriction`` with a damping near the end of stability of the integrator, an impedance near 1, and
a solver step far below the record's. ``refsafe`` is off, as both constraints state their own stiffness and damping.
A constraint that sets in between two steps of the solver makes an error of first order, so steps are halved until
half of them give the same record.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.mujoco_rigs.rig import Rig

FloatArray = npt.NDArray[np.float64]

#: Solver steps a sample: at least, and at most.
STEPS, MOST_STEPS = 20, 320
#: Largest rms difference of two runs, one with half the steps of the other, in noise levels.
SAME = 0.1
#: Damping of the friction constraint in 1/step: RK4 is stable up to 2.78.
_SLIP = 2.0
#: Impedance of the friction constraint: what holds at rest lets this much less than 1 through.
_HOLDS = 0.9999

_MODEL = """<mujoco model="rig">
  <option timestep="{step!r}" integrator="RK4" gravity="0 0 0" solver="Newton" iterations="100" tolerance="1e-14">
    <flag contact="disable" refsafe="disable"/>
  </option>
  <worldbody>
    <body name="slider">
      <joint name="slide" type="slide" axis="1 0 0" armature="{armature!r}" damping="{damping!r}"
        stiffness="{stiffness!r}" {constraints}/>
      <inertial pos="0 0 0" mass="{mass!r}" diaginertia="1e-3 1e-3 1e-3"/>
    </body>
  </worldbody>
  <actuator>
    <general name="drive" joint="slide" {drive}/>
  </actuator>
</mujoco>
"""


def model(rig: Rig, steps: int = STEPS) -> str:
    """The rig as MJCF, with ``steps`` solver steps a sample."""
    step = 1.0 / (rig.rate * steps)
    return _MODEL.format(
        step=step, armature=rig.armature, damping=rig.damping, stiffness=rig.stiffness, mass=rig.mass,
        constraints=_constraints(rig, step), drive=_drive(rig),
    )  # fmt: skip


def _constraints(rig: Rig, step: float) -> str:
    found = ""
    if rig.frictionloss:
        found += (
            f'frictionloss="{rig.frictionloss!r}" solreffriction="-1 {-_SLIP / step!r}" '
            f'solimpfriction="{_HOLDS} {_HOLDS} 0.001 0.5 2" '
        )
    if rig.limit:
        near, deep = rig.limit.impedance
        found += (
            f'limited="true" range="{rig.limit.low!r} {rig.limit.high!r}" '
            f'solreflimit="{-rig.limit.stiffness!r} {-rig.limit.damping!r}" '
            f'solimplimit="{near!r} {deep!r} {rig.limit.width!r} 0.5 2" '
        )
    return found


def _drive(rig: Rig) -> str:
    found = f'gainprm="{rig.gain!r}" '
    if rig.dead_zone:
        found += 'gaintype="user" '
    if rig.lag:
        found += f'dyntype="filter" dynprm="{rig.lag!r}" '
    if math.isfinite(rig.saturation):
        found += f'ctrllimited="true" ctrlrange="{-rig.saturation!r} {rig.saturation!r}" '
    return found


def positions(rig: Rig) -> FloatArray:
    """Where the joint is at each sample [m]: with so many solver steps that twice as many change nothing."""
    steps, found = STEPS, stepped(rig, STEPS)
    while rig.limit or rig.frictionloss:
        steps, coarse = 2 * steps, found
        found = stepped(rig, steps)
        if steps >= MOST_STEPS or float(np.std(found - coarse)) <= SAME * rig.noise_level:
            break
    return found


def stepped(rig: Rig, steps: int) -> FloatArray:
    """Where the joint is at each sample [m], with ``steps`` solver steps a sample."""
    import mujoco

    compiled = mujoco.MjModel.from_xml_string(model(rig, steps))
    data = mujoco.MjData(compiled)
    data.qpos[0] = rig.start
    found = np.empty(len(rig.commands))
    mujoco.set_mjcb_act_gain(_gain(rig) if rig.dead_zone else None)
    try:
        for i, command in enumerate(rig.commands):
            found[i] = data.qpos[0]
            data.ctrl[0] = command
            mujoco.mj_step(compiled, data, steps)
    finally:
        mujoco.set_mjcb_act_gain(None)
    if not np.isfinite(found).all():
        raise ValueError(f"the rig of seed {rig.seed} blows up in MuJoCo")
    return found


def _gain(rig: Rig) -> Any:
    """The gain at which a command less its dead zone stands in place of the command."""

    def gain(compiled: Any, data: Any, number: int) -> float:
        command = abs(float(data.ctrl[number]))
        return rig.gain * (command - rig.dead_zone) / command if command > rig.dead_zone else 0.0

    return gain


def read(rig: Rig, exact: FloatArray) -> FloatArray:
    """What the encoder says of exact positions [m]."""
    rng = np.random.default_rng([rig.seed, 4711])
    seen = exact + rig.noise * rng.standard_normal(exact.size)
    return np.asarray(np.round(seen / rig.count) * rig.count if rig.count else seen)


def write(rig: Rig, path: Path) -> None:
    """The record as a lab would have it: time, command and reading of each sample."""
    exact = positions(rig)
    table = np.stack([np.arange(exact.size) / rig.rate, rig.commands, read(rig, exact)], axis=1)
    np.savetxt(path, table, delimiter=",", header="time_s,force_n,position_m", comments="", fmt="%.12g")
