"""Forces along the way and in time, and second masses, in other forms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from msd_sim.foreign.law import FloatArray, ForeignLaw, Values
from msd_sim.strengths import Sizes

#: Sines of which a random force is made.
_SINES = 60


def _trapezoid(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    wave = 2.0 * math.sin(2.0 * math.pi * x / p["pitch"] + p["phase"])
    return p["size"] * min(max(wave, -1.0), 1.0)


def _sawtooth(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    angle = 2.0 * math.pi * x / p["pitch"] + p["phase"]
    return p["size"] * math.atan2(0.8 * math.sin(angle), 1.0 - 0.8 * math.cos(angle))


def _tones(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return sum(p[f"size_{i}"] * math.sin(p[f"turn_{i}"] * t + p[f"phase_{i}"]) for i in range(3))


def _modulated(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["size"] * (1.0 + p["depth"] * math.sin(p["slow"] * t)) * math.sin(p["turn"] * t + p["phase"])


def _random(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    sizes, turns, phases = _spectrum(int(p["seed"]), p["memory"])
    return p["size"] * float(sizes @ np.sin(turns * t + phases))


@lru_cache(maxsize=8)
def _spectrum(seed: int, memory: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sines of a random force of unit variance that forgets itself within ``memory`` [s]: a first-order spectrum."""
    rng = np.random.default_rng(seed)
    turns = np.tan((np.arange(_SINES) + rng.random(_SINES)) / _SINES * 0.48 * math.pi) / memory
    return np.full(_SINES, math.sqrt(2.0 / _SINES)), turns, rng.uniform(0.0, 2.0 * math.pi, _SINES)


def _hangs(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    return p["second_stiffness"] * (x - z[0]) + p["second_damping"] * (v - z[1])


def _rubbing(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    rubs = p["rubs"] * math.tanh(z[1] / p["creep"])
    return z[1], (_hangs(p, t, x, v, z, u) - rubs) / p["second_mass"]


def _sloshes(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> float:
    relative = v - z[1]
    return p["second_stiffness"] * (x - z[0]) + p["drag"] * abs(relative) * relative


def _sloshing(p: Values, t: float, x: float, v: float, z: Sequence[float], u: float) -> tuple[float, ...]:
    return z[1], _sloshes(p, t, x, v, z, u) / p["second_mass"]


def _second(s: Sizes) -> dict[str, float]:
    mass, omega = s.mass * s.log(0.05, 0.3), s.omega * s.log(1.5, 4.0)
    return {
        "second_mass": mass, "second_stiffness": mass * omega**2,
        "second_damping": 2.0 * s.log(0.01, 0.05) * mass * omega,
    }  # fmt: skip


def _three_tones(s: Sizes) -> dict[str, float]:
    ranges = ((0.3, 0.7), (1.4, 2.2), (2.6, 4.0))
    values = {f"size_{i}": s.force * s.log(0.005, 0.05) for i in range(3)}
    values |= {f"turn_{i}": s.omega * s.even(*pair) for i, pair in enumerate(ranges)}
    return values | {f"phase_{i}": s.even(-3.0, 3.0) for i in range(3)}


def _teeth(s: Sizes) -> dict[str, float]:
    return {"size": s.force * s.log(0.01, 0.08), "pitch": s.reach * s.log(0.15, 0.8), "phase": s.even(-3.0, 3.0)}


LAWS = (
    ForeignLaw("trapezoid_cogging", "A clip(2 sin(2 pi x / p + phi), -1, 1)", _teeth, _trapezoid),
    ForeignLaw("sawtooth_cogging", "A atan(0.8 sin q / (1 - 0.8 cos q)), q = 2 pi x / p + phi", _teeth, _sawtooth),
    ForeignLaw("three_tones", "A1 sin(w1 t + p1) + A2 sin(w2 t + p2) + A3 sin(w3 t + p3)", _three_tones, _tones),
    ForeignLaw(
        "modulated_tone", "A (1 + a sin(ws t)) sin(w t + phi)",
        lambda s: {
            "size": s.force * s.log(0.01, 0.08), "depth": s.even(0.3, 0.9), "slow": s.omega * s.even(0.1, 0.3),
            "turn": s.omega * s.even(1.3, 3.5), "phase": s.even(-3.0, 3.0),
        },
        _modulated,
    ),
    ForeignLaw(
        "random_force", "a random force of size A that forgets itself within T",
        lambda s: {
            "size": s.force * s.log(0.003, 0.03), "memory": s.log(0.1, 1.0) / s.omega * 2.0 * math.pi,
            "seed": float(s.rng.integers(1 << 31)),
        },
        _random,
    ),
    ForeignLaw(
        "rubbing_second_mass", "a second mass on a spring, with dry friction of its own",
        lambda s: _second(s) | {"rubs": s.force * s.log(0.005, 0.03), "creep": 3e-4 * s.speed},
        _hangs, _rubbing, 2, True,
    ),
    ForeignLaw(
        "sloshing_mass", "a second mass on a spring, damped by the square of its relative speed",
        lambda s: _second(s) | {"drag": s.mass * s.log(0.02, 0.3) / s.reach}, _sloshes, _sloshing, 2, True,
    ),
)  # fmt: skip
