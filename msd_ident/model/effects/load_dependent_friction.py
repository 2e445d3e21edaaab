"""Dry friction that grows with the load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.law import AT_ZERO, RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class LoadDependentFriction(Effect):
    """Fc + mu·abs(k·x) while sliding and at rest: the spring's force presses the slide, or the gear's teeth."""

    coulomb_force: float
    load_ratio: float

    name = "load_dependent_friction"
    parameters = (
        COULOMB_FORCE,
        Parameter("load_ratio", "mu", "1", 0.0, 0.9, "friction per force of the spring"),
    )
    prior_odds = 1.0 / 40.0
    acts_on = "force"
    law = "(Fc + mu·abs(k·x))·sign(v), k·x the force of the linear spring"
    source = "Coulomb 1785 with the spring's force as a part of the load"
    neutral = (("coulomb_force", 0.0), ("load_ratio", 0.0))
    family = "dry friction"
    dissipative = True
    shows_zero = True
    dry_limit = "coulomb_force"
    needs_spring = True
    knee = AT_ZERO
    ring_down = {RUBS: (1,)}

    @staticmethod
    def friction(spring_force: float, coulomb_force: float, load_ratio: float) -> float:
        """Kinetic friction [N]."""
        return coulomb_force + load_ratio * abs(spring_force)

    @staticmethod
    def breakaway(spring_force: float, coulomb_force: float, load_ratio: float) -> float:
        """Largest force [N] that it holds at rest."""
        return coulomb_force + load_ratio * abs(spring_force)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[LoadDependentFriction, ...]:
        """A few per cent of the largest force, constant and growing with the load in turn."""
        force = typical.force(record, plant)
        return cls(0.02 * force, 0.02), cls(0.002 * force, 0.05)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[LoadDependentFriction, ...]:
        """Half of the constant friction in the load, and a little."""
        share = force / typical.force(record, plant)
        return cls(0.5 * force, min(share, 0.5)), cls(force, 0.1 * min(share, 0.5))
