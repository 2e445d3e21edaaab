"""Damping that fades with the speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Speeds at which the damping has fallen to its half, in parts of the top speed: below, the force rises no more at most
#: speeds, as that of dry friction that creeps; above, it is a part of the plant's own damping.
HALVES = (0.15, 2.0)
#: Where a search begins. A brake that is driven far beyond the peak of its force looks like Stribeck friction: from a
#: third of the top speed a search does not get there.
_STARTS = (0.15, 0.33, 0.67)
#: The same as the first of ``HALVES`` where more than noise is left, so that the curve is not this one: dry friction is
#: on every rig, and few rigs get to the peak of an eddy-current brake, which lies at several m/s.
_DRY = 1.0 / 3.0
#: Share of the plant's natural damping force m·ω·v that a search starts from.
_SHARE = 0.1


@dataclass(frozen=True)
class FadingDamping(Effect):
    """b1·v beside the plant's damping at low speed, half of it at v0, little of it far beyond: an eddy-current brake
    (n = 2), a shear-thinning film (n = 1 and less).
    """

    fading_damping: float
    fading_speed: float
    fading_exponent: float

    name = "fading_damping"
    parameters = (
        Parameter(
            "fading_damping", "b1", "N·s/m", 0.0, math.inf, "damping at low speed that fades with the speed",
            advice="let it ring down from a three times larger amplitude",
        ),
        Parameter("fading_speed", "v0", "m/s", 1e-9, math.inf, "speed at which half of it is left"),
        Parameter("fading_exponent", "n", "1", 0.7, 3.0, "how steeply it fades"),
    )  # fmt: skip
    acts_on = "force"
    law = "b1·v/(1 + (abs(v)/v0)^n)"
    source = "Cross 1965 (J. Colloid Sci. 20); n = 2: eddy-current brake, Wiederick et al. 1987 (Am. J. Phys. 55)"
    neutral = (("fading_damping", 0.0),)
    dissipative = True
    form_of = "quadratic_drag"
    stands_alone = True
    prior_odds = 1.0 / 40.0
    ring_down = {RUBS: (1,)}
    measured_by = "take the magnet or the film away, and record again"
    turns = True

    @staticmethod
    def force(v: float, speed: float, fading_damping: float, fading_speed: float, fading_exponent: float) -> float:
        """Damping force [N]."""
        if speed <= 0.0:
            return 0.0
        return fading_damping * v / (1.0 + math.exp(fading_exponent * math.log(speed / fading_speed)))

    def may_be(self, speed: float, exact: bool) -> tuple[str, ...]:
        """Dry friction that creeps, where the force rises no more at most speeds and more than noise is left."""
        dry = not exact and self.fading_speed < _DRY * speed
        return ("coulomb_friction", "stribeck_friction") if dry else ()

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"fading_speed": (HALVES[0] * seen.speed, HALVES[1] * seen.speed)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[FadingDamping, ...]:
        """A tenth of critical damping that halves at parts of the top speed."""
        speed = typical.speed(record)
        size = max(plant.damping, 2.0 * _SHARE * math.sqrt(max(plant.stiffness, 0.0) * plant.mass))
        return tuple(cls.within_bounds(size, share * speed, 2.0) for share in _STARTS)
