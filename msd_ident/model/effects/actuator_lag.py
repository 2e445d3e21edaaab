"""A force that follows its command with a delay of first order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import LAG
from msd_ident.quantity import two_digits

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _longest(duration: float, period: float) -> float:
    """A lag [s] as long as the record is none that it could tell."""
    del period
    return duration


@dataclass(frozen=True)
class ActuatorLag(Effect):
    """tau·F' + F = commanded force."""

    lag_time: float

    name = "actuator_lag"
    parameters = (
        Parameter(
            "lag_time", "tau", "s", 0.0, math.inf, "time constant of the actuator",
            advice="add a sweep to well above resonance", ceiling=_longest,
        ),
    )  # fmt: skip
    acts_on = "input"
    law = "tau·F' + F = F_commanded"
    source = "first-order current loop or valve"
    neutral = (("lag_time", 0.0),)
    piecewise_linear = True
    structure = LAG
    or_else = "a low-pass filter of the readings"
    measured_by = "read the force with a load cell while the cart is held"

    def same_as(self, model: Model) -> str:
        """On a linear plant a motor's back-EMF behind its inductance, with another mass and damping.

        m·T·s³ + (m + b·T)·s² + (b + k·T + c)·s + k with T = L/R and c = Kt·Ke/R has a real root, so that it is a lag's
        (1 + tau·s)·(m·s² + b·s + k) with another m and b. As c and b of the motor are not negative, its mass is at
        least that beside the lag, and larger by b·tau of the lag at most. A further force on the cart stands behind
        1 + T·s there and 1 + tau·s here, which are nearly the same: of motors with dry friction the lag left 1.0 noise
        floors, and a mass 1.2 % too small.
        """
        more = self.lag_time * model.damping / model.mass
        if more < 0.01:
            return ""
        beside = any(effect.acts_on == "force" for effect in model.effects)
        return (
            f"actuator_lag is {'nearly ' if beside else ''}equivalent to a motor's back-EMF behind its inductance, "
            f"where a voltage drives it: then the mass is up to {_larger(more)}, and the damping smaller. "
            "Let the cart swing with the drive disconnected to tell them apart."
        )

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"lag_time": (0.0, 0.25 * seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ActuatorLag, ...]:
        """One sample, and a thirtieth of the swing's period."""
        swing = 2.0 * math.pi / typical.natural_frequency(record, plant)
        return cls(record.period), cls(0.03 * swing)


def _larger(more: float) -> str:
    """By how much a mass is larger, as a part of it, in words."""
    if more < 1.0:
        return f"{two_digits(100.0 * more)} % larger"
    return f"{two_digits(1.0 + more)} times as large" if more < 99.0 else "many times as large"
