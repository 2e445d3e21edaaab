"""Dry friction without a jump."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS
from msd_ident.model.effects.stribeck_friction import no_peak

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Creep speeds in parts of the top speed: below the first it is Coulomb's friction, above the second a damping that
#: fades. A cart that is held for a second creeps by a thousandth of its top speed, far more than an encoder's step.
_SLOWEST, _FASTEST = 3e-4, 0.5
#: Where a search begins.
_STARTS = (0.02, 0.15)


@dataclass(frozen=True)
class SmoothFriction(Effect):
    """Fc against the motion, but below the speed vc it falls with the speed, so that it holds nothing at rest: a joint
    that creeps, and the friction of many physics engines.
    """

    smooth_friction: float
    creep_speed: float

    name = "smooth_friction"
    parameters = (
        Parameter(
            "smooth_friction", "Fc", "N", 0.0, math.inf, "dry friction well above the creep speed",
            advice="let it ring down from a larger amplitude until it stops",
        ),
        Parameter("creep_speed", "vc", "m/s", 1e-9, math.inf, "speed below which the friction falls"),
    )  # fmt: skip
    acts_on = "force"
    law = "Fc·tanh(v/vc)"
    source = "Andersson, Söderberg & Björklund 2007 (Tribology International 40), section 3"
    neutral = (("smooth_friction", 0.0),)
    family = "dry friction"
    dissipative = True
    form_of = "coulomb_friction"
    mistaken_for = ("quadratic_drag",)
    dry_limit = "smooth_friction"
    prior_odds = 1.0 / 20.0
    ring_down = {RUBS: (1,)}

    @staticmethod
    def force(v: float, smooth_friction: float, creep_speed: float) -> float:
        """Friction [N]."""
        return smooth_friction * math.tanh(v / creep_speed)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"creep_speed": (_SLOWEST * seen.speed, _FASTEST * seen.speed)}

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """A law that rises over a creep speed and bends further, without that bend."""
        if other.name == cls.name or not {one.name for one in cls.parameters} <= {one.name for one in other.parameters}:
            return None
        others = tuple(effect for effect in model.effects if effect is not other)
        values = {one.name: getattr(other, one.name) for one in cls.parameters}
        return replace(model, effects=(*others, cls(**values)))

    @classmethod
    def is_all_of(cls, other: Effect, model: Model) -> bool:
        """A peak that is not above the sliding force is none."""
        turns = cls.in_place_of(other, model) is not None and "peak_friction" in {one.name for one in other.parameters}
        return turns and no_peak(*other.values[:2])

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SmoothFriction, ...]:
        """Five per cent of the largest force at work, over two creep speeds."""
        return cls.from_dry_friction(0.05 * typical.force(record, plant), record, plant)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[SmoothFriction, ...]:
        """The same friction, over two creep speeds."""
        del plant
        return tuple(cls.within_bounds(force, part * typical.speed(record)) for part in _STARTS)
