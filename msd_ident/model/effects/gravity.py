"""Gravity on a joint."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from msd_ident.model.declarations import PLACE, Harmonic, Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _turned(x: Any) -> Any:
    """sin(x), of an angle x [rad]."""
    return np.sin(x)


def _quarter_on(x: Any) -> Any:
    """The same a quarter turn further."""
    return np.cos(x)


def _ripple(effect: Effect) -> Harmonic | None:
    """The harmonic term of an effect over the travel; None if it has none."""
    return effect.harmonic if effect.harmonic is not None and effect.harmonic.over == PLACE else None


def _softens(effect: Effect) -> bool:
    """Whether an effect is a spring that softens alike both ways."""
    strength = float(getattr(effect, effect.neutral[0][0]))
    return effect.mirror and effect.is_spring() and strength < 0.0 and -1 in effect.ring_down.get(SOFTENS, ())


@dataclass(frozen=True)
class Gravity(Effect):
    """G·sin(x): a pendulum, an arm that a joint lifts. x counts from where it hangs."""

    gravity_moment: float

    name = "gravity"
    parameters = (
        Parameter(
            "gravity_moment", "G", "N", 0.0, math.inf, "m·g·l: weight times lever [N·m]",
            regressor=_turned, quadrature=_quarter_on,
        ),
    )  # fmt: skip
    prior_odds = 1.0 / 2.0
    acts_on = "force"
    law = "G·sin(x), x [rad] from where it hangs"
    source = "Newton's pendulum; for small angles a spring of stiffness G"
    neutral = (("gravity_moment", 0.0),)
    angular = True
    ring_down = {SOFTENS: (1,)}

    @staticmethod
    def force(x: float, gravity_moment: float) -> float:
        """Moment [N·m] against +x."""
        return gravity_moment * math.sin(x)

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """A ripple whose pitch is nearer to one turn than to a half or to two: on a joint this is gravity. So is a
        spring that softens alike both ways, as k·x - k·x³/6 begins k·sin(x).
        """
        term = _ripple(other)
        others = tuple(effect for effect in model.effects if effect.name not in (other.name, cls.name))
        if _softens(other) and model.stiffness > 0.0:
            weight = model.stiffness + sum(one.gravity_moment for one in model.effects if isinstance(one, cls))
            return replace(model, stiffness=0.0, effects=(*others, cls(weight)))
        if term is None or not 0.5 < math.log2(getattr(other, term.scanned) / math.pi) < 1.5:
            return None
        return replace(model, effects=(*others, cls(getattr(other, term.amplitude))))

    def zero_in(self, model: Model) -> float:
        """Where the sine of the ripple begins, near the reading from which the model counts."""
        found = ((effect, term) for effect in model.effects if (term := _ripple(effect)))
        return next((-math.remainder(getattr(effect, term.phase), 2.0 * math.pi) for effect, term in found), 0.0)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[Gravity, ...]:
        """All of the spring, and half of it."""
        stiffness = plant["stiffness"] or typical.force(record, plant) / typical.amplitude(record)
        return cls(stiffness), cls(0.5 * stiffness)
