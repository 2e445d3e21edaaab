"""Dry friction of constant size."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _direction(direction: Any) -> Any:
    """It is proportional to the direction of the motion."""
    return direction


COULOMB_FORCE = Parameter(
    "coulomb_force", "Fc", "N", 0.0, math.inf, "kinetic dry friction",
    advice="let it ring down from a larger amplitude until it stops",
    holds=True, kinked=True, regressor=_direction,
)  # fmt: skip


@dataclass(frozen=True)
class CoulombFriction(Effect):
    """Fc against the motion; at rest it holds against any force up to Fc."""

    coulomb_force: float

    name = "coulomb_friction"
    parameters = (COULOMB_FORCE,)
    acts_on = "force"
    law = "Fc·sign(v), with sticking at v = 0"
    source = "C. A. Coulomb 1785; equation 2 of the 2014 report, Fc = µ·m·g"
    neutral = (("coulomb_force", 0.0),)
    family = "dry friction"
    eponym = "Coulomb"
    dissipative = True
    piecewise_linear = True
    prior_odds = 1.0
    ring_down = {RUBS: (1,)}
    measured_by = "pull the cart slowly with a spring balance and read the force at which it moves, and moves on"

    @staticmethod
    def friction(coulomb_force: float) -> float:
        """Kinetic friction [N]."""
        return coulomb_force

    @staticmethod
    def breakaway(coulomb_force: float) -> float:
        """Largest force [N] that it holds at rest."""
        return coulomb_force

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[CoulombFriction, ...]:
        """One and five per cent of the largest force at work."""
        force = typical.force(record, plant)
        return cls(0.02 * force), cls(0.1 * force)
