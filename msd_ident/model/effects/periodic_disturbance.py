"""A force that comes and goes by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import TIME, Harmonic, Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


def _fastest(duration: float, period: float) -> float:
    """Half the sampling rate [rad/s]."""
    del duration
    return math.pi / period


@dataclass(frozen=True)
class PeriodicDisturbance(Effect):
    """A·sin(omega·t + phi): a fan, an unbalanced motor, the mains."""

    disturbance_amplitude: float
    disturbance_frequency: float
    disturbance_phase: float = 0.0

    name = "periodic_disturbance"
    parameters = (
        Parameter("disturbance_amplitude", "A", "N", 0.0, math.inf, "amplitude of the disturbance"),
        Parameter(
            "disturbance_frequency", "omega", "rad/s", 0.0, math.inf, "frequency of the disturbance", ceiling=_fastest
        ),
        Parameter("disturbance_phase", "phi", "rad", -math.inf, math.inf, "phase of the disturbance at time 0"),
    )
    exact = ("disturbance_frequency", "disturbance_phase")
    acts_on = "force"
    law = "A·sin(omega·t + phi)"
    source = "harmonic forcing, time counted from where the used part of the record begins"
    neutral = (("disturbance_amplitude", 0.0),)
    mirror = False
    steady = False
    harmonic = Harmonic("disturbance_amplitude", "disturbance_frequency", "disturbance_phase", TIME)
    or_else = "a tone in the sensor's reading (hum, a base that moves)"
    measured_by = "clamp the cart and record: a tone that stays is the reading's; then switch off everything around"

    @staticmethod
    def disturbance(
        t: float, disturbance_amplitude: float, disturbance_frequency: float, disturbance_phase: float
    ) -> float:
        """Force [N] against +x."""
        return disturbance_amplitude * math.sin(disturbance_frequency * t + disturbance_phase)

    def same_as(self, model: Model) -> str:
        """A tone of the reading: the motion of a linear plant is one with the frequency of the force."""
        return tone_or_reading(model)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """A tone beside which the known force is nothing moves a plant of any scale: that follows any motion."""
        return {
            "disturbance_frequency": (math.pi / seen.duration, 0.6 * math.pi / seen.period),
            "disturbance_amplitude": (0.0, largest(seen)),
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[PeriodicDisturbance, ...]:
        """The three strongest lines of the force that the plant leaves unexplained, with amplitude and phase."""
        return tuple(cls(a, w, phi) for a, w, phi in typical.lines(record, plant, count=3))


def largest(seen: RecordScales) -> float:
    """Largest amplitude [N] of a tone: ten times the force that acts, or that moves the mass as it is seen to move."""
    return 10.0 * max(seen.force, seen.mass * max(seen.acceleration, seen.span * seen.rate**2))


def tone_or_reading(model: Model) -> str:
    """The sentence on what tells a tone of the force from one of the reading: none where all else of a model adds up.

    Args:
        model: with a tone of the force.
    """
    exact = all(effect.adds_up() for effect in model.effects)
    how = "exactly" if exact else "nearly"
    return (
        f"A tone of the reading, A/|k - m·omega² + i·b·omega| in size, does {how} what a tone of the force does: the "
        "sensor may hum or the base move. Clamp the cart to tell them apart: a tone that stays is the reading's."
    )
