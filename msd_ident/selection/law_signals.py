"""What the laws of effects do along a measured motion, before anything is simulated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from msd_ident.data.compiled import all_pole
from msd_ident.data.record import FloatArray
from msd_ident.estimate.weak_form import Means
from msd_ident.model import Effect, Model
from msd_ident.model.effects.law import DELAY, LAG, PLAY, SECOND_MASS, arguments
from msd_ident.selection.second_masses import filtered

#: Laws that are a force, one by the direction of the motion, a change of the command, and one of the reading.
_ACTING = ("constant", "disturbance", "force", "friction", "input_map", "reading")


@dataclass(frozen=True)
class Motion:
    """A measured motion, on even instants.

    Attributes:
        time: (n,) from the beginning [s].
        position: (n,) from the relaxed spring [m].
        velocity, direction: (n,) [m/s], and its sign.
        force: (n,) commanded force [N].
        stiffness: of a roughly known plant [N/m].
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    direction: FloatArray
    force: FloatArray
    stiffness: float

    @cached_property
    def _known(self) -> dict[str, FloatArray]:
        return {
            "t": self.time,
            "x": self.position,
            "piece_x": self.position,
            "v": self.velocity,
            "speed": np.abs(self.velocity),
            "direction": self.direction,
            "spring_force": self.stiffness * self.position,
            "driven": (self.force != 0.0).astype(float),
            "u": self.force,
        }

    def can_tell(self, effect: type[Effect]) -> bool:
        """Whether all that the effect does follows from the measured motion."""
        own = {parameter.name for parameter in effect.parameters}
        laws = effect.laws()
        if (
            effect.memory
            or not set(laws) <= {*_ACTING, "breakaway"}
            or effect.structure not in ("", PLAY, LAG, DELAY, SECOND_MASS)
        ):
            return False
        return all(set(arguments(laws[kind])) <= own | set(self._known) for kind in _ACTING if kind in laws)

    def force_of(self, effect: Effect) -> FloatArray:
        """Force (n,) against +x [N] that the effect adds; not finite where its values are absurd."""
        laws = effect.laws()
        found = np.zeros(self.time.size)
        for kind in ("constant", "disturbance", "force"):
            if kind in laws:
                found = found + self._value(effect, laws[kind])
        if "friction" in laws:
            found = found + self.direction * self._value(effect, laws["friction"])
        if "input_map" in laws:
            found = found + self.force - self._value(effect, laws["input_map"])
        return found + self._of_knees(effect) + self._of_structure(effect)

    def error_of(self, effect: Effect) -> FloatArray | None:
        """Error (n,) of the reading that the effect makes [m]; None without one."""
        law = effect.laws().get("reading")
        return None if law is None else self._value(effect, law) - self.position

    def _value(self, effect: Effect, law: Callable[..., float]) -> FloatArray:
        own = dict(zip((parameter.name for parameter in effect.parameters), effect.values, strict=True))
        names = arguments(law)
        try:
            value = np.frompyfunc(law, len(names), 1)(*(self._known.get(name, own.get(name)) for name in names))
        except (ArithmeticError, ValueError):  # Python raises where compiled code goes on with infinities
            value = math.nan
        return np.broadcast_to(np.asarray(value, dtype=np.float64), self.time.shape)

    def _of_knees(self, effect: Effect) -> FloatArray:
        found = np.zeros(self.time.size)
        if effect.knee is not None:
            for place, side in effect.knee_places():
                beyond = np.maximum(side * (self.position - place), 0.0)
                found += getattr(effect, effect.knee[1]) * side * beyond
        return found

    def _of_structure(self, effect: Effect) -> FloatArray:
        """That of a play beside a linear spring, a force that comes late, or a second mass (``second_masses``)."""
        if effect.structure == PLAY:
            within = np.clip(self.position, -effect.values[0], effect.values[0])
            return -self.stiffness * within
        if effect.structure == DELAY:
            return self.force - np.interp(self.time - effect.values[0], self.time, self.force, left=0.0)
        if effect.structure == LAG:
            kept = math.exp(-(self.time[1] - self.time[0]) / effect.values[0]) if effect.values[0] > 0.0 else 0.0
            return self.force - (1.0 - kept) * all_pole(np.array([1.0, -kept]), self.force)
        if effect.structure == SECOND_MASS:
            mass, stiffness, damping = effect.values[:3]
            slow, fast = stiffness / mass, damping / mass
            change = mass * (self.velocity - self.velocity[0])
            return filtered((fast, slow, 0.0), (1.0, fast, slow), change, float(self.time[1] - self.time[0]))
        return np.zeros(self.time.size)


def along(means: Means, stiffness: float) -> Motion:
    """The motion of which these are the means over bumps.

    Args:
        means: of a record, from the reading at which its spring is relaxed.
        stiffness: of a roughly known plant [N/m].
    """
    grid = means.grid
    time = grid.period * np.arange(grid.position.size, dtype=np.float64)
    return Motion(time, grid.position, means.velocity, means.direction, grid.force, stiffness)


def column(effect: Effect, motion: Motion, means: Means, plant: Model) -> FloatArray:
    """Force (r,) against +x that an effect adds over each bump; an error of the reading is what the plant would have to
    move it by.
    """
    found: FloatArray = means.smoothed(motion.force_of(effect)[None, :])[:, 0]
    error = motion.error_of(effect)
    if error is not None:
        found = found - means.plant_columns(error) @ (plant.mass, plant.damping, plant.stiffness)
    return found
