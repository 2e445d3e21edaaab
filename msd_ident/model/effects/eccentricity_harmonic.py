"""A sensor wheel that is out of its centre and not round."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.sensor_eccentricity import SensorEccentricity

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class EccentricityHarmonic(Effect):
    """The reading's error once a turn of the encoder's wheel, and a second one twice a turn: a tilted or oval wheel."""

    eccentricity: float
    eccentricity_pitch: float
    eccentricity_phase: float
    second_eccentricity: float
    second_eccentricity_phase: float

    name = "eccentricity_harmonic"
    parameters = (
        *SensorEccentricity.parameters,
        Parameter("second_eccentricity", "e2", "m", 0.0, math.inf, "amplitude of the error twice a turn"),
        Parameter("second_eccentricity_phase", "phi2", "rad", -math.inf, math.inf, "phase of that error at x = 0"),
    )
    exact = (*SensorEccentricity.exact, "second_eccentricity_phase")
    prior_odds = 1.0 / 100.0
    acts_on = "sensor"
    law = "reading = x + e·sin(2·pi·x/p + phi) + e2·sin(4·pi·x/p + phi2)"
    source = "Fourier series of the error of an encoder disc over a turn"
    neutral = (("eccentricity", 0.0), ("second_eccentricity", 0.0))
    form_of = "sensor_eccentricity"
    piecewise_linear = True
    mirror = False

    def repeats_after(self) -> float:
        """Between a turn of the wheel and half of it."""
        return typical.rms_pitch(self.eccentricity_pitch, self.eccentricity, self.second_eccentricity)

    @staticmethod
    def reading(
        x: float,
        eccentricity: float,
        eccentricity_pitch: float,
        eccentricity_phase: float,
        second_eccentricity: float,
        second_eccentricity_phase: float,
    ) -> float:
        """What the sensor says [m]."""
        turn = 2.0 * math.pi * x / eccentricity_pitch
        once = eccentricity * math.sin(turn + eccentricity_phase)
        return x + once + second_eccentricity * math.sin(2.0 * turn + second_eccentricity_phase)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """The error twice a turn is seen to repeat over half as many turns."""
        known = SensorEccentricity.resolvable(seen)
        shortest, longest = known["eccentricity_pitch"]
        size = known["eccentricity"]
        return {"eccentricity_pitch": (shortest, 2.0 * longest), "eccentricity": size, "second_eccentricity": size}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[EccentricityHarmonic, ...]:
        """Around the guesses of the simple law."""
        return tuple(one for simple in SensorEccentricity.guess(record, plant)[:2] for one in cls._around(simple))

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[EccentricityHarmonic, ...]:
        """What was found is the error once a turn, or the one twice a turn."""
        return cls._around(simple)

    @classmethod
    def _around(cls, simple: Effect) -> tuple[EccentricityHarmonic, ...]:
        size, pitch, phase = simple.values[:3]
        weak = 0.2 * size
        found = [cls.within_bounds(size, pitch, phase, weak, turn) for turn in _PHASES]
        return (*found, *(cls.within_bounds(weak, 2.0 * pitch, turn, size, phase) for turn in _PHASES))


#: Phases of a harmonic that a search begins from, a quarter apart: one step from any of them finds its strength.
_PHASES = (0.0, 0.5 * math.pi)
