"""A reading that follows the force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Largest part of the reading's range that it makes.
_MOST = 0.5
#: Part of the force's variance that a line over the reading explains, from which on the law is a scale of that.
_A_SCALE = 0.99


@dataclass(frozen=True)
class FrameCompliance(Effect):
    """The reading is x + c·F: the frame with the sensor gives way under the drive, or the drive's current is heard.

    F is the force that arrives at the cart. A light first mass before a second one moves nearly alike.
    """

    frame_compliance: float

    name = "frame_compliance"
    parameters = (
        Parameter(
            "frame_compliance", "c", "m/N", -math.inf, math.inf, "change of the reading per force",
            advice="make the force jump: the reading jumps at once, before the mass can move",
        ),
    )  # fmt: skip
    acts_on = "sensor"
    law = "reading = x + c·F"
    source = "compliance of a testing machine's frame: its displacement reading has a part in proportion to the load"
    neutral = (("frame_compliance", 0.0),)
    prior_odds = 1.0 / 40.0
    piecewise_linear = True
    measured_by = "clamp the cart, step the force, and read the encoder"

    @staticmethod
    def reading(x: float, u: float, frame_compliance: float) -> float:
        """What the sensor says [m]."""
        return x + frame_compliance * u

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether a force acts that changes, and does not fall as the reading rises: under a proportional controller
        with one setpoint x + c·F is nothing but another scale of the reading.
        """
        levels = record.force_at(record.time)
        if not (np.ptp(levels) > 0.0 and np.ptp(record.position) > 0.0):
            return False
        return float(np.corrcoef(levels, record.position)[0, 1]) > -math.sqrt(_A_SCALE)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        most = _MOST * seen.span / seen.force if seen.force > 0.0 else math.inf
        return {"frame_compliance": (-most, most)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[FrameCompliance, ...]:
        """A hundredth of the amplitude at the largest force; the error has one minimum."""
        return (cls(0.01 * typical.amplitude(record) / typical.force(record, plant)),)
