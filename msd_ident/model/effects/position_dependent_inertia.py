"""Inertia that changes along the travel."""

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

#: Largest change of the inertia over the travel, as a part of it.
_MOST = 0.8


@dataclass(frozen=True)
class PositionDependentInertia(Effect):
    """m·(1 + a·x) in the place of m, on a spring: a crank, a linkage, a load that moves with the joint.

    Its kinetic energy is ½·m·(1 + a·x)·v², so that the speed pushes it to where the inertia is smaller. m is that at
    the relaxed spring; without a spring no place is told from another. The inertia is never below a tenth of m.
    """

    inertia_slope: float

    name = "position_dependent_inertia"
    parameters = (
        Parameter(
            "inertia_slope", "a", "1/m", -math.inf, math.inf, "change of the inertia along the travel",
            advice="move it at several frequencies: at one alone a spring that is stiffer one way does the same",
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "m·(1 + a·x)·x'' + ½·m·a·x'² in the place of m·x''"
    source = "Lagrange's equation of one coordinate; Featherstone 2008 (Rigid Body Dynamics Algorithms), chapter 3"
    neutral = (("inertia_slope", 0.0),)
    mirror = False
    needs_spring = True
    mistaken_for = ("asymmetric_spring", "sensor_nonlinearity")
    prior_odds = 1.0 / 40.0
    measured_by = "weigh or swing it at both ends of the travel"

    @staticmethod
    def contact(net: float, x: float, v: float, mass: float, inertia_slope: float) -> float:
        """Force [N] that gives the mass m the same acceleration."""
        return (net - 0.5 * mass * inertia_slope * v * v) / max(1.0 + inertia_slope * x, 0.1)

    @staticmethod
    def contact_at_rest(net: float) -> float:
        """What dry friction holds [N]: all of it."""
        return net

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``. The inertia stays positive all along the travel."""
        most = _MOST / seen.span
        return {"inertia_slope": (-most, most)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PositionDependentInertia, ...]:
        """A twentieth over the amplitude, either way."""
        del plant
        slope = 0.05 / typical.amplitude(record)
        return cls(slope), cls(-slope)
