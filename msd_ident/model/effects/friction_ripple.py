"""Dry friction that repeats along the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import FloatArray, Model


@dataclass(frozen=True)
class FrictionRipple(Effect):
    """Coulomb friction that rises and falls once a turn: a bent screw, a wheel or a gear off its centre."""

    coulomb_force: float
    friction_ripple: float
    friction_pitch: float
    friction_phase: float

    name = "friction_ripple"
    parameters = (
        COULOMB_FORCE,
        Parameter("friction_ripple", "a", "1", 0.0, math.inf, "amplitude of the friction's change along the travel"),
        Parameter("friction_pitch", "p", "m", 1e-9, math.inf, "travel after which the friction repeats", least=2e-2),
        Parameter("friction_phase", "phi", "rad", -math.inf, math.inf, "phase of the friction's change at x = 0"),
    )
    exact = ("friction_pitch", "friction_phase")
    prior_odds = 1.0 / 40.0
    acts_on = "force"
    law = "Fc·(1 + a·sin(2·pi·x/p + phi))·sign(v), nowhere below 0"
    source = "Coulomb friction with the first harmonic of a turn in the normal force"
    neutral = (("coulomb_force", 0.0),)
    family = "dry friction"
    form_of = "coulomb_friction"
    dissipative = True
    mirror = False
    dry_limit = "coulomb_force"
    ring_down = {RUBS: (1,)}
    measured_by = "pull the cart slowly through several turns with a force gauge, both ways"

    @staticmethod
    def friction(
        x: float, coulomb_force: float, friction_ripple: float, friction_pitch: float, friction_phase: float
    ) -> float:
        """Kinetic friction [N]."""
        change = friction_ripple * math.sin((2.0 * math.pi / friction_pitch) * x + friction_phase)
        return coulomb_force * max(1.0 + change, 0.0)

    @staticmethod
    def breakaway(
        x: float, coulomb_force: float, friction_ripple: float, friction_pitch: float, friction_phase: float
    ) -> float:
        """Largest force [N] that it holds at rest."""
        change = friction_ripple * math.sin((2.0 * math.pi / friction_pitch) * x + friction_phase)
        return coulomb_force * max(1.0 + change, 0.0)

    def repeats_after(self) -> float:
        """Its pitch."""
        return self.friction_pitch if self.friction_ripple > 0.0 else 0.0

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """A turn that the cart sees, of a friction that hardly vanishes."""
        pitch = (typical.PITCHES[0] * seen.span, typical.PITCHES[1] * seen.span)
        return {"friction_pitch": pitch, "friction_ripple": (0.0, 2.0)}

    @classmethod
    def from_simple_and_residual(
        cls, simple: Effect, record: Record, plant: Model, residual: FloatArray
    ) -> tuple[FrictionRipple, ...]:
        """The constant friction, with the ripples that best fit the missing force against the motion."""
        error = replace(record, position=-residual, force=np.zeros(record.force.size))
        return cls._rippled(simple.values[0], record, typical.unexplained_force(error, plant)[2], plant)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[FrictionRipple, ...]:
        """See ``from_dry_friction``."""
        return cls.from_dry_friction(simple.values[0], record, plant)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[FrictionRipple, ...]:
        """The same force, with the ripples that best fit what the plant leaves unexplained."""
        return cls._rippled(force, record, typical.unexplained_force(record, plant)[2], plant)

    @classmethod
    def _rippled(cls, force: float, record: Record, left: FloatArray, plant: Model) -> tuple[FrictionRipple, ...]:
        """The constant friction, and the ripples of the missing force (n,) [N], on an even grid, times the direction of
        the motion.

        A force that does not follow the direction changes its sign with it, and is noise here.
        """
        x = typical.unexplained_force(record, plant)[1]
        span = max(float(np.ptp(x)), 1e-9)
        found = typical.waves(x, left * np.sign(np.gradient(x)), typical.pitches(span), count=3)
        rippled = (cls.within_bounds(force, min(size / max(force, 1e-300), 1.0), *rest) for size, *rest in found)
        return cls.within_bounds(force, 0.0, 0.5 * span, 0.0), *rippled

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[FrictionRipple, ...]:
        """A twentieth of the largest force."""
        return cls.from_dry_friction(0.05 * typical.force(record, plant), record, plant)
