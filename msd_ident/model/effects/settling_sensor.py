"""A reading that drifts and settles."""

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
class SettlingSensor(Effect):
    """The reading is x + A·(1 - exp(-t/T))."""

    sensor_settling: float
    sensor_settling_time: float

    name = "settling_sensor"
    parameters = (
        Parameter("sensor_settling", "A", "m", -math.inf, math.inf, "final drift of the reading"),
        Parameter("sensor_settling_time", "T", "s", 1e-9, math.inf, "time in which the reading settles"),
    )
    acts_on = "sensor"
    law = "reading = x + A·(1 - exp(-t/T)), t from where the used part of the record begins"
    source = "position sensor that warms up, first order"
    neutral = (("sensor_settling", 0.0),)
    form_of = "sensor_drift"
    prior_odds = 1.0 / 100.0
    piecewise_linear = True
    mirror = False
    steady = False

    @staticmethod
    def reading(t: float, x: float, sensor_settling: float, sensor_settling_time: float) -> float:
        """What the sensor says [m]."""
        return x + sensor_settling * (1.0 - math.exp(-t / sensor_settling_time))

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"sensor_settling_time": (0.02 * seen.duration, 2.0 * seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SettlingSensor, ...]:
        """A hundredth of the amplitude in a fifth of the record, either way."""
        drift = 0.01 * typical.amplitude(record)
        return cls(drift, 0.2 * record.duration), cls(-drift, 0.2 * record.duration)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[SettlingSensor, ...]:
        """The steady drift over the record, in a seventh and in a half of it."""
        return tuple(cls(simple.values[0] * record.duration, share * record.duration) for share in (0.15, 0.5))
