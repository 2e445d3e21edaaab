"""An actuator whose gain changes with time."""

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
class GainDrift(Effect):
    """F·(1 + g·t) of a commanded F: a drive that heats up, a battery that falls.

    A slow motion shows only F/k, which a spring that changes with time gives too.
    """

    gain_drift_rate: float

    name = "gain_drift"
    parameters = (
        Parameter(
            "gain_drift_rate", "g", "1/s", -math.inf, math.inf, "relative drift of the force's gain",
            advice="release the cart by hand before and after: a spring that changes shows in the frequency",
        ),
    )  # fmt: skip
    acts_on = "input"
    law = "F·(1 + g·t), t from where the used part of the record begins"
    source = "first order in time of a drive that heats up or of a supply that falls"
    neutral = (("gain_drift_rate", 0.0),)
    mistaken_for = ("stiffness_drift",)
    piecewise_linear = True
    steady = False
    measured_by = "read the force at rest with a load cell at one command, before and after an hour of running"

    @staticmethod
    def input_map(u: float, t: float, gain_drift_rate: float) -> float:
        """Force [N] that a commanded u [N] becomes."""
        return u * (1.0 + gain_drift_rate * t)

    def keeps_gain(self) -> bool:
        """It changes the gain at every command."""
        return False

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"gain_drift_rate": (-0.9 / seen.duration, 5.0 / seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[GainDrift, ...]:
        """Two per cent over the record, either way."""
        return cls(0.02 / record.duration), cls(-0.02 / record.duration)
