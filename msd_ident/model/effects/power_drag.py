"""Drag with another power of the speed than the square."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class PowerDrag(Effect):
    """F1·(speed / v1)^n against the motion. v1 is no parameter of the rig: a speed at which F1 is stated."""

    drag_force: float
    drag_speed: float
    drag_exponent: float

    name = "power_drag"
    parameters = (
        Parameter("drag_force", "F1", "N", 0.0, math.inf, "drag at the speed v1"),
        Parameter("drag_speed", "v1", "m/s", 1e-9, math.inf, "speed at which the drag is stated"),
        Parameter("drag_exponent", "n", "1", 1.05, 4.0, "power of the speed with which the drag grows"),
    )
    acts_on = "force"
    law = "F1·abs(v/v1)^n·sign(v)"
    source = "drag between laminar (1) and turbulent (2) flow; e.g. Blasius' law has 1.75"
    neutral = (("drag_force", 0.0),)
    dissipative = True
    form_of = "quadratic_drag"
    prior_odds = 1.0 / 100.0
    turns = True
    held = ("drag_speed",)
    ring_down = {DRAGS: (1,)}

    @staticmethod
    def force(direction: float, speed: float, drag_force: float, drag_speed: float, drag_exponent: float) -> float:
        """Drag [N]."""
        if speed <= 0.0:
            return 0.0
        return direction * drag_force * math.exp(drag_exponent * math.log(speed / drag_speed))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PowerDrag, ...]:
        """As strong at top speed as a twentieth of the largest force, at powers of 1.5 and 3."""
        force, speed = 0.05 * typical.force(record, plant), typical.speed(record)
        return tuple(cls(force, speed, power) for power in (1.5, 3.0))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[PowerDrag, ...]:
        """As strong at top speed as the quadratic drag, at powers of 1.5, 2 and 2.5."""
        speed = typical.speed(record)
        return tuple(cls(simple.values[0] * speed**2, speed, power) for power in (1.5, 2.0, 2.5))
