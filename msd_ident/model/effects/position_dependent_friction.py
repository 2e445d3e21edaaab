"""Dry friction that changes along the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class PositionDependentFriction(Effect):
    """Coulomb friction that grows or falls along x: a guide that is not parallel, a seal worn at one end."""

    coulomb_force: float
    position_friction_slope: float

    name = "position_dependent_friction"
    parameters = (
        COULOMB_FORCE,
        Parameter("position_friction_slope", "a", "1/m", -math.inf, math.inf, "relative change of friction along x"),
    )
    prior_odds = 1.0 / 40.0
    acts_on = "force"
    law = "Fc·(1 + a·x)·sign(v), nowhere below 0"
    source = "Coulomb friction with the normal force linear in x"
    neutral = (("coulomb_force", 0.0),)
    family = "dry friction"
    dissipative = True
    mirror = False
    dry_limit = "coulomb_force"
    ring_down = {RUBS: (1,)}
    measured_by = "pull the cart slowly through its travel with a spring balance"

    @staticmethod
    def friction(x: float, coulomb_force: float, position_friction_slope: float) -> float:
        """Kinetic friction [N]."""
        return coulomb_force * max(1.0 + position_friction_slope * x, 0.0)

    @staticmethod
    def breakaway(x: float, coulomb_force: float, position_friction_slope: float) -> float:
        """Largest force [N] that it holds at rest."""
        return coulomb_force * max(1.0 + position_friction_slope * x, 0.0)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"position_friction_slope": (-10.0 / seen.span, 10.0 / seen.span)}

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[PositionDependentFriction, ...]:
        """The same everywhere."""
        del record, plant
        return (cls(force, 0.0),)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PositionDependentFriction, ...]:
        """Friction growing and falling by a third over the amplitude."""
        force, slope = 0.05 * typical.force(record, plant), 0.3 / typical.amplitude(record)
        return cls(force, slope), cls(force, -slope)
