"""A reading that drifts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class SensorDrift(Effect):
    """The reading is x + rate·t."""

    sensor_drift_rate: float

    name = "sensor_drift"
    parameters = (
        Parameter(
            "sensor_drift_rate", "rate", "m/s", -math.inf, math.inf, "drift of the position reading",
            advice="take a reading at rest before and after",
        ),
    )  # fmt: skip
    acts_on = "sensor"
    law = "reading = x + rate·t, t from where the used part of the record begins"
    source = "warming or slipping position sensor, first order in time"
    neutral = (("sensor_drift_rate", 0.0),)
    piecewise_linear = True
    mirror = False
    steady = False
    or_else = "a constant force on the spring that drifts (a load cell's zero)"
    measured_by = "read the encoder with the cart clamped for as long as an experiment takes"

    @staticmethod
    def reading(t: float, x: float, sensor_drift_rate: float) -> float:
        """What the sensor says [m]."""
        return x + sensor_drift_rate * t

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SensorDrift, ...]:
        """A hundredth of the amplitude over the record, either way."""
        rate = 0.01 * typical.amplitude(record) / record.duration
        return cls(rate), cls(-rate)
