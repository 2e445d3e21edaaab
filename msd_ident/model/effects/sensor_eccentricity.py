"""A sensor wheel out of its centre."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import FloatArray, Model

#: Samples from which its starting values are read.
_ENOUGH = 500
#: Longest pitch that can be told, in parts of the travel: of one and a half turns, half a turn is seen again. A sine
#: over one turn is a bent scale.
_LONGEST = 1.0 / 1.5


@dataclass(frozen=True)
class SensorEccentricity(Effect):
    """The reading is x + e·sin(2·pi·x/p + phi): once a turn of the encoder's wheel it runs ahead and behind."""

    eccentricity: float
    eccentricity_pitch: float
    eccentricity_phase: float = 0.0

    name = "sensor_eccentricity"
    parameters = (
        Parameter("eccentricity", "e", "m", 0.0, math.inf, "amplitude of the reading's error"),
        Parameter("eccentricity_pitch", "p", "m", 1e-9, math.inf, "travel per turn of the encoder's wheel"),
        Parameter("eccentricity_phase", "phi", "rad", -math.inf, math.inf, "phase of the error at x = 0"),
    )
    exact = ("eccentricity_pitch", "eccentricity_phase")
    prior_odds = 1.0 / 40.0
    acts_on = "sensor"
    law = "reading = x + e·sin(2·pi·x/p + phi)"
    source = "once-per-turn error of an encoder that is mounted out of centre"
    neutral = (("eccentricity", 0.0),)
    piecewise_linear = True
    mirror = False

    def repeats_after(self) -> float:
        """One turn of the wheel."""
        return self.eccentricity_pitch

    @staticmethod
    def reading(x: float, eccentricity: float, eccentricity_pitch: float, eccentricity_phase: float) -> float:
        """What the sensor says [m]."""
        return x + eccentricity * math.sin(2.0 * math.pi * x / eccentricity_pitch + eccentricity_phase)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Over less than one and a half turns the error is a bent scale, and nothing shows that it repeats."""
        return {"eccentricity_pitch": (0.03 * seen.span, _LONGEST * seen.span), "eccentricity": (0.0, 0.1 * seen.span)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[SensorEccentricity, ...]:
        """A hundredth of the amplitude, at several pitches and phases."""
        size, span = 0.01 * typical.amplitude(record), 2.0 * typical.amplitude(record)
        phases = (0.0, math.pi / 2.0)
        pitches = [share * span for share in (0.6, 0.35, 0.17)]
        return tuple(cls.within_bounds(size, pitch, phase) for pitch in pitches for phase in phases)

    @classmethod
    def from_residual(cls, record: Record, residual: FloatArray) -> tuple[SensorEccentricity, ...]:
        """The harmonics of the position that explain most of it: an error of the reading is in it as it is."""
        pitches = typical.pitches(2.0 * typical.amplitude(record), longest=_LONGEST)
        every = max(1, record.samples // _ENOUGH)
        found = typical.waves(record.position[::every], -residual[::every], pitches, count=3)
        return tuple(cls.within_bounds(*wave) for wave in found)
