"""A spring that changes with time, not steadily."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, SOFTENS
from msd_ident.model.effects.stiffness_drift import StiffnessDrift

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class CurvedStiffnessDrift(Effect):
    """k·(1 + r·t + r2·t² + r3·t³) in place of k: it rises and falls with the temperature of a room, or of a motor that
    works and rests.
    """

    stiffness_drift_rate: float
    stiffness_drift_curvature: float
    stiffness_drift_turn: float

    name = "curved_stiffness_drift"
    parameters = (
        *StiffnessDrift.parameters,
        Parameter("stiffness_drift_curvature", "r2", "1/s²", -math.inf, math.inf, "second-order drift of stiffness"),
        Parameter("stiffness_drift_turn", "r3", "1/s³", -math.inf, math.inf, "third-order drift of stiffness"),
    )
    acts_on = "force"
    needs_spring = True
    law = "k·(1 + r·t + r2·t² + r3·t³), t from where the used part of the record begins"
    source = "third order in time of a stiffness that changes slowly"
    neutral = (("stiffness_drift_rate", 0.0), ("stiffness_drift_curvature", 0.0), ("stiffness_drift_turn", 0.0))
    form_of = "stiffness_drift"
    stands_alone = True
    prior_odds = 1.0 / 100.0
    steady = False
    ring_down = {SOFTENS: (-1, 0, 1), HARDENS: (-1, 0, 1)}

    @staticmethod
    def force(
        t: float,
        spring_force: float,
        stiffness_drift_rate: float,
        stiffness_drift_curvature: float,
        stiffness_drift_turn: float,
    ) -> float:
        """Force [N] against +x beyond that of the spring at time 0."""
        return spring_force * t * (stiffness_drift_rate + t * (stiffness_drift_curvature + t * stiffness_drift_turn))

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Each term alone up to a few times the stiffness at the record's end."""
        names = (parameter.name for parameter in cls.parameters)
        most = (5.0 / seen.duration**power for power in (1, 2, 3))
        return {name: (-size, size) for name, size in zip(names, most, strict=True)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[CurvedStiffnessDrift, ...]:
        """Two per cent more in the middle than at both ends; the error has one minimum."""
        rate = 0.08 / record.duration
        return (cls(rate, -rate / record.duration, 0.0),)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[CurvedStiffnessDrift, ...]:
        """The steady drift that was found."""
        return (cls(simple.values[0], 0.0, 0.0),)
