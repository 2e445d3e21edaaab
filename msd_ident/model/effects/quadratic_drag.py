"""Drag that grows with the square of the speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _square(v: Any) -> Any:
    """v·abs(v) [m²/s²]."""
    return v * abs(v)


@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """c·v·abs(v): air, oil through an orifice."""

    drag_coefficient: float

    name = "quadratic_drag"
    parameters = (
        Parameter(
            "drag_coefficient", "c", "N·s²/m²", 0.0, math.inf, "quadratic drag",
            advice="let it ring down from a three times larger amplitude, or sweep through resonance",
            most=1e3, regressor=_square,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "c·v·abs(v)"
    source = "Newton's drag law, c = rho·Cd·A/2"
    neutral = (("drag_coefficient", 0.0),)
    dissipative = True
    ring_down = {DRAGS: (1,)}
    measured_by = "let the cart swing in a shroud, or with another area, and record again"
    turns = True

    @staticmethod
    def force(v: float, speed: float, drag_coefficient: float) -> float:
        """Drag [N]."""
        return drag_coefficient * v * speed

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[QuadraticDrag, ...]:
        """As strong at top speed as a twentieth of the largest force."""
        return (cls(0.05 * typical.force(record, plant) / typical.speed(record) ** 2),)
