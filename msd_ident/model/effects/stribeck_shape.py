"""A Stribeck curve of another shape than the Gaussian."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS
from msd_ident.model.effects.stribeck_friction import StribeckFriction, no_peak, past_limit

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class StribeckShape(Effect):
    """Breakaway Fs at rest, falling to Fc with a free exponent of the speed: 1 is the exponential curve, 2 Gauss's."""

    coulomb_force: float
    static_force: float
    stribeck_velocity: float
    stribeck_exponent: float

    name = "stribeck_shape"
    parameters = (
        *StribeckFriction.parameters,
        Parameter("stribeck_exponent", "n", "1", 0.3, 4.0, "shape of the fall of friction"),
    )
    acts_on = "force"
    law = "(Fc + (Fs - Fc)·exp(-abs(v/vs)^n))·sign(v), breakaway Fs"
    source = "Bo & Pavelescu 1982 (Wear 82): exponents from 1/2 to 1; Armstrong-Hélouvry 1991: 2"
    neutral = (("coulomb_force", 0.0), ("static_force", 0.0))
    family = "dry friction"
    eponym = "Stribeck"
    dissipative = True
    dry_limit = "coulomb_force"
    form_of = "stribeck_friction"
    prior_odds = 1.0 / 100.0
    ring_down = {RUBS: (0, 1)}

    @staticmethod
    def friction(
        speed: float, coulomb_force: float, static_force: float, stribeck_velocity: float, stribeck_exponent: float
    ) -> float:
        """Kinetic friction [N]."""
        way = math.exp(stribeck_exponent * math.log(max(speed, 1e-300) / stribeck_velocity))
        bump = math.exp(-way) if way < 40.0 else 0.0
        return coulomb_force + max(min(static_force, 10.0 * coulomb_force) - coulomb_force, 0.0) * bump

    @staticmethod
    def breakaway(coulomb_force: float, static_force: float) -> float:
        """Largest force [N] that it holds at rest."""
        return max(min(static_force, 10.0 * coulomb_force), coulomb_force)

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[StribeckShape, ...]:
        """Those of the Gaussian curve, exponential."""
        return tuple(cls.within_bounds(*one.values, 1.0) for one in StribeckFriction.guess(record, plant))

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[StribeckShape, ...]:
        """Those of the Gaussian curve, exponential."""
        gaussian = StribeckFriction.from_dry_friction(force, record, plant)
        return tuple(cls.within_bounds(*one.values, 1.0) for one in gaussian)

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

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[StribeckShape, ...]:
        """The same curve as it is, and steeper at first."""
        return tuple(cls.within_bounds(*simple.values, exponent) for exponent in (2.0, 1.5, 0.8))
