"""Viscous damping that is another in each direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class DirectionDependentDamping(Effect):
    """b·(1 + a·sign(v))·v in place of b·v: a damper with a valve, a cable that drags one way."""

    damping_difference: float

    name = "direction_dependent_damping"
    parameters = (
        Parameter("damping_difference", "bd", "N·s/m", -math.inf, math.inf, "damping upwards less the mean of both"),
    )
    prior_odds = 1.0 / 100.0
    acts_on = "force"
    law = "bd·abs(v): the damping is b + bd upwards and b - bd downwards"
    source = "asymmetric damper, e.g. of a vehicle: Dixon, The Shock Absorber Handbook, 2007"
    neutral = (("damping_difference", 0.0),)
    mirror = False
    turns = True

    @staticmethod
    def force(speed: float, damping_difference: float) -> float:
        """Force [N] against +x beyond that of the mean damping."""
        return damping_difference * speed

    def same_as(self, model: Model) -> str:
        """A constant force, at one speed."""
        del model
        return (
            "At speeds of one size, damping that differs between directions is equivalent to a force offset or to "
            "asymmetric friction: move at several speeds to tell them apart."
        )

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[DirectionDependentDamping, ...]:
        """A twentieth of the largest force at top speed, either way."""
        size = 0.05 * typical.force(record, plant) / typical.speed(record)
        return cls(size), cls(-size)
