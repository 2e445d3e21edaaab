"""Dry friction with a peak and without a jump."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction, past_limit

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Where a search begins: vs in parts of the top speed, vc in parts of vs.
_FALLS, _CREEPS = (0.05, 0.15, 0.5), (0.07, 0.4)


@dataclass(frozen=True)
class SmoothStribeckFriction(Effect):
    """Friction that rises over the creep speed vc, has its peak Fs near vs/sqrt(2) where vc is well below that, and
    falls to Fc beyond: the friction elements of block diagrams, which have vc = vs/14.

    An Fs below Fc counts as Fc, and one above 10·Fc as that, as in Stribeck's law with a jump.
    """

    smooth_friction: float
    peak_friction: float
    peak_velocity: float
    creep_speed: float

    name = "smooth_stribeck_friction"
    parameters = (
        SmoothFriction.parameters[0],
        Parameter("peak_friction", "Fs", "N", 0.0, math.inf, "breakaway friction: that of the peak",
                  not_below="smooth_friction"),
        Parameter("peak_velocity", "vs", "m/s", 1e-9, math.inf, "velocity over which friction falls"),
        SmoothFriction.parameters[1],
    )  # fmt: skip
    acts_on = "force"
    law = "Fc·tanh(v/vc) + sqrt(2·e)·(Fs - Fc)·(v/vs)·exp(-(v/vs)²)"
    source = "Simscape, Translational Friction; Armstrong-Hélouvry & Canudas de Wit 1995 (The Control Handbook)"
    neutral = (("smooth_friction", 0.0), ("peak_friction", 0.0))
    family = "dry friction"
    eponym = "Stribeck"
    dissipative = True
    form_of = "stribeck_friction"
    mistaken_for = ("coulomb_friction", "quadratic_drag")
    dry_limit = "smooth_friction"
    prior_odds = 1.0 / 100.0
    ring_down = {RUBS: (0, 1)}

    @staticmethod
    def force(
        v: float, smooth_friction: float, peak_friction: float, peak_velocity: float, creep_speed: float
    ) -> float:
        """Friction [N]."""
        part = v / peak_velocity
        bump = part * math.exp(0.5 - part * part) if part * part < 40.0 else 0.0
        above = max(min(peak_friction, 10.0 * smooth_friction) - smooth_friction, 0.0)
        return math.sqrt(2.0) * above * bump + smooth_friction * math.tanh(v / creep_speed)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {
            "peak_velocity": StribeckFriction.resolvable(seen)["stribeck_velocity"],
            "creep_speed": SmoothFriction.resolvable(seen)["creep_speed"],
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SmoothStribeckFriction, ...]:
        """A peak of twice the sliding force, at speeds from slow to fast, with a quick and with a slow turn."""
        return cls.from_dry_friction(0.05 * typical.force(record, plant), record, plant)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[SmoothStribeckFriction, ...]:
        """The same curve with a quick and with a slow turn, and those of ``guess`` with its friction."""
        sliding, peak, velocity = simple.values[:3]
        known = tuple(cls.within_bounds(sliding, peak, velocity, part * velocity) for part in _CREEPS)
        return *known, *cls.from_dry_friction(sliding, record, plant)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[SmoothStribeckFriction, ...]:
        """With a peak of twice the sliding force, which lies below the known one."""
        del plant
        return cls._peaked(0.8 * force, typical.speed(record))

    @classmethod
    def _peaked(cls, sliding: float, speed: float) -> tuple[SmoothStribeckFriction, ...]:
        known = [(part * speed, turn * part * speed) for part in _FALLS for turn in _CREEPS]
        return tuple(cls.within_bounds(sliding, 1.5 * sliding, *one) for one in known)

    def same_as(self, model: Model) -> str:
        """Of a breakaway force that counts as less than its value."""
        del model
        return past_limit(self.smooth_friction, self.peak_friction)

    def neighbours(self, records: Sequence[Record]) -> tuple[SmoothStribeckFriction, ...]:
        """Without a peak, one begun anew: a breakaway below Fc counts as Fc, so that no small step brings it back."""
        if self.peak_friction > self.smooth_friction or self.smooth_friction == 0.0:
            return ()
        speed = max(typical.speed(record) for record in records)
        return self._peaked(0.8 * self.smooth_friction, speed)[::2]
