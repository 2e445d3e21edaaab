"""The hidden truth of a rig: plant and effects, checked, and the form in which the compiled code takes them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from msd_sim import effects as catalogue
from msd_sim.errors import RigError

FloatArray = npt.NDArray[np.float64]

GRAVITY = 9.81

#: Values that make an absent effect vanish and keep its formula finite; all others are 0.
_NEUTRAL = {
    "stribeck_velocity": 1.0, "eccentric_pitch": 1.0, "fading_time": 1.0, "hysteresis_length": 1.0,
    "cogging_pitch": 1.0, "creep_time": 1.0, "magnet_gap": 1.0, "stop_position": math.inf, "drop_time": math.inf,
    "change_time": math.inf, "cable_start": math.inf, "cable_end": math.inf, "rational_velocity": 1.0,
    "exponential_velocity": 1.0, "one_stop_position": math.inf, "soft_stop_position": math.inf,
    "bend_position": math.inf, "settling_time": 1.0, "slow_brake_time": 1.0,
}  # fmt: skip

#: Friction whose breakaway force is at least the sliding one.
_PEAKED = ("stribeck_friction", "rational_stribeck", "exponential_stribeck")


@dataclass(frozen=True)
class Truth:
    """Mass [kg], damping [N s/m], stiffness [N/m] and effects: name -> parameter -> value (SI).

    Raises:
        RigError: values out of range, effects or parameters that do not exist, or a combination without a meaning.
    """

    mass: float
    damping: float
    stiffness: float
    effects: Mapping[str, Mapping[str, float]]

    def __post_init__(self) -> None:
        for parameter in catalogue.PLANT:
            object.__setattr__(self, parameter.name, parameter.checked(getattr(self, parameter.name), "rig"))
        full = {name: MappingProxyType(catalogue.by_name(name).values(given)) for name, given in self.effects.items()}
        object.__setattr__(self, "effects", MappingProxyType(full))
        self._check_sense()

    def value(self, effect: str, parameter: str, absent: float = 0.0) -> float:
        """Value of an effect's parameter, ``absent`` when the rig has not that effect."""
        return self.effects[effect][parameter] if effect in self.effects else absent

    def _check_sense(self) -> None:
        for name in ("coulomb_friction", *_PEAKED):
            static, kinetic = self.value(name, "static_force"), self.value(name, "coulomb_force")
            if static < kinetic and (name in _PEAKED or static > 0.0):
                raise RigError(
                    f"{name} static_force is {static:g} N, below coulomb_force {kinetic:g} N; "
                    "expected a breakaway force of at least the sliding one"
                )
        dropped = self.value("mass_drop", "dropped_mass")
        if dropped >= self.mass:
            raise RigError(f"mass_drop dropped_mass is {dropped:g} kg of {self.mass:g} kg; expected less than the mass")
        start, end = self.value("loose_cable", "cable_start"), self.value("loose_cable", "cable_end", 1.0)
        if "loose_cable" in self.effects and start >= end:
            raise RigError(f"loose_cable runs from {start:g} m to {end:g} m; expected cable_start below cable_end")

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers for JSON: mass, damping, stiffness, effects."""
        effects = {name: dict(values) for name, values in self.effects.items()}
        return {"mass": self.mass, "damping": self.damping, "stiffness": self.stiffness, "effects": effects}

    @property
    def natural_frequency(self) -> float:
        """sqrt(k/m) [rad/s], 0 without a spring."""
        return math.sqrt(self.stiffness / self.mass)

    def parameters(self, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        """(1,) array of the compiled code's parameters."""
        array = np.zeros(1, dtype)
        for name, value in _NEUTRAL.items():
            array[name] = value
        for parameter in catalogue.PLANT:
            array[parameter.slot] = getattr(self, parameter.name)
        for name, values in self.effects.items():
            for parameter in catalogue.ALL[name].parameters:
                if parameter.slot in (dtype.names or ()):
                    array[parameter.slot] = values[parameter.name]
        array["static_force"] = max(array["static_force"][0], array["coulomb_force"][0])
        array["longest_move"], array["longest_step"] = self._finest()
        return array

    def _finest(self) -> tuple[float, float]:
        """A fraction of the shortest length [m] and of the shortest time [s] over which a force rises and falls."""
        lengths = (("magnet", "magnet_gap"), ("cogging", "cogging_pitch"), ("eccentric_friction", "eccentric_pitch"))
        finest = min((self.value(effect, length, math.inf) for effect, length in lengths), default=math.inf)
        tones = (
            ("periodic_disturbance", "disturbance_frequency"),
            ("two_tone_disturbance", "low_tone_frequency"),
            ("two_tone_disturbance", "high_tone_frequency"),
        )
        turns = max(self.value(effect, frequency) for effect, frequency in tones)
        return 0.5 * finest, 1.0 / turns if turns > 0.0 else math.inf

    def edges(self) -> FloatArray:
        """Positions at which a force changes its form [m], rising."""
        found: set[float] = set()
        pairs = (
            ("backlash", "backlash_half_width"),
            ("end_stop", "stop_position"),
            ("damped_stop", "soft_stop_position"),
        )
        for half_width in (self.value(effect, parameter) for effect, parameter in pairs):
            if half_width > 0.0:
                found |= {half_width, -half_width}
        if "load_friction" in self.effects:
            found.add(0.0)
        for effect, parameter in (("one_sided_stop", "one_stop_position"), ("two_slope_spring", "bend_position")):
            if effect in self.effects:
                found.add(self.value(effect, parameter))
        if "loose_cable" in self.effects:
            found |= {self.value("loose_cable", "cable_start"), self.value("loose_cable", "cable_end")}
        slope = self.value("position_dependent_friction", "position_friction_slope")
        if slope != 0.0:
            found.add(-1.0 / slope)
        return np.array(sorted(found))

    def instants(self) -> FloatArray:
        """Times at which the rig itself changes [s], rising."""
        found = [
            self.effects[n][p]
            for n, p in (("friction_change", "change_time"), ("mass_drop", "drop_time"))
            if n in self.effects
        ]
        return np.unique(np.array(found, dtype=np.float64))

    def actuate(self, force: FloatArray) -> FloatArray:
        """Static part of the actuator: steady force [N] for a commanded one."""
        step = self.value("coarse_actuator", "force_step")
        made = np.round(force / step) * step if step > 0.0 else force
        if "force_gain_nonlinearity" in self.effects:
            gain = self.effects["force_gain_nonlinearity"]
            made = np.clip(made * (1.0 + gain["gain_slope"] * np.abs(made)), -gain["force_limit"], gain["force_limit"])
        limit = self.value("soft_saturation", "soft_limit")
        made = limit * np.tanh(made / limit) if limit > 0.0 else made
        return np.asarray(made, dtype=np.float64)

    def sensed(self, time: FloatArray, position: FloatArray) -> FloatArray:
        """What the sensor has before it at ``time`` [s] with the cart at ``position`` [m]: drift, bend, slip, wheel."""
        seen = position + self.value("sensor_drift", "sensor_drift_rate") * time
        if "settling_sensor" in self.effects:
            settling = self.effects["settling_sensor"]
            seen = seen - settling["sensor_settling"] * np.expm1(-time / settling["sensor_settling_time"])
        if "sensor_eccentricity" in self.effects:
            wheel = self.effects["sensor_eccentricity"]
            seen = seen + wheel["eccentricity"] * np.sin(2.0 * math.pi * position / wheel["wheel_circumference"])
        seen = seen + position * self.value("scale_drift", "scale_drift_rate") * time
        if "sensor_nonlinearity" in self.effects:
            bend = self.effects["sensor_nonlinearity"]
            seen = seen + position**2 * (bend["sensor_curvature"] + bend["sensor_cubic"] * position)
        if "encoder_slip" in self.effects:
            slip = self.effects["encoder_slip"]
            seen = seen + np.where(time >= slip["slip_time"], slip["slip_distance"], 0.0)
        return np.asarray(seen, dtype=np.float64)
