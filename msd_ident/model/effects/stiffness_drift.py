"""A spring that changes with time."""

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
class StiffnessDrift(Effect):
    """k·(1 + r·t) in place of k: heating, creep."""

    stiffness_drift_rate: float

    name = "stiffness_drift"
    parameters = (
        Parameter(
            "stiffness_drift_rate", "r", "1/s", -math.inf, math.inf, "relative drift of the stiffness",
            advice="repeat the first record last",
        ),
    )  # fmt: skip
    acts_on = "force"
    needs_spring = True
    law = "k·(1 + r·t), t from where the used part of the record begins"
    source = "first order in time of a heating or creeping spring"
    neutral = (("stiffness_drift_rate", 0.0),)
    steady = False
    ring_down = {SOFTENS: (1,), HARDENS: (-1,)}
    measured_by = "repeat the first record after an hour of running"

    @staticmethod
    def force(t: float, spring_force: float, stiffness_drift_rate: float) -> float:
        """Force [N] against +x beyond that of the spring at time 0."""
        return spring_force * stiffness_drift_rate * t

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"stiffness_drift_rate": (-0.9 / seen.duration, 5.0 / seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[StiffnessDrift, ...]:
        """Two per cent over the record, either way."""
        return cls(0.02 / record.duration), cls(-0.02 / record.duration)
