"""The residual's sum of squares, octave by octave of frequency.

The error of a law has an unknown shape, slow or fast, and it repeats with the motion. So the residual is split into
octaves of frequency, counted from the frequency of the motion. Each octave holds a few independent features of that
error, however many swings were recorded. A right law reduces the residual in all octaves. A law that only resembles it
does so where most of the error is, mostly at the frequency of the motion, and leaves or adds some in the others; the
sum over all frequencies does not show that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.noise import noise_floor
from msd_ident.data.record import FloatArray, Record
from msd_ident.tuning import fixed, tuned

OCTAVE_SHAPES = tuned(
    1.5,
    unit="1",
    why="independent features of a model's error in each octave of frequency",
    chosen="on 76 rigs of foreign laws (`python -m bench.blind --variants --rounds 2 --seed 131000`) 1, 1.5, 2 and 3 "
    "name the family of 51, 56, 58 and 58 of 66, and a false cause with more than 0.9 on 0, 2, 5 and 7; without "
    "octaves 8, 10 and 12 features in all do so on 51, 56, 57 and on 2, 3, 5",
)
_OCTAVES = fixed(
    (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
    "mathematics",
    "ends of the octaves, in units of the motion's own frequency; what is slower or faster is one band each",
)
_ENDS = np.array(_OCTAVES)
#: How many bands there are.
BANDS = _ENDS.size + 1
#: The two bands around the frequency of the motion.
AT_MOTION = slice(_OCTAVES.index(0.5) + 1, _OCTAVES.index(2.0) + 1)


@dataclass(frozen=True)
class Octaves:
    """The bands of a record's frequencies.

    Attributes:
        band: (n // 2 + 1,) number of the band of each frequency of the discrete Fourier transform.
        share: (BANDS,) of the samples' degrees of freedom, that is of white noise.
        swings: the motion's own frequency, in periods over the record. A rest adds none.
    """

    band: npt.NDArray[np.intp]
    share: FloatArray
    swings: float

    def of(self, whitened: FloatArray) -> FloatArray:
        """(BANDS,) sums of squares of the bands of a residual (n,); together they are that of the residual."""
        power = np.abs(np.fft.rfft(whitened)) ** 2 * (two_sided(whitened.size) / whitened.size)
        return np.asarray(np.bincount(self.band, weights=power, minlength=BANDS), dtype=np.float64)


def octaves(record: Record) -> Octaves:
    """Bands of a record's frequencies in units of its motion's: the median of the spectrum of the velocity.

    Of that spectrum, only what white noise of the readings does not reach counts: differences of samples magnify it,
    and the largest of n of its ordinates is about ln n times their mean.
    """
    count = record.samples
    frequency = np.arange(count // 2 + 1, dtype=np.float64)
    velocity = np.diff(record.position, prepend=record.position[0])
    power = np.abs(np.fft.rfft(velocity - velocity.mean())) ** 2
    noise = count * (noise_floor(record) * 2.0 * np.sin(np.pi * frequency / count)) ** 2
    seen = power > 2.0 * math.log(count) * noise
    energy = np.cumsum(np.where(seen, power, 0.0) if seen.any() else power)
    own = max(float(np.searchsorted(energy, 0.5 * energy[-1])), 1.0)
    band = np.searchsorted(_ENDS, frequency / own, side="right")
    share = np.bincount(band, weights=two_sided(count), minlength=BANDS) / count
    return Octaves(band, share, own)


def two_sided(count: int) -> FloatArray:
    """(n // 2 + 1,) real numbers that each frequency of n samples stands for: two, but for the mean and the last."""
    found = np.full(count // 2 + 1, 2.0)
    found[0] = 1.0
    if count % 2 == 0:
        found[-1] = 1.0
    return found
