"""End stops with buffers: a spring and a damper side by side, each stop at a place of its own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS, HARDENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Distance of the stops' middle from the relaxed spring that is none, in parts of their reach.
_MIDDLE = 0.01


def off_the_middle(model: Model, centre: float, reach: float) -> str:
    """A sentence: what stops are the same as whose middle is off the relaxed spring; empty where it is not.

    Args:
        model: with the stops.
        centre: their middle, from the relaxed spring [m].
        reach: their distance from the middle [m].
    """
    beside = model.stiffness > 0.0 and "force_offset" not in model.effect_names
    if not beside or abs(centre) < _MIDDLE * reach:
        return ""
    return (
        "End stops whose middle is off the relaxed spring are the same as stops about it beside a force offset of "
        "k·xc: read the encoder with the spring relaxed to tell them apart."
    )


@dataclass(frozen=True)
class BufferedStop(Effect):
    """ks·d + cs·d' at a depth d beyond xc + xs or xc - xs, where that pushes: a buffer lets go, it does not pull.

    One stop alone is a pair the other of which is out of reach.
    """

    buffer_centre: float
    buffer_reach: float
    buffer_stiffness: float
    buffer_damping: float

    name = "buffered_stop"
    parameters = (
        Parameter("buffer_centre", "xc", "m", -math.inf, math.inf, "middle between the stops' buffers"),
        Parameter("buffer_reach", "xs", "m", 0.0, math.inf, "distance of the buffers from there"),
        Parameter("buffer_stiffness", "ks", "N/m", 0.0, math.inf, "stiffness of the buffers"),
        Parameter("buffer_damping", "cs", "N·s/m", 0.0, math.inf, "damping of the buffers"),
    )
    acts_on = "force"
    law = "max(ks·d + cs·d', 0) at a depth d beyond xc + xs or xc - xs"
    source = "Kelvin-Voigt contact without tension; Gilardi & Sharf 2002 (Mech. Mach. Theory 37)"
    neutral = (("buffer_stiffness", 0.0), ("buffer_damping", 0.0))
    form_of = "end_stop"
    prior_odds = 1.0 / 100.0
    mirror = False
    jumps = True
    knee = ("buffer_centre", "buffer_stiffness", "buffer_reach")
    ring_down = {HARDENS: (1,), DRAGS: (0, 1)}

    @staticmethod
    def force(
        x: float,
        v: float,
        piece_x: float,
        buffer_centre: float,
        buffer_reach: float,
        buffer_stiffness: float,
        buffer_damping: float,
    ) -> float:
        """Force [N] against +x beyond that of the buffers' springs."""
        off = x - buffer_centre
        side = 1.0 if off > 0.0 else -1.0
        if side * (piece_x - buffer_centre) <= buffer_reach:
            return 0.0
        spring = buffer_stiffness * (side * off - buffer_reach)
        return side * (max(spring + side * buffer_damping * v, 0.0) - spring)

    @staticmethod
    def grip(
        x: float,
        v: float,
        piece_x: float,
        buffer_centre: float,
        buffer_reach: float,
        buffer_stiffness: float,
        buffer_damping: float,
    ) -> float:
        """Force [N] of spring and damper together, into the free travel, in contact: below 0 the buffer lets go."""
        off = x - buffer_centre
        side = 1.0 if off > 0.0 else -1.0
        if side * (piece_x - buffer_centre) <= buffer_reach:
            return 1.0
        return buffer_stiffness * (side * off - buffer_reach) + side * buffer_damping * v

    def same_as(self, model: Model) -> str:
        """Stops about the relaxed spring beside a force offset, where the stops' middle is off it."""
        return off_the_middle(model, self.buffer_centre, self.buffer_reach)

    def simple_values(self) -> dict[str, float]:
        """Stops about the relaxed spring that are as far apart and as stiff, without damping."""
        return {"stop_position": self.buffer_reach, "stop_stiffness": self.buffer_stiffness}

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        stiffness = max(seen.stiffness, seen.force / seen.span)
        return {
            "buffer_centre": (-0.6 * seen.span, 0.6 * seen.span),
            "buffer_reach": (0.02 * seen.span, 1.2 * seen.reach + 0.2 * seen.span),
            "buffer_stiffness": (0.0, 300.0 * stiffness),
            "buffer_damping": (0.0, 100.0 * math.sqrt(stiffness * seen.mass)),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[BufferedStop, ...]:
        """Buffers on both sides or on either, ten times as stiff as the spring and damped half as much as they may."""
        low, high = float(np.min(record.position)), float(np.max(record.position))
        span = high - low
        stiffness = 10.0 * typical.force(record, plant) / typical.amplitude(record)
        damping = math.sqrt(stiffness * plant.mass)
        sides = ((low + 0.1 * span, high - 0.1 * span), (low - 0.3 * span, high - 0.1 * span),
                 (low + 0.1 * span, high + 0.3 * span))  # fmt: skip
        return tuple(cls(0.5 * (a + b), 0.5 * (b - a), stiffness, damping) for a, b in sides)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[BufferedStop, ...]:
        """The same stops without damping, with some, with much; between the ends of the motion; one of them alone."""
        place, stiffness = simple.values
        damping = math.sqrt(max(stiffness, 1e-9) * plant.mass)
        low, high = float(np.min(record.position)), float(np.max(record.position))
        depth = max(max(high, -low) - place, 0.0)
        middle, half, aside = 0.5 * (low + high), 0.5 * (high - low), 0.25 * (high - low)
        places = [(0.0, place, 0.0), (0.0, place, 0.1), (0.0, place, 1.0)]
        places += [(middle, half - depth, 0.3), (middle, half - 0.5 * depth, 1.0)]
        places += [(-aside, place + aside, 0.5), (aside, place + aside, 0.5)]
        return tuple(cls.within_bounds(c, max(r, 0.0), stiffness, n * damping) for c, r, n in places)
