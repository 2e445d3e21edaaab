"""Damping that changes along the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class PositionDependentDamping(Effect):
    """bx·x·v beside the plant's damping: a film that gets thinner, a magnet that covers more of its plate."""

    damping_slope: float

    name = "position_dependent_damping"
    parameters = (
        Parameter(
            "damping_slope", "bx", "N·s/m²", -math.inf, math.inf, "change of the viscous damping along the travel",
            advice="let it ring down about two rest positions",
        ),
    )  # fmt: skip
    prior_odds = 1.0 / 100.0
    acts_on = "force"
    law = "bx·x·v"
    source = "first order in x of a squeeze film or of an eddy-current brake"
    neutral = (("damping_slope", 0.0),)
    mirror = False
    measured_by = "let it ring down about another rest position: tilt the rig, or move the spring's end"

    @staticmethod
    def force(x: float, v: float, damping_slope: float) -> float:
        """Force [N] against +x."""
        return damping_slope * x * v

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """As strong at the ends of the motion as a damping that stops it within a swing."""
        most = 2.0 * seen.mass * seen.rate / seen.span
        return {"damping_slope": (-most, most)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PositionDependentDamping, ...]:
        """Half of the plant's damping more on one side than in the middle; the error has one minimum."""
        natural = 0.02 * plant["mass"] * typical.natural_frequency(record, plant)
        return (cls(0.5 * max(plant["damping"], natural) / typical.amplitude(record)),)
