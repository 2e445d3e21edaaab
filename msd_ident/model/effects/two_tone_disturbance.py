"""A disturbance of two tones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance, tone_or_reading

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class TwoToneDisturbance(Effect):
    """A·sin(omega·t + phi) and a second sine: two machines, or one and its harmonic."""

    disturbance_amplitude: float
    disturbance_frequency: float
    disturbance_phase: float
    second_tone_amplitude: float
    second_tone_frequency: float
    second_tone_phase: float

    name = "two_tone_disturbance"
    parameters = (
        *PeriodicDisturbance.parameters,
        Parameter("second_tone_amplitude", "A2", "N", 0.0, math.inf, "amplitude of the second tone"),
        Parameter("second_tone_frequency", "omega2", "rad/s", 0.0, math.inf, "frequency of the second tone"),
        Parameter("second_tone_phase", "phi2", "rad", -math.inf, math.inf, "phase of the second tone at time 0"),
    )
    exact = (*PeriodicDisturbance.exact, "second_tone_frequency", "second_tone_phase")
    acts_on = "force"
    law = "A·sin(omega·t + phi) + A2·sin(omega2·t + phi2)"
    source = "harmonic forcing, time counted from where the used part of the record begins"
    neutral = (("disturbance_amplitude", 0.0), ("second_tone_amplitude", 0.0))
    form_of = "periodic_disturbance"
    prior_odds = 1.0 / 100.0
    mirror = False
    steady = False
    harmonic = PeriodicDisturbance.harmonic
    or_else = PeriodicDisturbance.or_else

    def tones(self) -> tuple[float, ...]:
        """Those that are there."""
        pairs = (
            (self.disturbance_amplitude, self.disturbance_frequency),
            (self.second_tone_amplitude, self.second_tone_frequency),
        )
        return tuple(frequency for amplitude, frequency in pairs if amplitude > 0.0)

    @staticmethod
    def disturbance(
        t: float,
        disturbance_amplitude: float,
        disturbance_frequency: float,
        disturbance_phase: float,
        second_tone_amplitude: float,
        second_tone_frequency: float,
        second_tone_phase: float,
    ) -> float:
        """Force [N] against +x."""
        first = disturbance_amplitude * math.sin(disturbance_frequency * t + disturbance_phase)
        return first + second_tone_amplitude * math.sin(second_tone_frequency * t + second_tone_phase)

    def same_as(self, model: Model) -> str:
        """Tones of the reading."""
        return tone_or_reading(model)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        tone = PeriodicDisturbance.resolvable(seen)
        return {
            "second_tone_frequency": tone["disturbance_frequency"],
            "second_tone_amplitude": tone["disturbance_amplitude"],
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[TwoToneDisturbance, ...]:
        """The two strongest lines of the force that the plant leaves unexplained."""
        first, second = typical.lines(record, plant, count=2)
        return (cls.within_bounds(*first, *second),)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[TwoToneDisturbance, ...]:
        """The tone that was found, and the strongest of the others."""
        apart = 4.0 * math.pi / record.duration
        others = [line for line in typical.lines(record, plant, count=4) if abs(line[1] - simple.values[1]) > apart]
        return tuple(cls.within_bounds(*simple.values, *line) for line in others[:2])
