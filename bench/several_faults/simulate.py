"""Simulates a rig with several faults and writes its record."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
from numba import njit
from scipy.signal import lfilter

from bench.several_faults.rig import Law, Rig, draw

#: Runge-Kutta steps of a sample.
STEPS = 30


@njit
def _rates(time: float, state: np.ndarray, force: float, law: Law, rates: np.ndarray) -> None:  # pragma: no cover
    """Time derivative of position, velocity, and those of the second mass."""
    x, v = state[0], state[1]
    stretched = x - min(max(x, -law.gap), law.gap)
    beyond = x - min(max(x, -law.stop), law.stop)
    drop = 1.0 + (law.peak - 1.0) * math.exp(-((v / (40.0 * law.creep)) ** 2))
    rough = max(1.0 + law.bump * math.sin(2.0 * math.pi * x / law.pitch) + law.wear * x, 0.0)
    force -= law.offset + (law.damping + law.one_way * np.sign(v)) * v + law.drag * abs(v) * v
    force -= law.stiffness * (1.0 + law.aging * time) * stretched + law.square * x * x + law.cubic * x**3
    force -= law.stop_stiffness * beyond + law.friction * rough * drop * math.tanh(v / law.creep)
    force -= law.ripple * math.sin(2.0 * math.pi * x / law.pitch + law.ripple_phase)
    force += law.tone * math.sin(law.tone_frequency * time)
    rates[0], rates[2], rates[3] = v, 0.0, 0.0
    if law.second_mass > 0.0:
        joint = law.second_stiffness * (x - state[2]) + law.second_damping * (v - state[3])
        force -= joint
        rates[2], rates[3] = state[3], joint / law.second_mass
    rates[1] = force / law.mass


@njit
def _positions(forces: np.ndarray, step: float, law: Law) -> np.ndarray:  # pragma: no cover
    """Position at each sample [m] of a cart that starts at rest, by the classical Runge-Kutta rule.

    ``forces`` has one force a step [N].
    """
    found = np.empty(forces.size // STEPS)
    state, slopes = np.zeros(4), np.zeros((4, 4))
    for index in range(found.size):
        found[index] = state[0]
        for inner in range(STEPS):
            force, time = forces[index * STEPS + inner], (index * STEPS + inner) * step
            _rates(time, state, force, law, slopes[0])
            _rates(time + 0.5 * step, state + 0.5 * step * slopes[0], force, law, slopes[1])
            _rates(time + 0.5 * step, state + 0.5 * step * slopes[1], force, law, slopes[2])
            _rates(time + step, state + step * slopes[2], force, law, slopes[3])
            state += step * (slopes[0] + 2.0 * slopes[1] + 2.0 * slopes[2] + slopes[3]) / 6.0
    return found


def _driven(rig: Rig) -> np.ndarray:
    """Force of the drive in each step [N]: its gain, its delay, its lag."""
    step = 1.0 / (rig.rate * STEPS)
    made = np.repeat(rig.commands * (1.0 + rig.value("gain_slope") * np.abs(rig.commands) / rig.size), STEPS)
    late = round(rig.value("delay") / step)
    made = np.concatenate([np.zeros(late), made[: made.size - late]])
    if not rig.value("lag"):
        return made
    kept = math.exp(-step / rig.value("lag"))
    return np.asarray(lfilter([0.0, 1.0 - kept], [1.0, -kept], made))


class RunsAway(Exception):
    """The motion of a rig does not stay finite: its springs push it on."""


def drawn(seed: int, experiment: str) -> Rig:
    """The first of a seed's rigs whose motion stays finite."""
    for turn in count():
        rig = draw(seed, experiment, turn)
        try:
            readings(rig)
        except RunsAway:
            continue
        return rig
    raise AssertionError


def readings(rig: Rig) -> np.ndarray:
    """What the encoder reads at each sample [m]."""
    exact = _positions(_driven(rig), 1.0 / (rig.rate * STEPS), rig.law)
    if not np.isfinite(exact).all():
        raise RunsAway(f"rig {rig.seed} ({', '.join(rig.faults)}) runs away; expected a motion that stays finite")
    time = np.arange(exact.size) / rig.rate
    shown = exact + rig.value("bend") * exact**2 + rig.value("bow") * exact**3 + rig.value("drift") * time
    shown += np.random.default_rng([rig.seed, 48]).normal(size=exact.size) * rig.noise
    return np.asarray(np.round(shown / rig.count) * rig.count if rig.count > 0.0 else shown)


def write(rig: Rig, path: Path) -> None:
    """Time, command and reading of each sample as CSV."""
    columns = np.stack([np.arange(rig.commands.size) / rig.rate, rig.commands, readings(rig)], axis=1)
    np.savetxt(path, columns, delimiter=",", header="time_s,force_n,position_m", comments="", fmt="%.12g")


def change(rig: Rig, other: Rig) -> float:
    """How much the readings of two rigs differ, as rms in noise levels of the first."""
    return _differ(_noiseless(rig), other, rig.noise_level)


def _noiseless(rig: Rig) -> np.ndarray:
    return readings(replace(rig, noise=0.0, count=0.0))


def _differ(read: np.ndarray, other: Rig, level: float) -> float:
    """Rms of a noiseless reading (n,) [m] against that of another rig, in levels [m]."""
    return float(np.sqrt(np.mean((read - _noiseless(other)) ** 2)) / level)


def changes(rig: Rig) -> dict[str, float]:
    """How much the readings change without each fault (``change``); nothing is refitted."""
    read = _noiseless(rig)
    return {fault: _differ(read, rig.without(fault), rig.noise_level) for fault in rig.faults}
