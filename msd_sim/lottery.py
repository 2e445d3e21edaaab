"""Rigs drawn by lot: plant, encoder and a hidden effect of some strength from a seed, for those who must find it.

``draw(seed, ...)`` gives the spec of a rig and experiment for ``msd_sim.api.simulate``; the strengths are relative to
the plant drawn, from barely to plainly visible.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_sim.effects import ALL, KNOWN, ODD
from msd_sim.errors import RigError

#: Effects that may be hidden.
NAMES = tuple(effect.name for effect in KNOWN)
#: Oddities that may be hidden.
ODDITIES = tuple(effect.name for effect in ODD)

EXPERIMENTS = ("steps", "step", "release", "sweep", "ramp")


@dataclass(frozen=True)
class Draw:
    """A rig by lot.

    Attributes:
        seed: what it was drawn from.
        spec: for ``msd_sim.api.simulate``.
        hidden: name of the hidden effect, or none.
        beside: whether Coulomb friction acts beside it.
        experiment: name of the experiment.
        noise: standard deviation of a reading [m], rounding included.
    """

    seed: int
    spec: Mapping[str, Any]
    hidden: str | None
    beside: bool
    experiment: str
    noise: float

    @property
    def truth(self) -> frozenset[str]:
        """Names of all effects of the rig."""
        return frozenset(self.spec["effects"])


@dataclass(frozen=True)
class _Sizes:
    """Sizes of the plant drawn, and the lot."""

    rng: np.random.Generator
    mass: float
    stiffness: float
    force: float
    duration: float

    @property
    def reach(self) -> float:
        return self.force / self.stiffness

    @property
    def omega(self) -> float:
        return math.sqrt(self.stiffness / self.mass)

    @property
    def speed(self) -> float:
        return self.reach * self.omega

    def log(self, low: float, high: float) -> float:
        return float(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def sign(self) -> float:
        return float(self.rng.choice((-1.0, 1.0)))

    def even(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))


def _stribeck(s: _Sizes) -> dict[str, float]:
    force, speed = s.force * s.log(0.01, 0.08), s.speed * s.log(0.03, 0.3)
    return {
        "coulomb_force": force,
        "static_force": force * s.even(1.3, 2.2),
        "stribeck_velocity": speed,
    }


def _gain(s: _Sizes) -> dict[str, float]:
    if s.rng.random() < 0.3:
        return {"gain_slope": 0.0, "force_limit": s.force * s.even(0.6, 0.95)}
    return {"gain_slope": s.sign() * s.log(0.01, 0.3) / s.force}


def _cubic(s: _Sizes) -> dict[str, float]:
    """Hardening, or softening by less than lets the cart run away on its largest swing."""
    sign = s.sign()
    return {"cubic_stiffness": sign * s.force * s.log(0.003, 0.08 if sign > 0.0 else 0.03) / s.reach**3}


def _mode(s: _Sizes) -> dict[str, float]:
    mass, omega = s.mass * s.log(0.05, 0.4), s.omega * s.log(1.3, 5.0)
    return {
        "second_mass": mass,
        "second_stiffness": mass * omega**2,
        "second_damping": 2.0 * s.log(0.01, 0.1) * mass * omega,
    }


_STRENGTHS: Mapping[str, Callable[[_Sizes], dict[str, float]]] = {
    "coulomb_friction": lambda s: {"coulomb_force": s.force * s.log(0.005, 0.1)},
    "stribeck_friction": _stribeck,
    "position_dependent_friction": lambda s: {
        "coulomb_force": s.force * s.log(0.01, 0.1), "position_friction_slope": s.sign() * s.even(0.2, 0.5) / s.reach,
    },
    "quadratic_drag": lambda s: {"drag_coefficient": s.force * s.log(0.01, 0.4) / s.speed**2},
    "cubic_spring": _cubic,
    "asymmetric_spring": lambda s: {"quadratic_stiffness": s.sign() * s.force * s.log(0.005, 0.1) / s.reach**2},
    "backlash": lambda s: {"backlash_half_width": s.reach * s.log(0.003, 0.15)},
    "end_stop": lambda s: {
        "stop_position": s.reach * s.even(0.9, 1.3), "stop_stiffness": s.stiffness * s.log(1.0, 20.0),
    },
    "force_offset": lambda s: {"offset_force": s.sign() * s.force * s.log(0.005, 0.1)},
    "force_gain_nonlinearity": _gain,
    "actuator_lag": lambda s: {"lag_time": s.log(0.02, 0.4) / s.omega},
    "time_offset": lambda s: {"time_offset": s.sign() * s.log(0.02, 0.3) / s.omega},
    "hysteresis": lambda s: {
        "hysteresis_force": s.force * s.log(0.01, 0.15), "hysteresis_length": s.reach * s.log(0.03, 0.6),
    },
    "periodic_disturbance": lambda s: {
        "disturbance_amplitude": s.force * s.log(0.003, 0.1), "disturbance_frequency": s.omega * s.log(0.3, 4.0),
        "disturbance_phase": s.even(-math.pi, math.pi),
    },
    "cogging": lambda s: {
        "cogging_amplitude": s.force * s.log(0.01, 0.1), "cogging_pitch": s.reach * s.log(0.15, 0.8),
        "cogging_phase": s.even(-math.pi, math.pi),
    },
    "stiffness_drift": lambda s: {"stiffness_drift_rate": s.sign() * s.log(0.005, 0.1) / s.duration},
    "sensor_drift": lambda s: {"sensor_drift_rate": s.sign() * s.reach * s.log(0.005, 0.1) / s.duration},
    "second_mode": _mode,
    "friction_change": lambda s: {
        "coulomb_force": s.force * 0.01, "later_coulomb_force": s.force * s.log(0.04, 0.15),
        "change_time": s.duration * s.even(0.3, 0.7),
    },
    "fading_friction": lambda s: {
        "coulomb_force": s.force * s.log(0.04, 0.15), "fading_time": s.duration * s.even(0.2, 0.6),
    },
    "eccentric_friction": lambda s: {
        "coulomb_force": s.force * s.log(0.03, 0.1), "eccentric_ratio": s.even(0.5, 1.0),
        "eccentric_pitch": s.reach * s.even(0.3, 0.9),
    },
    "mass_drop": lambda s: {"dropped_mass": s.mass * s.even(0.1, 0.4), "drop_time": s.duration * s.even(0.3, 0.7)},
    "magnet": lambda s: {
        "magnet_strength": 0.1 * s.force * s.reach**2 * s.even(0.1, 0.4), "magnet_position": s.reach * s.even(0.8, 1.5),
        "magnet_gap": s.reach * s.even(0.3, 0.6),
    },
    "loose_cable": lambda s: {
        "cable_damping": 0.3 * s.mass * s.omega * s.log(0.3, 1.0), "cable_start": 0.2 * s.reach, "cable_end": s.reach,
    },
    "creeping_spring": lambda s: {
        "creep_stiffness": s.stiffness * s.log(0.05, 0.2), "creep_time": s.even(1.0, 6.0) / s.omega,
    },
    "coarse_actuator": lambda s: {"force_step": s.force * s.even(0.15, 0.28)},
    "encoder_slip": lambda s: {"slip_distance": s.reach * s.log(0.02, 0.1), "slip_time": s.duration * s.even(0.3, 0.7)},
}  # fmt: skip


def _experiment(name: str, force: float, omega: float, rate: float) -> tuple[dict[str, float | str], float]:
    """Experiment and its duration [s]; long enough for a few swings each."""
    if name == "steps":
        return {"name": "steps", "force": force, "hold": 0.75}, 6.0
    if name == "step":
        return {"name": "step", "force": force, "hold": 3.0}, 3.0
    if name == "release":
        return {"name": "release", "position": 0.0, "duration": 4.0}, 4.0
    if name == "sweep":
        return {"name": "sweep", "force": 0.3 * force, "duration": 10.0, "rate": rate, "natural_frequency": omega}, 10.0
    if name == "ramp":
        return {"name": "ramp", "force": force, "duration": 16.0, "rate": rate}, 16.0
    raise RigError(f"no experiment {name!r} in the lottery; expected one of {', '.join(EXPERIMENTS)}")


def draw(seed: int, hidden: str | None, beside: bool = False, experiment: str = "steps", rate: float = 1000.0) -> Draw:
    """A rig by lot with ``hidden`` (a name, or None) in it, ``beside`` Coulomb friction or alone.

    Dry friction beside dry friction is one law of dry friction again: such effects always stand alone.

    Raises:
        RigError: no such effect or experiment.
    """
    if hidden is not None and hidden not in _STRENGTHS:
        raise RigError(f"no effect {hidden!r} in the lottery; expected one of {', '.join(_STRENGTHS)}")
    rng = np.random.default_rng([seed, 20141])
    mass = float(np.exp(rng.uniform(np.log(0.3), np.log(3.0))))
    omega = 2.0 * math.pi * float(rng.uniform(1.7, 6.0))
    stiffness = mass * omega**2
    damping = 2.0 * float(np.exp(rng.uniform(np.log(0.02), np.log(0.2)))) * mass * omega
    reach = float(rng.uniform(0.005, 0.02))
    force = stiffness * reach
    how, duration = _experiment(experiment, force, omega, rate)
    if experiment == "release":
        how["position"] = 1.5 * reach
    sizes = _Sizes(rng, mass, stiffness, force, duration)
    effects = {} if hidden is None else {hidden: _STRENGTHS[hidden](sizes)}
    beside = beside and not (hidden is not None and ALL[hidden].dry_friction)
    if beside:
        effects["coulomb_friction"] = {"coulomb_force": force * sizes.log(0.01, 0.08)}
    encoder, noise = _encoder(rng, reach)
    spec = {
        "mass": mass, "damping": damping, "stiffness": stiffness, "friction_coefficient": 0.0, "effects": effects,
        "encoder": encoder, "experiment": how, "rate": rate, "seed": int(rng.integers(1 << 31)),
    }  # fmt: skip
    return Draw(seed, spec, hidden, beside, experiment, noise)


def _encoder(rng: np.random.Generator, reach: float) -> tuple[dict[str, float], float]:
    """Counts, or noise, or both: 300 to 10000 noise levels within the reach."""
    noise = reach / float(np.exp(rng.uniform(np.log(300.0), np.log(10000.0))))
    kind = rng.choice(("counts", "noise", "both"))
    if kind == "noise":
        return {"counts_per_metre": 0.0, "noise": noise}, noise
    if kind == "both":
        step = noise * float(rng.uniform(0.3, 2.0))
        return {"counts_per_metre": 1.0 / step, "noise": noise}, math.hypot(noise, step / math.sqrt(12.0))
    return {"counts_per_metre": 1.0 / (noise * math.sqrt(12.0)), "noise": 0.0}, noise
