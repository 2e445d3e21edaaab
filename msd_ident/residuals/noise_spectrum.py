"""Noise in a residual: its level in motion, and its colour.

The noise of neighbouring samples says nothing about noise that wanders slowly, and that of a whole record nothing about
noise that grows with speed. A residual shows both, where only noise is left. Its noise is modelled as white noise plus
first-order autoregressive noise with a memory of τ samples, a = exp(−1/τ). In units of the readings' noise, its
variance at the frequency ω [rad per sample] is

    s(ω) = L (w + (1 − w) (1 − a²) / (1 + a² − 2 a cos ω)).

The level L is that of the fastest band, which the error of a law hardly reaches, but no more than the readings have
there: what a model adds of its own in that band is no noise. The white part w and the memory τ are the likeliest
(Whittle 1953, Ark. Mat. 2). In the slower bands the
residual may also hold an error of a law, with the prior of ``selection.evidence``. The noise is white unless the
likelihood gains more than its two parameters cost (Schwarz 1978, Ann. Stat. 6).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import digamma

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import ALIKE, TENTH
from msd_ident.residuals.noise_model import NOISE_ERROR, Readings
from msd_ident.residuals.octaves import AT_MOTION, BANDS, OCTAVE_SHAPES, two_sided
from msd_ident.tuning import fixed

_MEMORIES = fixed(
    (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 23.0, 32.0),
    "mathematics",
    "memories that are tried [samples]: a sensor's, much shorter than a swing",
)
_WHITE = fixed((0.0, 0.02, 0.1, 0.3), "mathematics", "white parts that are tried")
_SLOW = fixed(1e-30, "accuracy", "power of a third difference below which a frequency is none")
_MISFIT = fixed(
    TENTH,
    "accuracy",
    "misfit of a spectrum up to which it is that of the noise: off by a factor of 1.5. Measured: noise has 0.001 to "
    "0.02, the motion of a second mass or a gear's play that was taken for noise 0.32 to 3.1",
)
_FINE = fixed(4, "mathematics", "bins of an octave over which a spectrum hardly changes")


@dataclass(frozen=True)
class NoiseSpectrum:
    """The noise that a residual shows.

    Attributes:
        level: L, its variance in units of the readings' noise.
        white: w, the part of it that is white.
        memory: τ of the other part [samples]; 0 where all is white.
        left: (BANDS,) sum of squares that it leaves in each octave, in units of the readings' noise.
        freedom: (BANDS,) degrees of freedom of each octave.
        misfit: mean over the fastest band of r − 1 − log r, r being the residual's power over that of this noise.
    """

    level: float
    white: float
    memory: float
    left: FloatArray
    freedom: FloatArray
    misfit: float = 0.0

    @property
    def chi(self) -> float:
        """Sum of squares that it leaves in all, in units of the readings' noise."""
        return float(self.left.sum())

    @cached_property
    def size(self) -> FloatArray:
        """(BANDS,) variance in each octave, in units of the readings' noise; the level where there is no octave."""
        empty = self.freedom == 0.0
        return np.where(empty, self.level, self.left / np.where(empty, 1.0, self.freedom))

    @property
    def at_motion(self) -> float:
        """Variance in the octaves around the frequency of the motion, in units of the readings' noise."""
        return float(self.size[AT_MOTION].mean())

    @property
    def growth(self) -> float:
        """Its standard deviation in units of the readings' noise."""
        return math.sqrt(self.chi / float(self.freedom.sum()))

    @property
    def differs(self) -> bool:
        """Whether it is more or less, or of another colour, than the readings told."""
        return self.memory != 0.0 or abs(self.level - 1.0) > NOISE_ERROR

    def is_all_of(self, residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> bool:
        """Whether residuals in units of the readings' noise hold no more than this noise, and show it.

        They show it where its level is known to ``NOISE_ERROR``, and it is not mostly rounding: the rounding error of
        an encoder at rest is constant, which looks slow. Where it dominates at rest, the noise in motion must be more.
        And more noise than the readings told must have its shape in the fastest band: a motion that rings has not.
        """
        known = 2.0 / self.freedom[-1] <= NOISE_ERROR**2
        rounded = any(part.rounded for part in readings)
        more = self.growth**2 > 1.0 + NOISE_ERROR
        shown = known and (self.misfit < _MISFIT if more else not rounded)
        return bool(shown and sum(float(one @ one) for one in residuals) < (1.0 + NOISE_ERROR) * self.chi)

    def whitened(self, residual: FloatArray) -> FloatArray:
        """A residual (n,) filtered so that this noise in it becomes white, with the variance of the readings' noise."""
        count = residual.size
        frequency = np.arange(count // 2 + 1, dtype=np.float64) * (2.0 * math.pi / count)
        spectrum = np.fft.rfft(residual) / np.sqrt(self.level * _shape(frequency, self.white, self.memory))
        return np.asarray(np.fft.irfft(spectrum, count))


@dataclass(frozen=True)
class _Bins:
    """A residual's power in bins of frequency.

    Attributes:
        frequency: (b,) mean [rad per sample].
        freedom: (b,) degrees of freedom.
        power: (b,) sum of squares, in units of the readings' noise.
        within: (b, BANDS) 1 where a bin lies in an octave, else 0.
        read: (b,) power of the readings themselves, in the same units: that of their third differences, under a window,
            over what these make of each frequency, so that the slow motion does not leak into the fast band.
    """

    frequency: FloatArray
    freedom: FloatArray
    power: FloatArray
    within: FloatArray
    read: FloatArray

    @property
    def fast(self) -> FloatArray:
        """(b,) degrees of freedom of the bins of the fastest band, 0 elsewhere."""
        return np.asarray(self.freedom * self.within[:, -1])


def estimate(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> NoiseSpectrum | None:
    """The noise in the residuals of a model.

    Args:
        residuals: (n,) of each record, in units of its noise (``Readings.root``).
        readings: of the same records.

    Returns:
        None if no frequency is fast enough.
    """
    bins = _binned(residuals, readings)
    if not bins.fast.any():
        return None
    # Each record has a start of its own, which takes away what is slower.
    longest = TENTH * float(np.mean([part.record.samples for part in readings]))
    tried = [(1.0, 0.0), *((white, memory) for memory in _MEMORIES if memory <= longest for white in _WHITE)]
    shapes = np.array([_shape(bins.frequency, *one) for one in tried])
    likelihood = _log_likelihood(bins, shapes)
    coloured = likelihood.max() > likelihood[0] + math.log(float(bins.fast.sum()))
    best = int(np.argmax(likelihood)) if coloured else 0
    level = _levels(bins, shapes)[best]
    left = (level * shapes[best] * bins.freedom) @ bins.within
    return NoiseSpectrum(
        float(level), *tried[best], left, bins.freedom @ bins.within, _misfit(bins, level * shapes[best])
    )


def only_noise(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> NoiseSpectrum | None:
    """The noise in the residuals of a model that leaves nothing else; None where it leaves more, or nothing shows it.

    Args:
        residuals: (n,) of each record, in units of its noise (``Readings.root``).
        readings: of the same records.
    """
    if not any(np.any(residual) for residual in residuals):
        return None
    found = estimate(residuals, readings)
    return found if found is not None and found.is_all_of(residuals, readings) else None


def heard_floor(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> float:
    """Standard deviation [m] of the noise of a model that leaves nothing else; NaN where it leaves more, where nothing
    shows the noise, and where it is that of the readings.

    Args:
        residuals: (n,) [m] of each record.
        readings: of the same records.
    """
    noise = only_noise([part.root * residual for part, residual in zip(readings, residuals, strict=True)], readings)
    if noise is None or not noise.differs:
        return math.nan
    samples = sum(part.record.samples for part in readings)
    return noise.growth * math.sqrt(sum(part.record.samples * part.noise**2 for part in readings) / samples)


def _shape(frequency: FloatArray, white: float, memory: float) -> FloatArray:
    """Spectrum of noise of unit variance at frequencies [rad per sample]."""
    if memory == 0.0:
        return np.ones_like(frequency)
    keep = math.exp(-1.0 / memory)
    return white + (1.0 - white) * (1.0 - keep**2) / (1.0 + keep**2 - 2.0 * keep * np.cos(frequency))


def _misfit(bins: _Bins, size: FloatArray) -> float:
    """Mean over the fastest band of r − 1 − log r, r being the power there over that of this noise (b,), beyond what
    chance makes of it: log(f/2) − ψ(f/2) in a bin of f degrees of freedom.
    """
    inside = bins.fast > 0.0
    freedom = bins.freedom[inside]
    ratio = np.maximum(bins.power[inside] / (freedom * size[inside]), 1e-12)
    chance = np.log(0.5 * freedom) - digamma(0.5 * freedom)
    return float(np.average(ratio - 1.0 - np.log(ratio) - chance, weights=freedom))


def _levels(bins: _Bins, shapes: FloatArray) -> FloatArray:
    """(s,) likeliest level of noise of each shape (s, b) in the fastest band, as far as the readings allow it."""
    likeliest = (bins.power / shapes) @ bins.within[:, -1] / bins.fast.sum()
    fast = bins.within[:, -1]
    most = ALIKE**2 * (bins.read @ fast) / (shapes @ bins.fast)
    return np.asarray(np.where(most > 0.0, np.minimum(likeliest, most), likeliest))


def _log_likelihood(bins: _Bins, shapes: FloatArray) -> FloatArray:
    """(s,) log likelihood [nats] of noise of each shape (s, b).

    A slower band that holds more than this noise counts as noise of the size that it has, if that is likelier, and pays
    for the error of a law.
    """
    size = shapes * _levels(bins, shapes)[:, None]
    freedom, chi = bins.freedom @ bins.within, (bins.power / size) @ bins.within
    found = -0.5 * (np.log(size) @ bins.freedom + chi.sum(axis=1))
    excess = np.maximum(chi - freedom, 0.0)
    gain = 0.5 * (excess - freedom * np.log1p(excess / np.maximum(freedom, 1.0)))
    error = 0.5 * OCTAVE_SHAPES * np.log1p(excess / OCTAVE_SHAPES)
    return np.asarray(found + np.maximum(gain - error, 0.0)[:, :-1].sum(axis=1))


def _binned(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> _Bins:
    """Power of all records in bins of a part of an octave."""
    parts = [_bins_of(*pair) for pair in zip(residuals, readings, strict=True)]
    return _Bins(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _tapered(count: int) -> FloatArray:
    """A window (n,) of mean square 1 with short cosine tapers (Tukey): noise may grow with speed, at the ends too."""
    edge = int(0.5 * TENTH * count)
    window = np.ones(count)
    window[:edge] = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / max(edge, 1))
    window[count - edge :] = window[:edge][::-1]
    return np.asarray(window / np.sqrt(np.mean(window**2)))


def _bins_of(residual: FloatArray, part: Readings) -> tuple[FloatArray, ...]:
    """The same of one record: the arrays of ``_Bins``."""
    count = residual.size
    power = np.abs(np.fft.rfft(residual)) ** 2 * two_sided(count) / count
    number = np.arange(power.size, dtype=np.float64)
    fine = np.floor(_FINE * np.log2(np.maximum(number, 1.0))).astype(np.intp)
    _, first, place = np.unique(part.octaves.band * (fine[-1] + 1) + fine, return_index=True, return_inverse=True)
    counted = two_sided(count) * (part.evidence / count)
    third = np.diff(part.record.position, 3)
    window = _tapered(third.size)
    differences = np.maximum((2.0 * np.sin(math.pi / count * number)) ** 6, _SLOW)
    read = np.abs(np.fft.rfft(window * third, count)) ** 2 / (differences * part.noise**2 * count)
    return (
        np.asarray(np.bincount(place, number) / np.bincount(place) * (2.0 * math.pi / count), dtype=np.float64),
        np.asarray(np.bincount(place, counted), dtype=np.float64),
        np.asarray(np.bincount(place, power), dtype=np.float64),
        np.eye(BANDS, dtype=np.float64)[part.octaves.band[first]],
        np.asarray(np.bincount(place, counted * read), dtype=np.float64),
    )
