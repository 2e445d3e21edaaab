"""A spring that hardens or softens with another power than the cube."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class PowerSpring(Effect):
    """F3·(abs(x)/x1)^n·sign(x). x1 is no parameter of the rig: a position at which F3 is stated."""

    power_force: float
    power_position: float
    power_exponent: float

    name = "power_spring"
    parameters = (
        Parameter("power_force", "F3", "N", -math.inf, math.inf, "further spring force at the position x1"),
        Parameter("power_position", "x1", "m", 1e-12, math.inf, "position at which it is stated"),
        Parameter("power_exponent", "n", "1", 1.2, 7.0, "power of the displacement with which it grows"),
    )
    acts_on = "force"
    law = "F3·abs(x/x1)^n·sign(x)"
    source = "Duffing's oscillator with a free odd power; Kovacic & Brennan 2011"
    neutral = (("power_force", 0.0),)
    form_of = "cubic_spring"
    prior_odds = 1.0 / 100.0
    needs_spring = True
    held = ("power_position",)
    ring_down = {SOFTENS: (-1,), HARDENS: (1,)}

    @staticmethod
    def force(x: float, power_force: float, power_position: float, power_exponent: float) -> float:
        """Force [N] against +x beyond the linear spring's."""
        size = abs(x) / power_position
        if size <= 0.0:
            return 0.0
        grown = power_force * math.exp(power_exponent * math.log(size))
        return grown if x > 0.0 else -grown

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PowerSpring, ...]:
        """A twentieth of the largest force at the largest position, of either sign, at powers of 2, 3 and 5."""
        force, reach = 0.05 * typical.force(record, plant), typical.amplitude(record)
        return tuple(cls(sign * force, reach, power) for power in (2.0, 5.0) for sign in (1.0, -1.0))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[PowerSpring, ...]:
        """As strong at the largest position as the cubic spring, at powers of 2, 3 and 5."""
        reach = typical.amplitude(record)
        return tuple(cls(simple.values[0] * reach**3, reach, power) for power in (2.0, 3.0, 5.0))
