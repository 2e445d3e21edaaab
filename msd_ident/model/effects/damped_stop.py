"""Stops that take energy out of the motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.law import DRAGS, HARDENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class DampedStop(Effect):
    """A spring of stiffness ks beyond xs, either side, whose force grows with the speed of contact (Hunt-Crossley)."""

    stop_position: float
    stop_stiffness: float
    stop_damping: float

    name = "damped_stop"
    parameters = (
        *EndStop.parameters,
        Parameter("stop_damping", "cs", "s/m", 0.0, math.inf, "relative growth of the stop's force with the speed"),
    )
    acts_on = "force"
    law = "ks·d·(1 + cs·d') at a depth d beyond xs or -xs"
    source = "Hunt & Crossley 1975 (J. Appl. Mech. 42), exponent 1"
    neutral = (("stop_stiffness", 0.0),)
    form_of = "end_stop"
    prior_odds = 1.0 / 100.0
    knee = EndStop.knee
    turns = True
    ring_down = {HARDENS: (1,), DRAGS: (1,)}

    @staticmethod
    def force(x: float, v: float, stop_position: float, stop_stiffness: float, stop_damping: float) -> float:
        """Force [N] against +x beyond that of the stop's spring."""
        depth = abs(x) - stop_position
        if depth <= 0.0:
            return 0.0
        return stop_stiffness * depth * stop_damping * v

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {**EndStop.resolvable(seen), "stop_damping": (0.0, 30.0 / seen.speed)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[DampedStop, ...]:
        """Those of stops without damping, with some."""
        damping = 0.3 / typical.speed(record)
        return tuple(cls.within_bounds(*stop.values, damping) for stop in EndStop.guess(record, plant))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[DampedStop, ...]:
        """The same stop without damping, with a little and with much."""
        return tuple(cls.within_bounds(*simple.values, n / typical.speed(record)) for n in (0.0, 0.1, 1.0))
