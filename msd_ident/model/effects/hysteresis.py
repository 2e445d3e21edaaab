"""A spring force that remembers the last reversal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS, RUBS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class Hysteresis(Effect):
    """Bouc-Wen with n = 1: within a length L after a reversal the force goes over from -Fh to Fh.

    Between reversals z' = (v/L)(1 - sign(v) z) has a closed form in x, which is what is computed; z = 0 at first.
    """

    hysteresis_force: float
    hysteresis_length: float

    name = "hysteresis"
    parameters = (
        Parameter(
            "hysteresis_force", "Fh", "N", 0.0, math.inf, "largest hysteretic force", holds=True
        ),
        Parameter(
            "hysteresis_length", "L", "m", 1e-9, math.inf, "displacement over which the force reverses",
            advice="ramp the force slowly up and down with small reversals", least=1e-3,
        ),
    )  # fmt: skip
    acts_on = "force"
    law = "Fh·z with z' = (v/L)·(1 - sign(v)·z)"
    source = "Bouc 1967, Wen 1976 (J. Eng. Mech. 102) with n = 1, beta = gamma = 1/2; P. Dahl 1968"
    neutral = (("hysteresis_force", 0.0),)
    memory = (("anchor_x", 0.0), ("anchor_z", 0.0))
    dry_limit = "hysteresis_force"
    ring_down = {RUBS: (1,), DRAGS: (1,), SOFTENS: (1,)}
    measured_by = "load and unload the spring in small steps and read the force at rest"

    @staticmethod
    def force(
        x: float, direction: float, hysteresis_force: float, hysteresis_length: float, anchor_x: float, anchor_z: float
    ) -> float:
        """Force [N] against +x."""
        way = direction * (x - anchor_x) * (1.0 / hysteresis_length)
        left = math.exp(-way) if way < 40.0 else 0.0
        return hysteresis_force * (direction + (anchor_z - direction) * left)

    @staticmethod
    def reversal_anchor_x(x: float) -> float:
        """Position [m] of the reversal."""
        return x

    @staticmethod
    def reversal_anchor_z(
        x: float, direction: float, hysteresis_length: float, anchor_x: float, anchor_z: float
    ) -> float:
        """z at the reversal."""
        way = direction * (x - anchor_x)
        return direction + (anchor_z - direction) * math.exp(-way / hysteresis_length)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """In a decay's one frequency a loop that turns over much of the motion is a drag and a spring that softens.

        What is more than those is left to ``bouc_wen``.
        """
        return {"hysteresis_length": (1e-3 * seen.span, (2.0 if seen.driven else 0.15) * seen.span)}

    def same_as(self, model: Model) -> str:
        """Its limit."""
        del model
        return "Hysteresis with a short length turns into Coulomb friction: the two differ only in small reversals."

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[Hysteresis, ...]:
        """The same force, over each of the lengths of ``guess``."""
        lengths = {guess.hysteresis_length for guess in cls.guess(record, plant)}
        return tuple(cls(force, length) for length in sorted(lengths))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[Hysteresis, ...]:
        """Short and long turning lengths."""
        force, amplitude = 0.05 * typical.force(record, plant), typical.amplitude(record)
        return tuple(cls.within_bounds(force, share * amplitude) for share in (0.03, 0.2, 0.8))
