"""Hysteresis that loads and unloads in different ways."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS, HARDENS, RUBS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class BoucWen(Effect):
    """A hysteretic spring of stiffness ka at first, whose slope falls by ``a`` while it is loaded, and grows by ``c``
    while it is unloaded, per newton.

    Between reversals the force z along the motion has a closed form in the way: dz/dx = ka - a·z where z is against
    the motion (loading), ka - c·z where it is with it. Dahl's law (``hysteresis``) is a = c = ka/Fh. z = 0 at first.
    """

    hysteresis_stiffness: float
    loading_rate: float
    unloading_rate: float

    name = "bouc_wen"
    parameters = (
        Parameter("hysteresis_stiffness", "ka", "N/m", 0.0, math.inf, "stiffness of the hysteretic spring at z = 0"),
        Parameter("loading_rate", "a", "1/m", -math.inf, math.inf, "beta + gamma: how fast it yields under load"),
        Parameter("unloading_rate", "c", "1/m", -math.inf, math.inf, "beta - gamma: how fast it lets go"),
    )
    acts_on = "force"
    law = "z with z' = ka·v - beta·abs(v)·z - gamma·v·abs(z), beta + gamma = a, beta - gamma = c"
    source = "Bouc 1967, Wen 1976 (J. Eng. Mech. 102) with n = 1; Noël & Schoukens 2016, hysteretic benchmark"
    neutral = (("hysteresis_stiffness", 0.0),)
    form_of = "hysteresis"
    eponym = "Bouc-Wen"
    prior_odds = 1.0 / 100.0
    memory = (("wen_x", 0.0), ("wen_z", 0.0))
    ring_down = {RUBS: (1,), DRAGS: (1,), SOFTENS: (1,), HARDENS: (1,)}

    @staticmethod
    def force(
        x: float,
        direction: float,
        hysteresis_stiffness: float,
        loading_rate: float,
        unloading_rate: float,
        wen_x: float,
        wen_z: float,
    ) -> float:
        """Force [N] against +x; at rest (direction 0) what the last motion left."""
        if direction == 0.0:
            return wen_z
        way = max(direction * (x - wen_x), 0.0)
        along = direction * wen_z
        if along < 0.0:  # the force is with the motion: it is let go until it is 0
            grown = 1.0 - unloading_rate * along / hysteresis_stiffness
            if abs(grown - 1.0) < 1e-9:
                released = -along / hysteresis_stiffness
            else:
                released = math.log(grown) / unloading_rate if grown > 0.0 else math.inf
            if way < released:
                fade = math.exp(-unloading_rate * way)
                if abs(unloading_rate * way) < 1e-9:
                    return direction * (along + hysteresis_stiffness * way)
                whole = hysteresis_stiffness / unloading_rate
                return direction * (whole + (along - whole) * fade)
            way, along = way - released, 0.0
        if abs(loading_rate * way) < 1e-9:
            return direction * (along + hysteresis_stiffness * way)
        whole = hysteresis_stiffness / loading_rate
        return direction * (whole + (along - whole) * math.exp(-loading_rate * way))

    @staticmethod
    def reversal_wen_x(x: float) -> float:
        """Position [m] of the reversal."""
        return x

    reversal_wen_z = force

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        stiffness = max(seen.stiffness, seen.force / seen.span)
        return {
            "hysteresis_stiffness": (0.0, 1e3 * stiffness),
            "loading_rate": (-2.0 / seen.span, 1e3 / seen.span),
            "unloading_rate": (-2.0 / seen.span, 1e3 / seen.span),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[BoucWen, ...]:
        """Half as stiff as the spring, yielding within the amplitude or hardening."""
        stiffness, amplitude = typical.force(record, plant) / typical.amplitude(record), typical.amplitude(record)
        rates = ((1.0, 1.0), (0.1, 1.0), (-0.3, 1.0))
        return tuple(cls(0.5 * stiffness, a / amplitude, c / amplitude) for a, c in rates)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[BoucWen, ...]:
        """Dahl's law as it is, yielding half as much under load, and not at all."""
        force, length = simple.values
        rates = ((1.0, 1.0), (0.3, 1.0), (0.0, 1.0))
        return tuple(cls(force / length, a / length, c / length) for a, c in rates)

    def simple_values(self) -> dict[str, float]:
        """Dahl's law of the same stiffness and the same largest force under load; none where the force has no limit."""
        if self.loading_rate <= 0.0:
            return {}
        return {
            "hysteresis_force": self.hysteresis_stiffness / self.loading_rate,
            "hysteresis_length": 1.0 / self.loading_rate,
        }
