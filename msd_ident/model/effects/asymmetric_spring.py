"""A spring that is stiffer one way than the other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _square(x: Any) -> Any:
    """x² [m²]."""
    return x**2


@dataclass(frozen=True)
class AsymmetricSpring(Effect):
    """k2·x² beside the linear spring."""

    quadratic_stiffness: float

    name = "asymmetric_spring"
    parameters = (
        Parameter(
            "quadratic_stiffness", "k2q", "N/m²", -math.inf, math.inf, "asymmetry of the spring",
            advice="push it in both directions with the same force", most=1e3, regressor=_square,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "k2·x²"
    source = "Helmholtz oscillator; Nayfeh & Mook, Nonlinear Oscillations, 1979, section 2.3"
    neutral = (("quadratic_stiffness", 0.0),)
    mirror = False
    needs_spring = True  # alone it pushes one way from everywhere, and nothing holds the cart
    ring_down = {SOFTENS: (-1, 1)}
    measured_by = "hang known masses on the spring, on either side, and read the encoder at rest"

    @staticmethod
    def force(x: float, quadratic_stiffness: float) -> float:
        """Force [N] against +x."""
        return quadratic_stiffness * x * x

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[AsymmetricSpring, ...]:
        """A twentieth of the largest force at the amplitude, either way."""
        size = 0.05 * typical.force(record, plant) / typical.amplitude(record) ** 2
        return cls(size), cls(-size)
