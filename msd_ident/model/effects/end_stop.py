"""Stops at both ends of the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import BOTH, HARDENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _beyond(x: Any, stop_position: float) -> Any:
    """Way beyond the stops [m], with its sign."""
    return np.sign(x) * np.maximum(np.abs(x) - stop_position, 0.0)


@dataclass(frozen=True)
class EndStop(Effect):
    """A spring of stiffness ks beyond xs, either side."""

    stop_position: float
    stop_stiffness: float

    name = "end_stop"
    parameters = (
        Parameter(
            "stop_position", "xs", "m", 0.0, math.inf, "distance of the stops from zero",
            advice="drive it into the stop", kinked=True,
        ),
        Parameter(
            "stop_stiffness", "ks", "N/m", 0.0, math.inf, "stiffness of the stops",
            advice="drive it into the stop", regressor=_beyond,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "ks·(x - xs) for x > xs, ks·(x + xs) for x < -xs"
    source = "penalty contact; Shaw & Holmes 1983 (J. Sound Vib. 90)"
    neutral = (("stop_stiffness", 0.0),)
    piecewise_linear = True
    ring_down = {HARDENS: (1,)}
    measured_by = "read the encoder with the cart pushed against the stop"
    knee = ("stop_position", "stop_stiffness", BOTH)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {
            "stop_position": (0.02 * seen.span, seen.reach + 0.2 * seen.span),
            "stop_stiffness": (0.0, 300.0 * max(seen.stiffness, seen.force / seen.span)),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[EndStop, ...]:
        """Stops within the last tenth and third of the travel, as stiff as the spring and ten times stiffer."""
        reach = float(np.max(np.abs(record.position)))
        stiffness = typical.force(record, plant) / typical.amplitude(record)
        return tuple(cls(share * reach, n * stiffness) for share in (0.95, 0.85, 0.65) for n in (1.0, 10.0))
