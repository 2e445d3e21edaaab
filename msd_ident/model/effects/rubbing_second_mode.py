"""A second mass on a spring that rubs on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import RUBS, SECOND_MASS
from msd_ident.model.effects.second_mode import SecondMode

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Speeds below which the friction falls, in parts of the top speed: below the first, nothing but time is lost. A fit
#: starts from the second, a soft turn of the friction, which later steps make sharp.
_SLOWEST, _SOFTEST = 3e-4, 0.02
#: Stiffest coupling, in parts of the plant's own stiffness.
_STIFFEST = 5.0


@dataclass(frozen=True)
class RubbingSecondMode(Effect):
    """A second mode whose mass m2 has dry friction of its own: a load behind a flexible coupling, an energy chain.

    Far below vc it creeps as under a damper F2/vc, which keeps the law smooth.
    """

    second_mass: float
    second_stiffness: float
    second_damping: float
    second_friction: float
    second_creep: float

    name = "rubbing_second_mode"
    family = SecondMode.family
    parameters = (
        *SecondMode.parameters,
        Parameter("second_friction", "F2", "N", 0.0, math.inf, "dry friction of the second mass on the ground"),
        Parameter("second_creep", "vc", "m/s", 1e-9, math.inf, "speed below which that friction falls"),
    )
    acts_on = "force"
    law = "k2·(x - x2) + b2·(x' - x2'), with m2·x2'' + F2·tanh(x2'/vc) equal to it"
    source = "two-mass oscillator with friction on the load; Armstrong-Hélouvry et al. 1994 (Automatica 30), section 2"
    neutral = (*SecondMode.neutral, ("second_friction", 0.0))
    form_of = "second_mode"
    mistaken_for = ("coulomb_friction",)
    dry_limit = "second_friction"
    prior_odds = 1.0 / 100.0
    ring_down = {RUBS: (0, 1)}
    structure = SECOND_MASS
    measured_by = "push the second mass alone with a spring balance"

    @staticmethod
    def second_force(second_v: float, second_friction: float, second_creep: float) -> float:
        """Friction [N] against the second mass."""
        return second_friction * math.tanh(second_v / second_creep)

    def longest_period(self) -> float:
        """As of a second mode."""
        return SecondMode(*self.values[:3]).longest_period()

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``. Behind a stiffer coupling both masses move as one, and the friction is that of one mass."""
        stiffness = seen.mass * seen.rate**2
        return {
            **SecondMode.resolvable(seen),
            "second_stiffness": (1e-3 * stiffness, _STIFFEST * stiffness),
            "second_friction": (0.0, seen.force),
            "second_creep": (_SLOWEST * seen.speed, _SOFTEST * seen.speed),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[RubbingSecondMode, ...]:
        """Those of a second mode, which rubs with 3 % of the largest force."""
        return cls.from_dry_friction(0.03 * typical.force(record, plant), record, plant)

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[RubbingSecondMode, ...]:
        """Those of a second mode, which has all of the friction."""
        creep = _SOFTEST * typical.speed(record)
        return tuple(cls.within_bounds(*one.values, force, creep) for one in SecondMode.guess(record, plant))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[RubbingSecondMode, ...]:
        """The same mass; without friction, and with one of 1 and of 5 % of the largest force."""
        force, creep = typical.force(record, plant), _SOFTEST * typical.speed(record)
        return tuple(cls.within_bounds(*simple.values, part * force, creep) for part in (0.0, 0.01, 0.05))
