"""A reading that drifts and settles."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class SettlingSensor(Effect):
    """The reading is x + A·(1 - exp(-t/T)).

    Over one decay a spring that relaxes moves alike. Of both, this is held to be the likelier: it leaves the plant as
    it is.
    """

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
    prior_odds = 1.0 / 40.0
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
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """Over one decay a spring that relaxes adds c/T to the plant's k and lets the place of rest settle in
        T·(k + c/T)/k. How far it moves depends on the record: a fit begins without any.
        """
        settling = cls.moving_as(other, model)
        if settling is None:
            return None
        damping, time = other.values
        others = tuple(effect for effect in model.effects if effect is not other and effect.cause() != cls.form_of)
        return replace(model, stiffness=model.stiffness + damping / time, effects=(*others, settling))

    @classmethod
    def moving_as(cls, other: Effect, model: Model) -> SettlingSensor | None:
        """Its time; the motion is the same only where the rest is fitted too."""
        if other.creeps_as != cls.name or not (model.stiffness > 0.0 and other.values[1] > 0.0):
            return None
        damping, time = other.values
        return cls.within_bounds(0.0, time + damping / model.stiffness)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[SettlingSensor, ...]:
        """The steady drift over the record, in a seventh and in a half of it."""
        return tuple(cls(simple.values[0] * record.duration, share * record.duration) for share in (0.15, 0.5))
