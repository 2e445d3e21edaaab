"""Damping that grows along the travel, faster and faster."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS, RUBS
from msd_ident.model.effects.position_dependent_damping import PositionDependentDamping

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class GrowingDamping(Effect):
    """bx·(exp(kappa·x) - 1)/kappa·v beside the plant's damping: without limit on one side, to nothing on the other."""

    damping_slope: float
    damping_growth: float

    name = "growing_damping"
    parameters = (
        *PositionDependentDamping.parameters,
        Parameter("damping_growth", "kappa", "1/m", -math.inf, math.inf, "relative growth of that change"),
    )
    acts_on = "force"
    law = "bx·(exp(kappa·x) - 1)/kappa·v"
    source = "a film or an air gap whose damping multiplies over each length: any that stays positive, near one place"
    neutral = (("damping_slope", 0.0),)
    form_of = "position_dependent_damping"
    prior_odds = 1.0 / 100.0
    mirror = False
    ring_down = {RUBS: (-1, 1), DRAGS: (-1, 1)}

    @staticmethod
    def force(x: float, v: float, damping_slope: float, damping_growth: float) -> float:
        """Force [N] against +x."""
        if damping_growth == 0.0:
            return damping_slope * x * v
        return damping_slope * math.expm1(damping_growth * x) / damping_growth * v

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Up to a damping twenty times as strong at one end of the motion as at the other."""
        most = 3.0 / seen.span
        return {**PositionDependentDamping.resolvable(seen), "damping_growth": (-most, most)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[GrowingDamping, ...]:
        """Around the guess of the simple law."""
        return tuple(
            one for simple in PositionDependentDamping.guess(record, plant)
            for one in cls.from_simple(simple, record, plant)
        )  # fmt: skip

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[GrowingDamping, ...]:
        """The change that was found, even, and growing or fading towards either side."""
        size = 0.5 / typical.amplitude(record)
        return tuple(cls(simple.values[0], way * size) for way in (0.0, 1.0, -1.0))
