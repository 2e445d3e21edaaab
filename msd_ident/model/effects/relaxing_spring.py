"""A damper in series with a spring, beside the plant."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import VELOCITY_LAG

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Time constants to start from, in radians of the swing.
STARTS = (0.3, 1.5)
#: Part of the plant's spring with which a fit begins in the place of a sensor that settles.
_LEAST = 0.02


@dataclass(frozen=True)
class RelaxingSpring(Effect):
    """c·w with T·w' + w = v, w = 0 at the start: a damper c in series with a spring c/T, as in a rubber mount, a belt
    or foam.

    With the plant's spring it is Zener's solid: it yields with k to a slow push, with k + c/T to a quick one. A short T
    makes it viscous damping c, a long one a spring c/T.
    """

    relaxing_damping: float
    relaxation_time: float

    name = "relaxing_spring"
    parameters = (
        Parameter(
            "relaxing_damping", "c", "N·s/m", 0.0, math.inf, "damper in series with a spring",
            advice="hold a large force for many swings, then let go at once",
        ),
        Parameter(
            "relaxation_time", "T", "s", 0.0, math.inf, "time in which a damper behind a spring relaxes",
            advice="sweep from far below resonance to above it",
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "c·w, with T·w' + w = v and w = 0 at the start"
    source = "Maxwell element; with the plant's spring Zener's standard linear solid (Elasticity and Anelasticity)"
    neutral = (("relaxing_damping", 0.0),)
    prior_odds = 1.0 / 100.0
    family = "second state"
    structure = VELOCITY_LAG
    creeps_as = "settling_sensor"
    or_else = "a drive that gives way and lags (a motor's back-EMF behind its inductance, air in a cylinder)"
    measured_by = "disconnect the drive, hold the cart off its place, and read with a balance how the force falls"

    @staticmethod
    def force(lagged_v: float, relaxing_damping: float) -> float:
        """Force [N] against +x."""
        return relaxing_damping * lagged_v

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Within a sample it is damping; over more than the record it is a spring."""
        return {"relaxation_time": (seen.period, seen.duration)}

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """Over one decay a sensor that settles moves like it. By how much depends on the record: a fit begins with a
        small part of the plant's spring.
        """
        relaxing = cls.moving_as(other, model)
        if relaxing is None:
            return None
        others = tuple(effect for effect in model.effects if effect is not other)
        return replace(model, effects=(*others, relaxing))

    @classmethod
    def moving_as(cls, other: Effect, model: Model) -> RelaxingSpring | None:
        """Its time; the motion is the same only where the rest is fitted too. A model has one second state."""
        taken = any(effect.family == cls.family for effect in model.effects)
        if other.name != cls.creeps_as or taken or not model.stiffness > 0.0:
            return None
        time = other.values[1]
        return cls.within_bounds(_LEAST * model.stiffness * time, time)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[RelaxingSpring, ...]:
        """A spring c/T of a tenth of the plant's m·ω², that relaxes in a part of a radian and in more than one."""
        rate = typical.natural_frequency(record, plant)
        stiffness = 0.1 * plant["mass"] * rate**2
        return tuple(cls(stiffness * turn / rate, turn / rate) for turn in STARTS)
