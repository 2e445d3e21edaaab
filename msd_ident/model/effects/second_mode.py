"""A second mass on a spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import SECOND_MASS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

_ADVICE = "sweep through both resonances"


@dataclass(frozen=True)
class SecondMode(Effect):
    """A mass m2 on a spring k2 and damper b2 that hangs on the first: a flexible base or coupling.

    It starts where the first mass does, with its velocity.
    """

    second_mass: float
    second_stiffness: float
    second_damping: float = 0.0

    name = "second_mode"
    family = "second state"
    parameters = (
        Parameter(
            "second_mass", "m2", "kg", 0.0, math.inf, "mass that hangs on the first",
            advice=_ADVICE, inertia=True, multistable=True,
        ),
        Parameter(
            "second_stiffness", "k2", "N/m", 0.0, math.inf, "spring between the masses",
            advice=_ADVICE, most=1e3,
        ),
        Parameter(
            "second_damping", "b2", "N·s/m", 0.0, math.inf, "damper between the masses",
            advice=_ADVICE, most=1e3,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "k2·(x - x2) + b2·(x' - x2'), with m2·x2'' equal to it"
    source = "two-mass oscillator; Den Hartog, Mechanical Vibrations, 1934, chapter 3"
    neutral = (("second_mass", 0.0),)
    structure = SECOND_MASS
    measured_by = "add a known mass to the cart and record again"

    def longest_period(self) -> float:
        """Of the second mass on its own spring, 2·pi·sqrt(m2 / k2)."""
        return 2.0 * math.pi * math.sqrt(self.second_mass / max(self.second_stiffness, 1e-300))

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``: up to a swing of a dozen samples."""
        fastest = 0.5 / seen.period
        return {
            "second_mass": (0.02 * seen.mass, 5.0 * seen.mass),
            "second_stiffness": (1e-3 * seen.mass * seen.rate**2, seen.mass * max(30.0 * seen.rate**2, fastest**2)),
            "second_damping": (0.0, seen.mass * seen.rate),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SecondMode, ...]:
        """A tenth of the mass, tuned to 0.6, 1.7, 3 and 6 times the plant's frequency, lightly damped."""
        mass, omega = 0.1 * plant["mass"], typical.natural_frequency(record, plant)
        tuned = tuple(n * omega for n in (1.7, 3.0, 6.0, 0.6))
        return tuple(cls(mass, mass * w * w, 0.1 * mass * w) for w in tuned)
