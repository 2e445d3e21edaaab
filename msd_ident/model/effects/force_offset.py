"""A constant force besides the commanded one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect, Parameter

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class ForceOffset(Effect):
    """F0 on the left-hand side: a tilted rail, a preload, a motor's bias."""

    offset_force: float

    name = "force_offset"
    parameters = (Parameter("offset_force", "F0", "N", -math.inf, math.inf, "constant force against +x"),)
    prior_odds = 1.0 / 10.0
    acts_on = "force"
    law = "F0"
    source = "Janot, Gautier, Brunot 2019 (EMPS benchmark): the drive's offset"
    neutral = (("offset_force", 0.0),)
    mirror = False
    piecewise_linear = True

    @staticmethod
    def constant(offset_force: float) -> float:
        """Force [N] against +x."""
        return offset_force

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ForceOffset, ...]:
        """A little either way; the surface has one valley."""
        return (cls(0.01 * typical.force(record, plant)),)
