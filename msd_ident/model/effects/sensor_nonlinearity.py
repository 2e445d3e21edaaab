"""A sensor whose scale is bent."""

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
class SensorNonlinearity(Effect):
    """The reading is x + q·x² + c·x³: an LVDT, a Hall sensor or a potentiometer near the ends of its range.

    At rest a bent spring, and a gain that depends on the force, give the same readings; the motion tells them apart.
    """

    sensor_curvature: float
    sensor_cubic: float

    name = "sensor_nonlinearity"
    parameters = (
        Parameter(
            "sensor_curvature", "q", "1/m", -math.inf, math.inf, "bend of the sensor's scale, one way",
            advice="read known places, between fixed blocks",
        ),
        Parameter(
            "sensor_cubic", "c", "1/m²", -math.inf, math.inf, "bend of the sensor's scale, either way alike",
            advice="read known places, between fixed blocks",
        ),
    )  # fmt: skip
    acts_on = "sensor"
    law = "reading = x + q·x² + c·x³"
    source = "third order of a sensor's static curve about the relaxed spring"
    neutral = (("sensor_curvature", 0.0), ("sensor_cubic", 0.0))
    mistaken_for = ("force_gain_nonlinearity", "sensor_eccentricity", "cubic_spring", "asymmetric_spring")
    prior_odds = 1.0 / 40.0
    piecewise_linear = True
    mirror = False
    measured_by = "hold the cart at known places, against blocks of known length, and read the encoder"

    @staticmethod
    def reading(x: float, sensor_curvature: float, sensor_cubic: float) -> float:
        """What the sensor says [m]."""
        return x + x * x * (sensor_curvature + sensor_cubic * x)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """So far that a longer way still gives a larger reading."""
        square, cube = 0.25 / seen.reach, 0.15 / seen.reach**2
        return {"sensor_curvature": (-square, square), "sensor_cubic": (-cube, cube)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SensorNonlinearity, ...]:
        """A hundredth of the way at the amplitude, bent either way alike, or one way; the error has one minimum."""
        reach = typical.amplitude(record)
        return (*(cls(0.0, 0.01 * sign / reach**2) for sign in (-1.0, 1.0)), cls(0.01 / reach, 0.0))
