"""Dry friction that falls as the motion starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.coulomb_friction import COULOMB_FORCE
from msd_ident.model.effects.law import RUBS

if TYPE_CHECKING:
    import numpy as np

    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Part of the sliding force by which a breakaway force must be larger for a law of its own: the parameters of a smaller
#: peak are seen by nothing, so they would cost nothing.
_NO_PEAK = 0.01
#: Breakaway forces over the sliding one where a search begins next to Coulomb's friction. The first hardly changes the
#: motion: with the others the cart may rest in other places, and the start promises nothing.
_PEAKS = (1.03, 1.3)


def past_limit(coulomb_force: float, static_force: float) -> str:
    """A sentence where a breakaway force counts as less than its value; empty where it does not."""
    if static_force <= 10.0 * coulomb_force:
        return ""
    return f"A breakaway friction counts up to ten times the sliding one: here {10.0 * coulomb_force:.3g}."


def no_peak(coulomb_force: float, static_force: float) -> bool:
    """Whether a breakaway force is so little above the sliding one that nothing shows of it."""
    return static_force <= (1.0 + _NO_PEAK) * coulomb_force


@dataclass(frozen=True)
class StribeckFriction(Effect):
    """Breakaway Fs at rest, falling to Fc over the velocity vs.

    An Fs below Fc, which no dry friction has, counts as Fc: what grows with the speed is damping or drag. An Fs above
    10·Fc counts as that: the largest ratios that are known are about 5, and a force that vanishes as the motion starts
    is not friction.
    """

    coulomb_force: float
    static_force: float
    stribeck_velocity: float

    name = "stribeck_friction"
    parameters = (
        COULOMB_FORCE,
        Parameter(
            "static_force", "Fs", "N", 0.0, math.inf, "breakaway friction",
            advice="ramp the force slowly from rest, in both directions",
            holds=True, kinked=True, not_below="coulomb_force",
        ),
        Parameter(
            "stribeck_velocity", "vs", "m/s", 1e-9, math.inf, "velocity over which friction falls",
            advice="add slow reversals: a sweep or a slow ramp in both directions", least=1e-3,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "(Fc + (Fs - Fc)·exp(-(v/vs)²))·sign(v), breakaway Fs"
    source = "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994 (Automatica 30): Gaussian form of Stribeck's curve"
    neutral = (("coulomb_force", 0.0), ("static_force", 0.0))
    family = "dry friction"
    eponym = "Stribeck"
    dissipative = True
    dry_limit = "coulomb_force"
    ring_down = {RUBS: (0, 1)}
    measured_by = "pull the cart slowly with a spring balance and read the force at which it breaks away"

    @staticmethod
    def friction(speed: float, coulomb_force: float, static_force: float, stribeck_velocity: float) -> float:
        """Kinetic friction [N]."""
        square = speed * speed * (1.0 / stribeck_velocity**2)
        bump = math.exp(-square) if square < 40.0 else 0.0
        return coulomb_force + max(min(static_force, 10.0 * coulomb_force) - coulomb_force, 0.0) * bump

    @staticmethod
    def breakaway(coulomb_force: float, static_force: float) -> float:
        """Largest force [N] that it holds at rest."""
        return max(min(static_force, 10.0 * coulomb_force), coulomb_force)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"stribeck_velocity": (3e-3 * seen.speed, 2.0 * seen.speed)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[StribeckFriction, ...]:
        """Velocity scales from a twelfth to two fifths of the top speed, with little and with much friction."""
        force, speed = typical.force(record, plant), typical.speed(record)
        shares = [(n, s) for n in (1.0, 4.0) for s in (0.08, 0.18, 0.4)]
        return tuple(cls.within_bounds(0.02 * force * n, 0.04 * force * n, speed * s) for n, s in shares)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[StribeckFriction, ...]:
        """With hardly a peak, a small one and a large one over each of the velocities of ``guess``, and falling to half
        over all speeds. Coulomb friction beside which no peak was known lies between sliding and breakaway force.
        """
        scales = sorted({guess.stribeck_velocity for guess in cls.guess(record, plant)})
        small = tuple(cls(force, peak * force, scale) for peak in _PEAKS for scale in scales)
        large = tuple(cls(0.5 * force, 2.0 * force, scale) for scale in scales)
        return *small, *large, cls(0.5 * force, force, typical.speed(record))

    def is_dry_friction(self) -> bool:
        """Without a peak."""
        return no_peak(self.coulomb_force, self.static_force)

    @property
    def holding(self) -> float:
        """See ``Effect``; a breakaway counts as far as it holds."""
        return self.coulomb_force + min(self.static_force, 10.0 * self.coulomb_force)

    def same_as(self, model: Model) -> str:
        """Of a breakaway force that counts as less than its value."""
        del model
        return past_limit(self.coulomb_force, self.static_force)

    def by_lot(self, rng: np.random.Generator, record: Record, plant: Model) -> StribeckFriction:
        """A breakaway force of 1.1 to 5 times the sliding one; 2 to 50 % of the speed of free swings as large as the
        motion, which a slow motion never reaches.
        """
        swings = typical.amplitude(record) * math.sqrt(max(plant.stiffness, 0.0) / plant.mass)
        velocity = math.exp(rng.uniform(math.log(0.02), math.log(0.5))) * max(typical.speed(record), swings)
        return replace(self, static_force=rng.uniform(1.1, 5.0) * self.coulomb_force, stribeck_velocity=velocity)

    def neighbours(self, records: Sequence[Record]) -> tuple[StribeckFriction, ...]:
        """Without a peak, one begun anew: a breakaway below Fc counts as Fc, so that no small step brings it back."""
        if self.static_force > self.coulomb_force or self.coulomb_force == 0.0:
            return ()
        kinetic, speed = self.coulomb_force, max(typical.speed(record) for record in records)
        velocities = (0.03 * speed, 0.1 * speed, 0.3 * speed)
        return tuple(StribeckFriction.within_bounds(kinetic, 1.5 * kinetic, velocity) for velocity in velocities)
