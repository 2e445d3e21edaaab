"""A force that is stronger one way than the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects.base import Effect
from msd_ident.quantity import two_digits

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class ForceGainAsymmetry(Effect):
    """F·(1 + g·sign(F)): push and pull of an amplifier, a valve or a muscle differ. A rope pulls only: g is 1 or -1."""

    gain_asymmetry: float

    name = "force_gain_asymmetry"
    parameters = (
        Parameter("gain_asymmetry", "g", "1", -1.0, 1.0, "force gain upwards less that of the mean, relative"),
    )
    acts_on = "input"
    law = "F·(1 + g·sign(F))"
    source = "actuator with two gains, one for each sign of its command"
    neutral = (("gain_asymmetry", 0.0),)
    form_of = "force_gain_nonlinearity"
    stands_alone = True
    prior_odds = 1.0 / 40.0
    piecewise_linear = True
    mirror = False

    @staticmethod
    def input_map(u: float, gain_asymmetry: float) -> float:
        """Force [N] that a commanded u [N] becomes."""
        return u + gain_asymmetry * abs(u)

    def same_as(self, model: Model) -> str:
        """A drive that is weaker one way, and one that is stronger the other way: only ratios of gain and plant are
        seen.
        """
        del model
        size = abs(self.gain_asymmetry)
        if size < 0.01:
            return ""
        return (
            "force_gain_asymmetry states both gains about their mean; where the stronger way gives the force that is "
            f"recorded, mass, damping and stiffness are {two_digits(1.0 / (1.0 + size))} times as large."
        )

    def keeps_gain(self) -> bool:
        """Its gain is 1 + g or 1 - g at every command."""
        return self.gain_asymmetry == 0.0

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether it pushes and pulls."""
        force = np.asarray(record.force_at(record.time))
        return bool(np.any(force > 0.0) and np.any(force < 0.0))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ForceGainAsymmetry, ...]:
        """Five per cent, either way."""
        del record, plant
        return cls(0.05), cls(-0.05)
