"""A force whose gain changes along the travel."""

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
class PositionDependentGain(Effect):
    """F·(1 + a·x + c·x²) of a commanded F: a voice coil that leaves its magnet's gap, a solenoid, a crank.

    At rest a bent spring gives the same readings; the motion, and forces of both signs at one place, tell them apart.
    """

    gain_gradient: float
    gain_curvature: float

    name = "position_dependent_gain"
    parameters = (
        Parameter(
            "gain_gradient", "a", "1/m", -math.inf, math.inf, "relative change of the force's gain along x",
            advice="push the cart through the same place with forces of both signs",
        ),
        Parameter(
            "gain_curvature", "c", "1/m²", -math.inf, math.inf, "relative change of the force's gain with x²",
            advice="push the cart through the same place with forces of both signs",
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "F·(1 + a·x + c·x²)"
    source = "force factor Bl(x) of a voice coil; W. Klippel 2006, J. Audio Eng. Soc. 54(10)"
    neutral = (("gain_gradient", 0.0), ("gain_curvature", 0.0))
    prior_odds = 1.0 / 40.0
    mirror = False
    shows_zero = True
    measured_by = "clamp the cart at several places and read the force at one command with a load cell"

    @staticmethod
    def force(x: float, u: float, gain_gradient: float, gain_curvature: float) -> float:
        """Force [N] against +x."""
        return -u * x * (gain_gradient + gain_curvature * x)

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether any force acts."""
        return bool((record.force_at(record.time) != 0.0).any())

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """So far that the force never turns round along the travel."""
        first, second = 0.9 / seen.reach, 0.9 / seen.reach**2
        return {"gain_gradient": (-first, first), "gain_curvature": (-second, second)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PositionDependentGain, ...]:
        """Two per cent at the amplitude; the error has one minimum."""
        reach = typical.amplitude(record)
        return cls(0.0, -0.02 / reach**2), cls(0.02 / reach, 0.0)
