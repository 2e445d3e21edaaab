"""Force and position stamps that differ."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DELAY

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _longest(duration: float, period: float) -> float:
    """A quarter of the record [s]: beyond, too little of the force is left to fall on the motion."""
    del period
    return 0.25 * duration


@dataclass(frozen=True)
class TimeOffset(Effect):
    """The force acts D later than its stamps say; D may be negative."""

    time_offset: float

    name = "time_offset"
    parameters = (
        Parameter(
            "time_offset", "D", "s", -math.inf, math.inf, "delay of the force against its stamps",
            advice="add a sweep to well above resonance", ceiling=_longest,
        ),
    )  # fmt: skip
    acts_on = "input"
    law = "F(t - D)"
    source = "clocks of two publishers; transport delay"
    neutral = (("time_offset", 0.0),)
    piecewise_linear = True
    structure = DELAY
    measured_by = "bring one edge to both channels at once, or let one clock stamp force and position"

    def same_as(self, model: Model) -> str:
        """Whose delay it is, the stamps do not say."""
        del model
        return (
            "A delay of the force, of the encoder's stamps or between two clocks is one and the same time_offset; a "
            "filter of the readings or of the drive looks like one where it is faster than the motion."
        )

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"time_offset": (-0.05 * seen.duration, 0.05 * seen.duration)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[TimeOffset, ...]:
        """A sample and a fortieth of a swing, either way: with a swinging plant the error has several minima."""
        swing = 2.0 * math.pi / typical.natural_frequency(record, plant)
        steps = (0.7 * record.period, max(3.0 * record.period, 0.025 * swing))
        return tuple(cls(sign * step) for step in steps for sign in (1.0, -1.0))
