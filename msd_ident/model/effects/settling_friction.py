"""Dry friction that settles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.friction_drift import FrictionDrift
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class SettlingFriction(Effect):
    """Coulomb friction that begins at another size and settles at Fc."""

    coulomb_force: float
    friction_excess: float
    friction_settling_time: float

    name = "settling_friction"
    parameters = (
        COULOMB_FORCE,
        Parameter("friction_excess", "q", "1", -1.0, math.inf, "relative excess of the dry friction at the start"),
        Parameter("friction_settling_time", "T", "s", 1e-9, math.inf, "time in which the dry friction settles"),
    )
    prior_odds = 1.0 / 100.0
    acts_on = "force"
    law = "Fc·(1 + q·exp(-t/T))·sign(v), t from where the used part of the record begins"
    source = "Coulomb friction with first-order warming of its grease"
    neutral = (("coulomb_force", 0.0),)
    family = "dry friction"
    form_of = FrictionDrift.form_of
    dissipative = True
    steady = False
    dry_limit = "coulomb_force"
    ring_down = {RUBS: (1,)}

    @staticmethod
    def friction(t: float, coulomb_force: float, friction_excess: float, friction_settling_time: float) -> float:
        """Kinetic friction [N]."""
        return coulomb_force * (1.0 + friction_excess * math.exp(-t / friction_settling_time))

    @staticmethod
    def breakaway(t: float, coulomb_force: float, friction_excess: float, friction_settling_time: float) -> float:
        """Largest force [N] that it holds at rest."""
        return coulomb_force * (1.0 + friction_excess * math.exp(-t / friction_settling_time))

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {
            "friction_excess": (-1.0, 10.0),
            "friction_settling_time": (0.02 * seen.duration, 2.0 * seen.duration),
        }

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[SettlingFriction, ...]:
        """The same force all the time."""
        del plant
        return (cls(force, 0.0, 0.2 * record.duration),)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SettlingFriction, ...]:
        """Around the guess of the steady drift."""
        return tuple(one for drift in FrictionDrift.guess(record, plant) for one in cls._at_its_ends(drift, record))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[SettlingFriction, ...]:
        """The constant friction, half as large again or two thirds of that at the start."""
        del plant
        force, time = simple.values[0], 0.3 * record.duration
        return cls(force, 0.0, time), cls(force, 0.5, time), cls(force, -0.3, time)

    @classmethod
    def _at_its_ends(cls, drift: FrictionDrift, record: Record) -> tuple[SettlingFriction, ...]:
        """The friction of a steady drift at both ends of the record, settling in a seventh and in a half of it."""
        force, rate = drift.values
        last = force * max(1.0 + rate * record.duration, 0.05)
        return tuple(cls(last, force / last - 1.0, share * record.duration) for share in (0.15, 0.5))
