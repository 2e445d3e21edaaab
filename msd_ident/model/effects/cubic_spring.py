"""A spring that hardens or softens either way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _cube(x: Any) -> Any:
    """x³ [m³]."""
    return x**3


@dataclass(frozen=True)
class CubicSpring(Effect):
    """k3·x³ beside the linear spring: hardening (+) or softening (-)."""

    cubic_stiffness: float

    name = "cubic_spring"
    parameters = (
        Parameter(
            "cubic_stiffness", "k3", "N/m³", -math.inf, math.inf, "hardening of the spring",
            advice="release it from two displacements about 3:1 apart", most=1e3, regressor=_cube,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "k3·x³"
    source = "G. Duffing 1918"
    neutral = (("cubic_stiffness", 0.0),)
    ring_down = {SOFTENS: (-1,), HARDENS: (1,)}
    measured_by = "hang known masses on the spring and read the encoder at rest"

    @staticmethod
    def force(x: float, cubic_stiffness: float) -> float:
        """Force [N] against +x."""
        return cubic_stiffness * x * x * x

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[CubicSpring, ...]:
        """A twentieth of the largest force at the amplitude, hardening and softening."""
        size = 0.05 * typical.force(record, plant) / typical.amplitude(record) ** 3
        return cls(size), cls(-size)
