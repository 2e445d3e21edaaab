"""Damping and frequency as functions of the amplitude, ζ(A) and ωn(A), of every ring-down in the records.

For weak losses ζ(A) ≈ ζ + 2·Fc/(π·k·A) + 4·c·A/(3·π·m): a damping ratio that rises as the amplitude A falls means dry
friction, one that falls means drag; ωn(A) bends with the spring alone.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import chdtri

from msd_ident.data.record import FloatArray
from msd_ident.features import Features
from msd_ident.features.oscillation import Swing
from msd_ident.model.effects import LIBRARY, spoken
from msd_ident.model.effects.law import DRAGS, HARDENS, RUBS, SOFTENS
from msd_ident.residuals.adequacy import LEVEL
from msd_ident.tuning import fixed, tuned

_FEWEST = fixed(3, "mathematics", "swings from which on a trend with the amplitude differs from two values")
#: A law in words, and the effects that make the same ring-down: name → signs of their strength for which they do.
Reading = tuple[str, Mapping[str, tuple[int, ...]]]


def _reading(law: str, sign: str) -> Reading:
    """A law in words, and the effects that say that they make such a ring-down (``Effect.ring_down``)."""
    return law, {effect.name: effect.ring_down[sign] for effect in LIBRARY if sign in effect.ring_down}


_RUBS = _reading("dry friction", RUBS)
_DRAGS = _reading("drag that grows with the square of the speed", DRAGS)
_SOFTENS = _reading("a softening spring", SOFTENS)
_HARDENS = _reading("a hardening spring", HARDENS)
#: Chi² by which a slope must be better than a constant to be reported.
_DECISIVE = float(chdtri(1, LEVEL))
_LEAST = tuned(
    5e-4, unit="1", why="error of a damping ratio, and relative error of a frequency, at least", chosen="by hand"
)


@dataclass(frozen=True)
class Observation:
    """How a value changes with the amplitude, and which laws cause that.

    Attributes:
        seen: the observation, a sentence without its end.
        law: the law that causes it, in words.
        causes: effects that cause the same: name → signs of their strength for which they do.
        simulated: whether the motion of the fitted model, simulated, changes in the same way.
    """

    seen: str
    law: str
    causes: Mapping[str, tuple[int, ...]]
    simulated: bool = False

    def told(self, named: Mapping[str, float], tied: Collection[str] = ()) -> str:
        """The observation as a sentence, with the cause of the diagnosis that makes it, or the law that would.

        Args:
            named: causes of the diagnosis, each with its strength, the first value of ``Effect.neutral``.
            tied: causes that could stand in the place of those.
        """
        for name, strength in named.items():
            if np.sign(strength) in self.causes.get(name, ()):
                return f"{self.seen}, as expected from {spoken(name)}."
        if self.simulated:
            return f"{self.seen}; the simulated motion shows the same."
        for name in tied:
            if name in self.causes:
                return (
                    f"{self.seen}; {spoken(name)} would cause this, which is one of the causes that this data cannot "
                    "tell apart."
                )
        return f"{self.seen}; {self.law} would cause this, but the diagnosis does not name it."


@dataclass(frozen=True)
class RingDown:
    """Local values around turning points, by falling amplitude; all arrays (n,).

    Attributes:
        amplitude: half the way between turning points [m].
        damping_ratio, damping_ratio_std: ζ from three turning points.
        natural_frequency, natural_frequency_std: ωn [rad/s] from the same.
        observations: how damping and frequency change with the amplitude.
        sentences: the same, read with the causes of a diagnosis; without one the observations alone.
    """

    amplitude: FloatArray
    damping_ratio: FloatArray
    damping_ratio_std: FloatArray
    natural_frequency: FloatArray
    natural_frequency_std: FloatArray
    observations: tuple[Observation, ...]
    sentences: tuple[str, ...]

    def read_with(self, named: Mapping[str, float], tied: Collection[str] = ()) -> RingDown:
        """The same with sentences that never contradict a diagnosis.

        Args:
            named: causes of the diagnosis, each with its strength, the first value of ``Effect.neutral``.
            tied: causes that could stand in the place of those.
        """
        return replace(self, sentences=tuple(one.told(named, tied) for one in self.observations))

    def beside(self, simulated: RingDown | None) -> RingDown:
        """The same, with the observations marked that a simulated motion shows too.

        ζ and ωn of a swing are read off as if its losses were viscous, so that another loss shifts them. A trend that
        the simulation has as well is no sign of a further law: nothing of it is left beside the simulation's.
        """
        if simulated is None:
            return self
        order = np.argsort(simulated.amplitude)

        def beyond(value: FloatArray, other: FloatArray) -> FloatArray:
            expected = np.interp(self.amplitude, simulated.amplitude[order], other[order])
            return np.asarray(value - expected + np.mean(expected))

        ratio = beyond(self.damping_ratio * self._rate, simulated.damping_ratio * simulated._rate)
        frequency = beyond(self.natural_frequency, simulated.natural_frequency)
        left = replace(self, damping_ratio=ratio / self._rate, natural_frequency=frequency)._trends("")
        laws = {one.law for one in left}
        return replace(
            self, observations=tuple(replace(one, simulated=one.law not in laws) for one in self.observations)
        )

    @property
    def _rate(self) -> FloatArray:
        """Frequency over its median (n,): ζ times it is ζ·ωn, to which a bent spring does nothing."""
        return self.natural_frequency / np.median(self.natural_frequency)

    def _trends(self, length: str) -> tuple[Observation, ...]:
        """How damping and frequency change with the amplitude, in this unit of length."""
        rate, least = self._rate, _LEAST * float(np.median(self.natural_frequency))
        damping = _Quantity("The damping ratio", "", length, _LEAST, _RUBS, _DRAGS)
        stiffness = _Quantity("The natural frequency", " rad/s", length, least, _SOFTENS, _HARDENS)
        found = _said(self.amplitude, self.damping_ratio * rate, self.damping_ratio_std * rate, damping)
        return found + _said(self.amplitude, self.natural_frequency, self.natural_frequency_std, stiffness)

    def to_json_dict(self) -> dict[str, Any]:
        """Plain lists."""
        return {
            "amplitude_m": self.amplitude.tolist(),
            "damping_ratio": self.damping_ratio.tolist(),
            "damping_ratio_std": self.damping_ratio_std.tolist(),
            "natural_frequency": self.natural_frequency.tolist(),
            "natural_frequency_std": self.natural_frequency_std.tolist(),
            "sentences": list(self.sentences),
        }


def ring_down(features: Sequence[Features], length: str = "m") -> RingDown | None:
    """ζ(A) and ωn(A) of all swings of all responses.

    Args:
        features: of each record.
        length: unit of the positions, for sentences.

    Returns:
        None if there are too few swings.
    """
    swings = [swing for found in features for response in found.responses for swing in response.swings]
    if len(swings) < _FEWEST:
        return None
    swings.sort(key=lambda swing: -swing.amplitude)
    amplitude, ratio, ratio_std, frequency, frequency_std = np.array([_row(swing) for swing in swings]).T
    found = RingDown(amplitude, ratio, ratio_std, frequency, frequency_std, observations=(), sentences=())
    said = found._trends(length)
    return replace(found, observations=said, sentences=tuple(f"{one.seen}." for one in said))


def _row(swing: Swing) -> tuple[float, ...]:
    return (
        swing.amplitude,
        swing.damping_ratio,
        swing.damping_ratio_std,
        swing.natural_frequency,
        swing.natural_frequency_std,
    )


@dataclass(frozen=True)
class _Quantity:
    """What is read off each swing.

    Attributes:
        what: its name.
        unit, length: its unit, and that of the amplitude.
        least: standard deviation that is never undercut.
        rising, falling: what it means when it does so as the amplitude falls.
    """

    what: str
    unit: str
    length: str
    least: float
    rising: Reading
    falling: Reading


def _said(amplitude: FloatArray, value: FloatArray, std: FloatArray, quantity: _Quantity) -> tuple[Observation, ...]:
    """An observation when the values (n,) ± std go with 1/A or with A far better than with nothing.

    Values of an infinite std, of turning points that no curve goes through, say nothing.
    """
    what, unit, length = quantity.what, quantity.unit, quantity.length
    weight = 1.0 / np.hypot(np.where(np.isfinite(std), std, np.inf), quantity.least) ** 2
    if np.count_nonzero(weight) < _FEWEST:
        return ()
    mean = float(np.average(value, weights=weight))
    nothing = float(np.sum(weight * (value - mean) ** 2))
    best = min((_line(shape, value, weight) for shape in (1.0 / amplitude, amplitude)), key=lambda line: line[0])
    if nothing - best[0] < _DECISIVE * max(best[0] / max(value.size - 2, 1), 1.0):
        return ()
    large, small = best[1][0], best[1][-1]
    way, means = ("rises", quantity.rising) if small > large else ("falls", quantity.falling)
    seen = (
        f"{what} {way} from {large:.3g}{unit} at an amplitude of {amplitude[0]:.3g} {length} to {small:.3g}{unit} at "
        f"{amplitude[-1]:.3g} {length}"
    )
    return (Observation(seen, *means),)


def _line(shape: FloatArray, value: FloatArray, weight: FloatArray) -> tuple[float, FloatArray]:
    """(chi², fitted values) of a constant and one shape."""
    basis = np.column_stack([np.ones_like(shape), shape])
    root = np.sqrt(weight)
    solution = np.linalg.lstsq(basis * root[:, None], value * root, rcond=None)[0]
    fitted = basis @ solution
    return float(np.sum(weight * (value - fitted) ** 2)), np.asarray(fitted)
