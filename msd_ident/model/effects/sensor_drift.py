"""A reading that drifts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _held(other: Effect, model: Model) -> tuple[float, float]:
    """How far a constant force holds the cart away [m], and the rate [1/s] of the model's stiffness drift."""
    offset: float = getattr(other, "offset_force", 0.0)
    aging = math.fsum(getattr(effect, "stiffness_drift_rate", 0.0) for effect in model.effects)
    return offset / model.stiffness if model.stiffness > 0.0 else 0.0, aging


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
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """A constant force beside a stiffness that drifts (see ``ForceOffset.in_place_of``): r·F0/k."""
        place, aging = _held(other, model)
        if place * aging == 0.0:
            return None
        rest = tuple(effect for effect in model.effects if effect.name not in (other.name, cls.name))
        return replace(model, effects=(*rest, cls(place * aging)))

    def zero_in(self, model: Model) -> float:
        """The place of rest, where the constant force is taken for none."""
        return -math.fsum(_held(effect, model)[0] for effect in model.effects)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SensorDrift, ...]:
        """A hundredth of the amplitude over the record, either way."""
        rate = 0.01 * typical.amplitude(record) / record.duration
        return cls(rate), cls(-rate)
