"""An actuator that does nothing with a small command."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class ForceDeadZone(Effect):
    """The force is what the command exceeds d by."""

    dead_zone: float

    name = "force_dead_zone"
    parameters = (Parameter("dead_zone", "d", "N", 0.0, math.inf, "largest command without effect, either direction"),)
    acts_on = "input"
    law = "F - d·sign(F) where abs(F) > d, else 0"
    source = "valve overlap, motor driver with a threshold; Tao & Kokotovic 1994 (IEEE Trans. Automat. Contr. 39)"
    neutral = (("dead_zone", 0.0),)
    form_of = "force_gain_nonlinearity"
    stands_alone = True
    prior_odds = 1.0 / 40.0
    piecewise_linear = True

    @staticmethod
    def input_map(u: float, dead_zone: float) -> float:
        """Force [N] that a commanded u [N] becomes."""
        if u > dead_zone:
            return u - dead_zone
        if u < -dead_zone:
            return u + dead_zone
        return 0.0

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether it pushes with several levels: with one, a dead zone is a gain."""
        return np.unique(np.abs(np.round(record.force, 12))).size > 2

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"dead_zone": (0.0, 0.9 * seen.force)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ForceDeadZone, ...]:
        """Three and ten per cent of the largest command."""
        del plant
        largest = max(float(np.max(np.abs(record.force))), 1e-9)
        return cls(0.03 * largest), cls(0.1 * largest)

    @classmethod
    def moving_as(cls, other: Effect, model: Model) -> Effect | None:
        """Dry friction without a spring: the speed follows from what the command exceeds it by, b·v = F - d·sign(F)."""
        return cls(other.holding) if other.holding > 0.0 and model.stiffness == 0.0 else None
