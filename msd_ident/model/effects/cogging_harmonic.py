"""Cogging with its second harmonic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.cogging import Cogging

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class CoggingHarmonic(Effect):
    """A·sin(2·pi·x/p + phi) and a second sine of half the pitch."""

    cogging_amplitude: float
    cogging_pitch: float
    cogging_phase: float
    harmonic_amplitude: float
    harmonic_phase: float

    name = "cogging_harmonic"
    parameters = (
        *Cogging.parameters,
        Parameter("harmonic_amplitude", "A2", "N", 0.0, math.inf, "amplitude of the second harmonic"),
        Parameter("harmonic_phase", "phi2", "rad", -math.inf, math.inf, "phase of the second harmonic at x = 0"),
    )
    exact = (*Cogging.exact, "harmonic_phase")
    acts_on = "force"
    law = "A·sin(2·pi·x/p + phi) + A2·sin(4·pi·x/p + phi2)"
    source = "Fourier series of a periodic detent force"
    neutral = (("cogging_amplitude", 0.0), ("harmonic_amplitude", 0.0))
    form_of = "cogging"
    prior_odds = 1.0 / 100.0
    mirror = False
    harmonic = Cogging.harmonic
    ring_down = Cogging.ring_down

    def repeats_after(self) -> float:
        """Between the pitch and half of it."""
        return typical.rms_pitch(self.cogging_pitch, self.cogging_amplitude, self.harmonic_amplitude)

    @staticmethod
    def force(
        x: float,
        cogging_amplitude: float,
        cogging_pitch: float,
        cogging_phase: float,
        harmonic_amplitude: float,
        harmonic_phase: float,
    ) -> float:
        """Force [N] against +x."""
        turn = 2.0 * math.pi * x / cogging_pitch
        return cogging_amplitude * math.sin(turn + cogging_phase) + harmonic_amplitude * math.sin(
            2.0 * turn + harmonic_phase
        )

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[CoggingHarmonic, ...]:
        """The ripples that fit best, with a third of them in the harmonic, in both phases."""
        return cls.from_simple(Cogging.guess(record, plant)[0], record, plant)

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[CoggingHarmonic, ...]:
        """The ripple that was found, with a third of it in the harmonic, in four phases."""
        amplitude = simple.values[0] / 3.0
        return tuple(cls.within_bounds(*simple.values, amplitude, 0.5 * math.pi * turn) for turn in range(4))
