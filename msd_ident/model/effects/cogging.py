"""A force that repeats along the travel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from msd_ident.model.declarations import PLACE, Harmonic, Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import HARDENS, SOFTENS

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _ripple(x: Any, cogging_pitch: float, cogging_phase: float) -> Any:
    """Its force in parts of the amplitude."""
    return np.sin((2.0 * math.pi / cogging_pitch) * x + cogging_phase)


@dataclass(frozen=True)
class Cogging(Effect):
    """A·sin(2·pi·x/p + phi): magnets of a linear motor, teeth of a belt."""

    cogging_amplitude: float
    cogging_pitch: float
    cogging_phase: float = 0.0

    name = "cogging"
    parameters = (
        Parameter(
            "cogging_amplitude",
            "A",
            "N",
            0.0,
            math.inf,
            "amplitude of the cogging force",
            multistable=True,
            regressor=_ripple,
        ),
        Parameter("cogging_pitch", "p", "m", 1e-9, math.inf, "pitch of the cogging force", least=2e-2),
        Parameter("cogging_phase", "phi", "rad", -math.inf, math.inf, "phase of the cogging force at x = 0"),
    )
    exact = ("cogging_pitch", "cogging_phase")
    acts_on = "force"
    law = "A·sin(2·pi·x/p + phi)"
    source = "first harmonic of the cogging force of permanent-magnet motors"
    neutral = (("cogging_amplitude", 0.0),)
    mirror = False
    harmonic = Harmonic("cogging_amplitude", "cogging_pitch", "cogging_phase", PLACE)
    ring_down = {SOFTENS: (1,), HARDENS: (1,)}
    measured_by = "move the cart through its travel by hand and read the force at rest in steps far below its pitch"

    @staticmethod
    def force(x: float, cogging_amplitude: float, cogging_pitch: float, cogging_phase: float) -> float:
        """Force [N] against +x."""
        return cogging_amplitude * math.sin((2.0 * math.pi / cogging_pitch) * x + cogging_phase)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Of a pitch that is hardly seen once the cart sees a bent spring."""
        return {"cogging_pitch": (typical.PITCHES[0] * seen.span, typical.PITCHES[1] * seen.span)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[Cogging, ...]:
        """The three pitches that best fit the force that the plant leaves unexplained, with amplitude and phase."""
        return tuple(cls.within_bounds(a, p, phi) for a, p, phi in typical.ripples(record, plant, count=3))
