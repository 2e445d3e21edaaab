"""A foreign rig by lot, and its record.

The motion is integrated by LSODA between two commands, as these laws have no jumps that would need an event.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import odeint

from msd_sim import experiments, lottery
from msd_sim.encoder import Encoder, EncoderReader
from msd_sim.errors import RigError
from msd_sim.foreign.law import FloatArray, ForeignLaw, Values
from msd_sim.foreign.sensors import SMOOTH_FORCE
from msd_sim.strengths import Sizes

#: Local error, relative and in parts of the reach (and of the top speed), and the longest step [s].
_RELATIVE, _ABSOLUTE, _LONGEST = 1e-9, 1e-10, 1e-3
#: Its types know one absolute error for all states.
_ODEINT: Any = odeint
#: Sines of a smooth force, its highest frequency in natural frequencies, and its samples in a natural period.
_TONES, _HIGHEST, _SAMPLES = 12, 2.5, 20.0


@dataclass(frozen=True)
class ForeignRig:
    """A plant with one foreign law, and an experiment.

    Attributes:
        seed: what it was drawn from.
        law: what acts beside the plant; ``None`` for nothing.
        values: of the law.
        mass, damping, stiffness: of the plant.
        experiment: its name: ``steps``, ``release`` or ``tones``.
        start: position at the first sample [m].
        time: (n,) stamps [s].
        command_time, command: (p,) stamps [s] and commands [N], held until the next.
        smooth: the force between the samples, where it is not held.
        encoder: what reads the position.
        noise: standard deviation of a reading at rest [m], rounding included.
        reach: static displacement under the largest force [m].
    """

    seed: int
    law: ForeignLaw | None
    values: Values
    mass: float
    damping: float
    stiffness: float
    experiment: str
    start: float
    time: FloatArray
    command_time: FloatArray
    command: FloatArray
    smooth: Callable[[float], float] | None
    encoder: Encoder
    noise: float
    reach: float

    def commanded(self) -> FloatArray:
        """(n,) command at each sample [N]."""
        place = np.searchsorted(self.command_time, self.time + 1e-9, side="right") - 1
        return np.asarray(self.command[np.maximum(place, 0)])


@dataclass(frozen=True)
class Moved:
    """(n,) true position [m], velocity [m/s], and readings [m]."""

    position: FloatArray
    velocity: FloatArray
    reading: FloatArray


def draw(seed: int, law: ForeignLaw | None, experiment: str = "steps") -> ForeignRig:
    """A rig by lot; plants, forces and encoders as in ``lottery``.

    Raises:
        RigError: an experiment in which the law does not show.
    """
    if law is not None and experiment not in law.experiments:
        raise RigError(f"{law.name} in {experiment}; expected one of {', '.join(law.experiments)}")
    tones = experiment == "tones"
    rng, rate = np.random.default_rng([seed, 31337]), 1000.0
    sizes, damping, how = lottery.begun(rng, "sweep" if tones else experiment, rate)
    values = {} if law is None else law.strengths(sizes)
    encoder, level = lottery.drawn_encoder(rng, sizes.reach)
    if law is not None and law.encoder is not None:
        more = law.encoder(sizes, encoder["noise"] or level)
        level = math.hypot(level, more.get("noise", 0.0)) if not encoder["noise"] else level
        encoder |= more
    smooth = None
    if tones:
        rate, smooth = sizes.omega / (2.0 * math.pi) * _SAMPLES, _tones(sizes)
        time = np.arange(round(sizes.duration * rate)) / rate
        command_time, command = time, np.array([smooth(t) for t in time.tolist()])
    else:
        options = {key: value for key, value in how.items() if key != "name"}
        made = experiments.build(experiment, options, {"rate": rate, "natural_frequency": sizes.omega})
        time = np.arange(round(made.duration * rate)) / rate
        command_time, command = made.force_time, made.force
    return ForeignRig(
        seed, law, values, sizes.mass, damping, sizes.stiffness, experiment, float(how.get("position", 0.0)), time,
        command_time, command, smooth, Encoder(**encoder), level, sizes.reach,
    )  # fmt: skip


def _tones(s: Sizes) -> Callable[[float], float]:
    """A force of many sines; 0 at the start."""
    turns = s.omega * s.rng.uniform(0.1, _HIGHEST, _TONES)
    sizes = 0.6 * s.force / math.sqrt(_TONES) * s.rng.uniform(0.5, 1.5, _TONES)
    return lambda t: float(sizes @ np.sin(turns * t))


def simulate(rig: ForeignRig) -> Moved:
    """Run the experiment."""
    motion = _motion(rig)
    position, velocity = motion[:, 0], motion[:, 1]
    seen = position
    if rig.law is not None and rig.law.reading is not None:
        seen = rig.law.reading(rig.values, rig.time, position, velocity, np.random.default_rng([rig.seed, 5]))
    return Moved(position, velocity, EncoderReader(rig.encoder, rig.seed).read(seen, velocity))


def _motion(rig: ForeignRig) -> FloatArray:
    """(n, 2 + states) of the motion at the samples."""
    law = rig.law
    states = law.states if law is not None else 0
    y = np.zeros(2 + states)
    y[0] = rig.start
    if law is not None and law.hangs:
        y[2] = rig.start
    scale = np.full(2 + states, rig.reach)
    scale[1] *= math.sqrt(rig.stiffness / rig.mass)
    found = np.empty((rig.time.size, 2 + states))
    made = rig.command
    if law is not None and law.commands is not None:
        made = law.commands(rig.values, made)
    edges = [0.0] if rig.smooth is not None else rig.command_time.tolist()
    for start, end, command in zip(edges, [*edges[1:], math.inf], made.tolist(), strict=False):
        inside = np.flatnonzero((rig.time >= start - 1e-9) & (rig.time < end - 1e-9))
        last = float(rig.time[inside[-1]]) if math.isinf(end) else end
        at = np.unique(np.concatenate([[start], rig.time[inside[1:]], [last]]))
        if at.size == 1:  # the last command comes with the last sample
            found[inside] = y
            break
        path, said = _ODEINT(
            _slope(rig, command), y, at, tfirst=True, rtol=_RELATIVE, atol=_ABSOLUTE * scale, hmax=_LONGEST,
            mxstep=100_000, full_output=True,
        )  # fmt: skip
        if said["message"] != "Integration successful." or not np.isfinite(path).all():
            raise RigError(f"the rig of seed {rig.seed} runs away: {said['message']}")
        found[inside] = path[: inside.size]
        y = path[-1]
    return found


def _slope(rig: ForeignRig, held: float) -> Callable[[float, FloatArray], Sequence[float]]:
    """Time derivative of (x, v, inner states) under a held command, or under the smooth one."""
    law, values, smooth = rig.law, rig.values, rig.smooth
    force, rates = (law.force, law.rates) if law is not None else (None, None)
    mass, damping, stiffness = rig.mass, rig.damping, rig.stiffness

    def slope(t: float, y: FloatArray) -> Sequence[float]:
        x, v, *z = y.tolist()
        u = held if smooth is None else smooth(t)
        left = force(values, t, x, v, z, u) if force is not None else 0.0
        inner = rates(values, t, x, v, z, u) if rates is not None else ()
        return (v, (u - damping * v - stiffness * x - left) / mass, *inner)

    return slope


__all__ = ["SMOOTH_FORCE", "ForeignRig", "Moved", "draw", "simulate"]
