"""How strong a hidden effect is: by lot, relative to the plant that was drawn.

The narrow ranges go from barely to plainly visible in steps of two amplitudes; the wide ones are about three times as
wide, with whatever a lab may meet: nothing to be seen at all, or an effect that rules the motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

Ranges = Literal["narrow", "wide"]
Range = tuple[float, float]

#: Factor by which either end of a range moves outwards: together the range is three times as wide.
_WIDER = math.sqrt(3.0)


@dataclass(frozen=True)
class Sizes:
    """Sizes of the plant drawn [SI], the lot, and whether strengths are drawn from the narrow or the wide ranges."""

    rng: np.random.Generator
    mass: float
    stiffness: float
    force: float
    duration: float
    ranges: Ranges = "narrow"

    @property
    def reach(self) -> float:
        return self.force / self.stiffness

    @property
    def omega(self) -> float:
        return math.sqrt(self.stiffness / self.mass)

    @property
    def speed(self) -> float:
        return self.reach * self.omega

    def log(self, low: float, high: float, wide: Range | None = None) -> float:
        """A number by its logarithm; the wide range is three times as wide unless it is given."""
        low, high = self._range(low, high, wide or (low / _WIDER, high * _WIDER))
        return float(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def even(self, low: float, high: float, wide: Range | None = None) -> float:
        """A number; the wide range is the same unless it is given."""
        return float(self.rng.uniform(*self._range(low, high, wide or (low, high))))

    def sign(self) -> float:
        """1 or -1."""
        return float(self.rng.choice((-1.0, 1.0)))

    def _range(self, low: float, high: float, wide: Range) -> Range:
        return wide if self.ranges == "wide" else (low, high)


def _stribeck(s: Sizes) -> dict[str, float]:
    force, speed = s.force * s.log(0.01, 0.08), s.speed * s.log(0.03, 0.3, wide=(0.02, 0.5))
    return {
        "coulomb_force": force,
        "static_force": force * s.even(1.3, 2.2, wide=(1.1, 5.0)),
        "stribeck_velocity": speed,
    }


def _gain(s: Sizes) -> dict[str, float]:
    if s.rng.random() < 0.3:
        return {"gain_slope": 0.0, "force_limit": s.force * s.even(0.6, 0.95, wide=(0.4, 0.98))}
    # A gain that falls faster would make less force of more command.
    return {"gain_slope": s.sign() * s.log(0.01, 0.3, wide=(0.006, 0.45)) / s.force}


def _cubic(s: Sizes) -> dict[str, float]:
    """Hardening, or softening by less than lets the cart run away on its largest swing."""
    sign = s.sign()
    wide = (0.0017, 0.14) if sign > 0.0 else (0.0017, 0.035)
    return {"cubic_stiffness": sign * s.force * s.log(0.003, 0.08 if sign > 0.0 else 0.03, wide=wide) / s.reach**3}


def _mode(s: Sizes) -> dict[str, float]:
    mass, omega = s.mass * s.log(0.05, 0.4), s.omega * s.log(1.3, 5.0)
    return {
        "second_mass": mass,
        "second_stiffness": mass * omega**2,
        "second_damping": 2.0 * s.log(0.01, 0.1) * mass * omega,
    }


STRENGTHS: Mapping[str, Callable[[Sizes], dict[str, float]]] = {
    "coulomb_friction": lambda s: {"coulomb_force": s.force * s.log(0.005, 0.1)},
    "stribeck_friction": _stribeck,
    "position_dependent_friction": lambda s: {
        "coulomb_force": s.force * s.log(0.01, 0.1),
        "position_friction_slope": s.sign() * s.even(0.2, 0.5, wide=(0.1, 0.6)) / s.reach,
    },
    "quadratic_drag": lambda s: {"drag_coefficient": s.force * s.log(0.01, 0.4) / s.speed**2},
    "cubic_spring": _cubic,
    "asymmetric_spring": lambda s: {
        "quadratic_stiffness": s.sign() * s.force * s.log(0.005, 0.1, wide=(0.003, 0.13)) / s.reach**2,
    },
    "backlash": lambda s: {"backlash_half_width": s.reach * s.log(0.003, 0.15)},
    "end_stop": lambda s: {
        "stop_position": s.reach * s.even(0.9, 1.3, wide=(0.5, 1.6)), "stop_stiffness": s.stiffness * s.log(1.0, 20.0),
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


def _two_slopes(s: Sizes) -> dict[str, float]:
    bend = s.stiffness * (s.log(0.1, 0.6) if s.sign() > 0.0 else -s.log(0.05, 0.3))
    return {"bend_stiffness": bend, "bend_position": s.reach * s.even(0.1, 0.7)}


#: Of laws that are variants of known ones.
VARIANT_STRENGTHS: Mapping[str, Callable[[Sizes], dict[str, float]]] = {
    "rational_stribeck": _stribeck,
    "exponential_stribeck": _stribeck,
    "load_friction": lambda s: {"coulomb_force": s.force * s.log(0.005, 0.03), "load_ratio": s.log(0.01, 0.1)},
    "one_sided_stop": lambda s: {
        "one_stop_position": s.reach * s.even(0.7, 1.3), "one_stop_stiffness": s.stiffness * s.log(1.0, 20.0),
    },
    "damped_stop": lambda s: {
        "soft_stop_position": s.reach * s.even(0.7, 1.3), "soft_stop_stiffness": s.stiffness * s.log(1.0, 20.0),
        "soft_stop_damping": s.log(0.05, 0.4) / s.speed,
    },
    "power_drag": lambda s: {"power_drag": s.force * s.log(0.01, 0.4) / s.speed**1.5},
    "one_way_damping": lambda s: {"up_damping": s.mass * s.omega * s.log(0.01, 0.3)},
    "drive_brake": lambda s: {"driven_damping": s.mass * s.omega * s.log(0.03, 0.3)},
    "slow_brake": lambda s: {
        "slow_brake_damping": s.mass * s.omega * s.log(0.03, 0.3), "slow_brake_time": s.even(0.2, 1.5) / s.omega,
    },
    "two_slope_spring": _two_slopes,
    "settling_stiffness": lambda s: {
        "settling_ratio": s.sign() * s.log(0.005, 0.1), "settling_time": s.duration * s.even(0.15, 0.6),
    },
    "two_tone_disturbance": lambda s: {
        "low_tone_amplitude": s.force * s.log(0.003, 0.1), "low_tone_frequency": s.omega * s.even(0.3, 0.8),
        "high_tone_amplitude": s.force * s.log(0.003, 0.1), "high_tone_frequency": s.omega * s.even(1.3, 4.0),
    },
    "soft_saturation": lambda s: {"soft_limit": s.force * s.log(1.2, 6.0)},
    "gain_drift": lambda s: {"gain_drift_rate": s.sign() * s.log(0.01, 0.15) / s.duration},
    "scale_drift": lambda s: {"scale_drift_rate": s.sign() * s.log(0.01, 0.1) / s.duration},
    "sensor_nonlinearity": lambda s: {
        "sensor_curvature": s.sign() * s.log(0.003, 0.05) / s.reach,
        "sensor_cubic": s.sign() * s.log(0.003, 0.05) / s.reach**2,
    },
    "settling_sensor": lambda s: {
        "sensor_settling": s.sign() * s.reach * s.log(0.005, 0.1),
        "sensor_settling_time": s.duration * s.even(0.15, 0.6),
    },
    "sensor_eccentricity": lambda s: {
        "eccentricity": s.reach * s.log(0.002, 0.02), "wheel_circumference": s.reach * s.even(1.0, 6.0),
    },
    # No effect of the rig: the commands are joined by straight lines, where the record holds them.
    "band_limited_force": lambda s: {},
}  # fmt: skip
