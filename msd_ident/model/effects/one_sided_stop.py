"""A stop at one end of the way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, OUTSIDE

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class OneSidedStop(Effect):
    """A spring of stiffness ks beyond xs, on the side of zero on which xs lies; stiffer than the plant's own spring.

    A weaker one is a spring with two slopes (``bilinear_spring``).
    """

    one_stop_position: float
    one_stop_stiffness: float

    name = "one_sided_stop"
    parameters = (
        Parameter("one_stop_position", "xs", "m", -math.inf, math.inf, "position of the stop"),
        Parameter("one_stop_stiffness", "ks", "N/m", 0.0, math.inf, "stiffness of the stop"),
    )
    acts_on = "force"
    law = "ks·(x - xs) beyond xs: for x > xs > 0, or for x < xs < 0"
    source = "penalty contact; Shaw & Holmes 1983 (J. Sound Vib. 90), who have it on one side"
    neutral = (("one_stop_stiffness", 0.0),)
    form_of = "end_stop"
    stands_alone = True
    prior_odds = 1.0 / 20.0
    piecewise_linear = True
    mirror = False
    knee = ("one_stop_position", "one_stop_stiffness", OUTSIDE)
    ring_down = {HARDENS: (1,)}

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        stiffness = max(seen.stiffness, seen.force / seen.span)
        return {
            "one_stop_position": (-seen.reach - 0.2 * seen.span, seen.reach + 0.2 * seen.span),
            "one_stop_stiffness": (seen.stiffness, 300.0 * stiffness),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[OneSidedStop, ...]:
        """On either side, within the last tenth and the last third of the travel."""
        low, high = float(np.min(record.position)), float(np.max(record.position))
        stiffness = typical.force(record, plant) / typical.amplitude(record)
        ends = [end for end in (high, low) if abs(end) > 0.1 * (high - low)]
        places = [share * end for share in (0.93, 0.75, 0.5) for end in ends]
        return tuple(cls(place, n * stiffness) for place in places for n in (2.0, 10.0))
