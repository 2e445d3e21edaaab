"""Dry friction that creeps, with a turn of free sharpness."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS
from msd_ident.model.effects.smooth_friction import SmoothFriction

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Sharpness where a search begins: that of an algebraic turn, and one as sharp as tanh.
_STARTS = (2.0, 3.0)


@dataclass(frozen=True)
class SmoothFrictionTurn(Effect):
    """Fc·v/(abs(v)^n + vc^n)^(1/n): n = 2 is the algebraic turn, n = 1 a damping that fades slowly into friction."""

    smooth_friction: float
    creep_speed: float
    turn_exponent: float

    name = "smooth_friction_turn"
    parameters = (
        *SmoothFriction.parameters,
        Parameter("turn_exponent", "n", "1", 1.0, 6.0, "sharpness of the turn from creep to sliding"),
    )
    acts_on = "force"
    law = "Fc·v/(abs(v)^n + vc^n)^(1/n)"
    source = "Andersson, Söderberg & Björklund 2007 (Tribology International 40), section 3; n = 2: algebraic"
    neutral = SmoothFriction.neutral
    family = "dry friction"
    dissipative = True
    form_of = "coulomb_friction"
    mistaken_for = ("quadratic_drag",)
    dry_limit = "smooth_friction"
    prior_odds = 1.0 / 100.0
    ring_down = {RUBS: (1,)}
    turns = True

    @staticmethod
    def force(v: float, smooth_friction: float, creep_speed: float, turn_exponent: float) -> float:
        """Friction [N]."""
        speed = abs(v)
        part = speed / creep_speed
        if part <= 1e-9:
            return smooth_friction * v / creep_speed
        way = math.exp(-turn_exponent * abs(math.log(part)))  # of the smaller over the larger speed
        return smooth_friction * v / max(speed, creep_speed) * math.exp(-math.log1p(way) / turn_exponent)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return SmoothFriction.resolvable(seen)

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """A damping that fades as 1/v is friction with the slowest turn, n = 1: Fc = b1·v0, vc = v0. One that fades
        faster is nearest to a sharper turn.
        """
        others = tuple(effect for effect in model.effects if effect is not other)
        if other.name != "fading_damping" or any(effect.family == cls.family for effect in others):
            return None
        damping, speed, exponent = other.values
        return replace(model, effects=(*others, cls.within_bounds(damping * speed, speed, exponent)))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SmoothFrictionTurn, ...]:
        """Those of the sharpest turn, algebraic."""
        return tuple(cls.within_bounds(*one.values, _STARTS[0]) for one in SmoothFriction.guess(record, plant))

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[SmoothFrictionTurn, ...]:
        """The same friction over two creep speeds, algebraic and sharper."""
        starts = SmoothFriction.from_dry_friction(force, record, plant)
        return tuple(cls.within_bounds(*one.values, n) for one in starts for n in _STARTS)
