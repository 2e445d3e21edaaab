"""A disturbance whose strength and phase come and go."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance, tone_or_reading

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model

#: Modulation frequencies that are tried, in parts of the carrier's.
_SLOWEST, _FASTEST, _TRIALS = 0.01, 0.5, 100


@dataclass(frozen=True)
class ModulatedDisturbance(Effect):
    """A·sin(omega·t + phi) between two sidebands at omega ± Omega: the mesh of a gear out of centre, a fan that beats.

    Sidebands of one size modulate the amplitude alone or the phase alone; of two sizes, both.
    """

    disturbance_amplitude: float
    disturbance_frequency: float
    disturbance_phase: float
    modulation_frequency: float
    lower_sideband_amplitude: float
    lower_sideband_phase: float
    upper_sideband_amplitude: float
    upper_sideband_phase: float

    name = "modulated_disturbance"
    parameters = (
        *PeriodicDisturbance.parameters,
        Parameter("modulation_frequency", "Omega", "rad/s", 0.0, math.inf, "distance of the sidebands"),
        Parameter("lower_sideband_amplitude", "A1", "N", 0.0, math.inf, "amplitude of the lower sideband"),
        Parameter("lower_sideband_phase", "phi1", "rad", -math.inf, math.inf, "phase of the lower sideband at time 0"),
        Parameter("upper_sideband_amplitude", "A2", "N", 0.0, math.inf, "amplitude of the upper sideband"),
        Parameter("upper_sideband_phase", "phi2", "rad", -math.inf, math.inf, "phase of the upper sideband at time 0"),
    )
    exact = (*PeriodicDisturbance.exact, "modulation_frequency", "lower_sideband_phase", "upper_sideband_phase")
    acts_on = "force"
    law = "A·sin(omega·t + phi) + A1·sin((omega - Omega)·t + phi1) + A2·sin((omega + Omega)·t + phi2)"
    source = "sidebands of a gear's mesh frequency: McFadden 1986 (J. Vib. Acoust. 108)"
    neutral = (("disturbance_amplitude", 0.0), ("lower_sideband_amplitude", 0.0), ("upper_sideband_amplitude", 0.0))
    form_of = "periodic_disturbance"
    prior_odds = 1.0 / 100.0
    mirror = False
    steady = False
    harmonic = PeriodicDisturbance.harmonic
    or_else = PeriodicDisturbance.or_else

    def tones(self) -> tuple[float, ...]:
        """The tone and its sidebands, those that are there."""
        middle, apart = self.disturbance_frequency, self.modulation_frequency
        pairs = (
            (self.disturbance_amplitude, middle),
            (self.lower_sideband_amplitude, middle - apart),
            (self.upper_sideband_amplitude, middle + apart),
        )
        return tuple(frequency for amplitude, frequency in pairs if amplitude > 0.0)

    @staticmethod
    def disturbance(
        t: float,
        disturbance_amplitude: float,
        disturbance_frequency: float,
        disturbance_phase: float,
        modulation_frequency: float,
        lower_sideband_amplitude: float,
        lower_sideband_phase: float,
        upper_sideband_amplitude: float,
        upper_sideband_phase: float,
    ) -> float:
        """Force [N] against +x."""
        low = (disturbance_frequency - modulation_frequency) * t + lower_sideband_phase
        high = (disturbance_frequency + modulation_frequency) * t + upper_sideband_phase
        middle = disturbance_amplitude * math.sin(disturbance_frequency * t + disturbance_phase)
        return middle + lower_sideband_amplitude * math.sin(low) + upper_sideband_amplitude * math.sin(high)

    def same_as(self, model: Model) -> str:
        """Tones of the reading."""
        return tone_or_reading(model)

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """A modulation that is slower than the record is long is none that is seen."""
        sideband = PeriodicDisturbance.resolvable(seen)["disturbance_amplitude"]
        return {
            "modulation_frequency": (math.pi / seen.duration, 0.3 * math.pi / seen.period),
            "lower_sideband_amplitude": sideband,
            "upper_sideband_amplitude": sideband,
        }

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[ModulatedDisturbance, ...]:
        """Around the strongest line of the force that the plant leaves unexplained."""
        return cls._around(typical.lines(record, plant, count=1)[0], record, plant)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[ModulatedDisturbance, ...]:
        """Around the tone that was found."""
        amplitude, frequency, phase = simple.values[:3]
        return cls._around((amplitude, frequency, phase), record, plant)

    @classmethod
    def _around(
        cls, tone: tuple[float, float, float], record: Record, plant: Model
    ) -> tuple[ModulatedDisturbance, ...]:
        """With the two distances of the sidebands at which a regression of the unexplained force explains most."""
        time, _, left = typical.unexplained_force(record, plant)
        carrier = np.exp(1j * tone[1] * time)
        left = left - np.mean(left)
        found = []
        lowest = max(_SLOWEST * tone[1], math.pi / record.duration)
        for apart in np.geomspace(lowest, max(_FASTEST * tone[1], 2.0 * lowest), _TRIALS):
            lines = (carrier, carrier * np.exp(-1j * apart * time), carrier * np.exp(1j * apart * time))
            basis = np.column_stack([part for line in lines for part in (line.imag, line.real)])
            gram, right = basis.T @ basis, basis.T @ left
            solution = np.linalg.lstsq(gram, right, rcond=1e-9)[0]
            found.append((float(solution @ right), float(apart), solution))
        gains = [gain for gain, _, _ in found]
        peaks = [i for i, gain in enumerate(gains) if gain >= max(gains[max(i - 1, 0) : i + 2])]
        peaks.sort(key=lambda i: -gains[i])
        return tuple(cls._of(tone[1], *found[i][1:]) for i in peaks[:2])

    @classmethod
    def _of(cls, frequency: float, apart: float, parts: np.ndarray) -> ModulatedDisturbance:
        """From sine and cosine of carrier, lower and upper sideband."""
        terms = [(max(math.hypot(s, c), 1e-9), math.atan2(c, s)) for s, c in parts.reshape(3, 2).tolist()]
        (a, phase), low, high = terms
        return cls.within_bounds(a, frequency, phase, apart, *low, *high)
