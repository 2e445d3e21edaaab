"""A spring that warms up and settles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class SettlingStiffness(Effect):
    """k·(1 + r·(1 - exp(-t/T))) in place of k."""

    settling_ratio: float
    settling_time: float

    name = "settling_stiffness"
    parameters = (
        Parameter("settling_ratio", "r", "1", -0.9, 10.0, "final relative change of the stiffness"),
        Parameter("settling_time", "T", "s", 1e-9, math.inf, "time in which the stiffness settles"),
    )
    acts_on = "force"
    needs_spring = True
    law = "k·(1 + r·(1 - exp(-t/T))), t from where the used part of the record begins"
    source = "first-order warming or relaxation of a spring"
    neutral = (("settling_ratio", 0.0),)
    form_of = "stiffness_drift"
    prior_odds = 1.0 / 100.0
    steady = False
    ring_down = {SOFTENS: (1,), HARDENS: (-1,)}

    @staticmethod
    def force(t: float, spring_force: float, settling_ratio: float, settling_time: float) -> float:
        """Force [N] against +x beyond that of the spring at time 0."""
        return spring_force * settling_ratio * (1.0 - math.exp(-t / settling_time))

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"settling_ratio": (-0.9, 5.0), "settling_time": (0.02 * seen.duration, 2.0 * seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SettlingStiffness, ...]:
        """Two per cent in a fifth of the record, either way."""
        return tuple(cls(change, 0.2 * record.duration) for change in (0.02, -0.02))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[SettlingStiffness, ...]:
        """The change of the steady drift over the record, in a seventh and in a half of it."""
        change = min(max(simple.values[0] * record.duration, -0.8), 4.0)
        return tuple(cls(change, share * record.duration) for share in (0.15, 0.5))
