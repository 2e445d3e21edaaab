"""An actuator whose gain depends on the command."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class ForceGainNonlinearity(Effect):
    """F·(1 + beta·abs(F)), cut off at a limit where there is one."""

    gain_slope: float
    force_limit: float = math.inf

    name = "force_gain_nonlinearity"
    parameters = (
        Parameter(
            "gain_slope", "beta", "1/N", -math.inf, math.inf, "change of the force gain with the force",
            advice="push with a second amplitude in both directions, and release the cart by hand once",
            open_with_scale="cannot be told from the scale of {others}, as the force has one size only",
        ),
        Parameter(
            "force_limit", "Fmax", "N", 0.0, math.inf, "saturation of the actuator",
            advice="push harder, until the force stops growing",
        ),
    )  # fmt: skip
    acts_on = "input"
    law = "F·(1 + beta·abs(F)), at most Fmax either way"
    source = "second-order static actuator curve with saturation"
    neutral = (("gain_slope", 0.0), ("force_limit", math.inf))
    piecewise_linear = True
    limits_force = "force_limit"
    measured_by = "read the force at rest with a load cell or a spring balance, at several commands"

    @staticmethod
    def input_map(u: float, gain_slope: float, force_limit: float) -> float:
        """Force [N] that a commanded u [N] becomes."""
        made = u * (1.0 + gain_slope * abs(u))
        return min(max(made, -force_limit), force_limit)

    def idle(self) -> frozenset[str]:
        """The slope too, where it is 0 beside a limit: the law is the limit alone."""
        off = super().idle()
        return off | {"gain_slope"} if self.gain_slope == 0.0 and "force_limit" not in off else off

    def keeps_gain(self) -> bool:
        """A limit does; a slope changes the gain at every command."""
        return self.gain_slope == 0.0

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """A limit below nearly all commands is none that is seen: then no written force says anything."""
        several = seen.weakest if seen.weakest < seen.force else 0.0
        return {
            "gain_slope": (-0.9 / seen.force, 10.0 / seen.force),
            "force_limit": (max(0.1 * seen.force, several), seen.force),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ForceGainNonlinearity, ...]:
        """Five per cent more or less at the largest force; no limit."""
        largest = max(float(np.max(np.abs(record.force))), 1e-9)
        return cls(0.05 / largest), cls(-0.05 / largest)
