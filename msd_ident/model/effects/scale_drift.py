"""A sensor whose scale changes with time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class ScaleDrift(Effect):
    """The reading is x·(1 + s·t): a sensor, or its supply, that warms up.

    A slow motion shows only F/k, which a spring that changes with time gives too.
    """

    scale_drift_rate: float

    name = "scale_drift"
    parameters = (
        Parameter(
            "scale_drift_rate", "s", "1/s", -math.inf, math.inf, "relative drift of the sensor's scale",
            advice="read the same two places, between fixed blocks, before and after",
        ),
    )  # fmt: skip
    acts_on = "sensor"
    law = "reading = x·(1 + s·t), t from where the used part of the record begins"
    source = "first order in time of a warming position sensor or of its supply"
    neutral = (("scale_drift_rate", 0.0),)
    mistaken_for = ("stiffness_drift", "sensor_drift")
    prior_odds = 1.0 / 40.0
    piecewise_linear = True
    steady = False
    measured_by = "move the cart between two fixed blocks, before and after an hour of running"

    @staticmethod
    def reading(t: float, x: float, scale_drift_rate: float) -> float:
        """What the sensor says [m]."""
        return x * (1.0 + scale_drift_rate * t)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"scale_drift_rate": (-0.9 / seen.duration, 5.0 / seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ScaleDrift, ...]:
        """Two per cent over the record, either way."""
        return cls(0.02 / record.duration), cls(-0.02 / record.duration)
