"""A spring with two slopes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, OUTSIDE, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class BilinearSpring(Effect):
    """A stiffness that is kb more beyond xb, seen from x = 0; around x = 0 it is k.

    Where one side is more than twice as stiff, it is a stop (``one_sided_stop``).
    """

    bend_position: float
    bend_stiffness: float

    name = "bilinear_spring"
    parameters = (
        Parameter("bend_position", "xb", "m", -math.inf, math.inf, "position from which on the stiffness is another"),
        Parameter("bend_stiffness", "kb", "N/m", -math.inf, math.inf, "stiffness beyond it less that around x = 0"),
    )
    prior_odds = 1.0 / 40.0
    acts_on = "force"
    law = "kb·(x - xb) beyond xb, seen from x = 0"
    source = "Shaw & Holmes 1983 (J. Sound Vib. 90): the piecewise linear oscillator"
    neutral = (("bend_stiffness", 0.0),)
    needs_spring = True
    piecewise_linear = True
    mirror = False
    knee = ("bend_position", "bend_stiffness", OUTSIDE)
    ring_down = {SOFTENS: (-1,), HARDENS: (1,)}

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {
            "bend_position": (-seen.reach, seen.reach),
            "bend_stiffness": (-1.5 * seen.stiffness, 1.5 * seen.stiffness),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[BilinearSpring, ...]:
        """A tenth stiffer or softer beyond the middle and the quarters of the travel."""
        places = np.quantile(record.position, (0.5, 0.25, 0.75))
        return tuple(cls(float(place), share * plant["stiffness"]) for place in places for share in (0.1, -0.1))
