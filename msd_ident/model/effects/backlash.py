"""Play between the spring and the mass."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.law import BOTH, HARDENS, PLAY

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: How far away, in parts of the play, its next valleys are looked for.
_HOPS = (0.93, 0.965, 1.035, 1.07)
#: Part of a stop's stiffness below which the spring beside it is none: no law of a real rig is exact to less.
_NO_SPRING = 0.03


def _stops(effect: Effect) -> tuple[float, float, float]:
    """Middle [m] of stops on either side, distance from it [m], stiffness [N/m]; 0 where the effect is none."""
    if effect.knee is None:
        return 0.0, 0.0, 0.0
    values = dict(zip([parameter.name for parameter in effect.parameters], effect.values, strict=True))
    place, stiffness, side = effect.knee
    if side == BOTH:
        return 0.0, values[place], values[stiffness]
    return (values[place], values[side], values[stiffness]) if side in values else (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Backlash(Effect):
    """The linear spring pulls only beyond a dead zone of half-width g."""

    backlash_half_width: float

    name = "backlash"
    parameters = (
        Parameter(
            "backlash_half_width", "g", "m", 0.0, math.inf, "half the play of the spring",
            advice="ramp the force slowly through zero in both directions", kinked=True,
        ),
    )  # fmt: skip
    acts_on = "force"
    needs_spring = True
    law = "k·(x - g) for x > g, 0 within, k·(x + g) for x < -g, in place of k·x"
    source = "dead-zone model; Nordin & Gutman 2002 (Automatica 38)"
    neutral = (("backlash_half_width", 0.0),)
    piecewise_linear = True
    structure = PLAY
    shows_zero = True
    ring_down = {HARDENS: (1,)}
    measured_by = "move the cart by hand within the play and read the encoder"

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"backlash_half_width": (0.0, 0.5 * seen.span)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[Backlash, ...]:
        """Several widths: the surface has a knee wherever the motion ends within the play."""
        return tuple(cls(share * typical.amplitude(record)) for share in (0.02, 0.08, 0.25))

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """Beyond stops at xs of stiffness ks the force is k·(x - g) + ks·(x - xs), with the play g that the model has
        already: that of a spring of stiffness k + ks with a play of (k·g + ks·xs)/(k + ks). Stops about xc are stops
        about zero, counted from there, beside a force offset of k·xc.
        """
        centre, place, stiffness = _stops(other)
        if not stiffness > 0.0:
            return None
        whole = model.stiffness + stiffness
        moment = model.stiffness * sum(model.structure(PLAY)) + stiffness * place
        effects = [effect for effect in model.effects if effect.name not in (other.name, cls.name)]
        if offset := model.stiffness * centre:
            beside = [effect for effect in effects if isinstance(effect, ForceOffset)]
            effects = [effect for effect in effects if effect not in beside]
            effects.append(ForceOffset(offset + math.fsum(effect.offset_force for effect in beside)))
        return replace(model, stiffness=whole, effects=(*effects, cls(moment / whole)))

    def zero_in(self, model: Model) -> float:
        """The middle of the stops whose place it takes."""
        return math.fsum(_stops(effect)[0] for effect in model.effects)

    @classmethod
    def is_all_of(cls, other: Effect, model: Model) -> bool:
        """Stops beside no spring are a spring, and the way between them its play."""
        stiffness = _stops(other)[2] if other.knee and other.knee[2] == BOTH else 0.0
        return stiffness > 0.0 and model.stiffness <= _NO_SPRING * stiffness

    def neighbours(self, records: Sequence[Record]) -> tuple[Backlash, ...]:
        """A little more or less play: there is a minimum for every number of swings that ended within it."""
        del records
        hops = _HOPS if self.backlash_half_width > 0.0 else ()
        return tuple(Backlash(factor * self.backlash_half_width) for factor in hops)
