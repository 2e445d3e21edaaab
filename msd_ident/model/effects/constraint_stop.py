"""End stops as physics engines make them: a soft constraint, which takes over from all other forces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.buffered_stop import BufferedStop, off_the_middle
from msd_ident.model.effects.law import DRAGS, HARDENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Largest part of the other forces: at 1 they would count for nothing, and no force would hold the mass in the stop.
_MOST = 0.999
#: Part that a fit starts from: by default MuJoCo's impedance (``solimp``) goes from 0.9 to 0.95.
_USUAL = 0.93


@dataclass(frozen=True)
class ConstraintStop(Effect):
    """ks·d + cs·d' + r·F at a depth d beyond xc + xs or xc - xs, where that pushes; F is the sum of all other forces
    into the stop, of which 1 - r is left.

    The mass swings on the stop as on ks, and rests in it as on ks/(1 - r). One stop alone is a pair the other of which
    is out of reach.
    """

    buffer_centre: float
    buffer_reach: float
    buffer_stiffness: float
    buffer_damping: float
    constraint_share: float

    name = "constraint_stop"
    parameters = (
        *BufferedStop.parameters,
        Parameter("constraint_share", "r", "1", 0.0, _MOST, "part of all other forces that the stops take"),
    )
    acts_on = "force"
    law = "max(ks·d + cs·d' + r·F, 0) at a depth d beyond xc + xs or xc - xs; F: all other forces into the stop"
    source = "soft constraint; Todorov 2014 (IEEE ICRA); MuJoCo's solref and solimp"
    neutral = (*BufferedStop.neutral, ("constraint_share", 0.0))
    form_of = "end_stop"
    prior_odds = 1.0 / 100.0
    mirror = False
    jumps = True
    knee = BufferedStop.knee
    ring_down = {HARDENS: (1,), DRAGS: (0, 1)}

    @staticmethod
    def contact(
        net: float,
        x: float,
        v: float,
        piece_x: float,
        buffer_centre: float,
        buffer_reach: float,
        buffer_stiffness: float,
        buffer_damping: float,
        constraint_share: float,
    ) -> float:
        """Net force [N] towards +x, of one that has the stops' springs in it already."""
        off = x - buffer_centre
        side = 1.0 if off > 0.0 else -1.0
        if side * (piece_x - buffer_centre) <= buffer_reach:
            return net
        spring = buffer_stiffness * (side * off - buffer_reach)
        others = side * net + spring
        return side * (others - max(spring + side * buffer_damping * v + constraint_share * others, 0.0))

    @staticmethod
    def grip(
        net: float,
        x: float,
        v: float,
        piece_x: float,
        buffer_centre: float,
        buffer_reach: float,
        buffer_stiffness: float,
        buffer_damping: float,
        constraint_share: float,
    ) -> float:
        """What the stop pushes with [N], into the free travel, in contact; below 0 it lets go."""
        off = x - buffer_centre
        side = 1.0 if off > 0.0 else -1.0
        if side * (piece_x - buffer_centre) <= buffer_reach:
            return 1.0
        spring = buffer_stiffness * (side * off - buffer_reach)
        return spring + side * buffer_damping * v + constraint_share * (side * net + spring)

    @staticmethod
    def contact_at_rest(
        net: float,
        x: float,
        buffer_centre: float,
        buffer_reach: float,
        buffer_stiffness: float,
        constraint_share: float,
    ) -> float:
        """What dry friction holds [N] of such a force at rest: the stop takes its part of the friction too."""
        off = x - buffer_centre
        side = 1.0 if off > 0.0 else -1.0
        spring = buffer_stiffness * max(side * off - buffer_reach, 0.0)
        return net - side * spring * constraint_share / (1.0 - constraint_share)

    def same_as(self, model: Model) -> str:
        """As of a buffered stop."""
        return off_the_middle(model, self.buffer_centre, self.buffer_reach)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return BufferedStop.resolvable(seen)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ConstraintStop, ...]:
        """Those of buffered stops, with the usual part of the other forces."""
        return tuple(cls.within_bounds(*buffer.values, _USUAL) for buffer in BufferedStop.guess(record, plant))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[ConstraintStop, ...]:
        """The same stops; softer in motion, about zero, one of them alone, between the ends of the motion."""
        place, stiffness = simple.values
        low, high = float(np.min(record.position)), float(np.max(record.position))
        depth = max(max(high, -low) - place, 0.0)
        middle, half, aside = 0.5 * (low + high), 0.5 * (high - low), 0.25 * (high - low)
        places = ((0.0, place), (middle, half - depth), (-aside, place + aside), (aside, place + aside))
        starts = [cls.within_bounds(0.0, place, stiffness, 0.0, 0.0)]
        for softer, ratio in ((0.7, 0.1), (0.2, 1.0)):
            damping = 2.0 * ratio * math.sqrt(max(softer * stiffness, 1e-9) * plant.mass)
            starts += [cls.within_bounds(c, max(r, 0.0), softer * stiffness, damping, _USUAL) for c, r in places]
        return tuple(starts)
