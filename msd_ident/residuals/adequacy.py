"""Tests of a residual: size, whiteness, and independence of force and motion.

Three questions, each with a probability that a right model would look so bad: is the residual larger than the noise; is
it correlated with itself (Ljung and Box 1978, and sums over blocks for what is slow); does it depend on force and
motion. All are asked of runs of equal readings, not of samples: the rounding error of an encoder at rest is constant
and is no sign of anything.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import BLOCKS, LAGS
from msd_ident.residuals.noise_model import NOISE_ERROR, Readings
from msd_ident.tuning import tuned

LEVEL = tuned(
    1e-5, unit="1", why="probability of calling a right model wrong, for each of the three questions", chosen="by hand"
)


@dataclass(frozen=True)
class Adequacy:
    """Result of the residual tests.

    Attributes:
        ratio: residual over noise, both as root mean squares over pieces of evidence.
        size: probability that noise alone leaves a residual of this size, over all records or in the worst of them.
        whiteness: probability that noise alone is as strongly correlated with itself.
        independence: probability that noise alone is as strongly correlated with force, position, velocity and time.
    """

    ratio: float
    size: float
    whiteness: float
    independence: float

    @property
    def consistent(self) -> bool:
        """Whether the residual is what noise would be."""
        return min(self.size, self.whiteness, self.independence) > LEVEL

    @property
    def material(self) -> bool:
        """Whether the misfit is as large as the noise itself: chi² at least doubled."""
        return self.ratio**2 > 2.0


def judge(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> Adequacy:
    """Test the residuals for size, whiteness and independence; the size over all records and in each of them.

    Args:
        residuals: model − data of each record, (n,) each.
        readings: of the same records, with noise and weights.
    """
    pieces = np.array([part.evidence for part in readings])
    chi = np.array([part.chi(residual) for residual, part in zip(residuals, readings, strict=True)])
    size = _size(float(chi.sum()), float(pieces.sum()))
    if len(readings) > 1:
        size = min(size, min(len(readings) * _size(*pair) for pair in zip(chi, pieces, strict=True)))
    white, free = 1.0, 1.0
    for residual, part in zip(residuals, readings, strict=True):
        values = part.by_run(residual)
        white = min(white, len(residuals) * _whiteness(values, part.rounded))
        free = min(free, len(residuals) * _independence(values, part))
    return Adequacy(math.sqrt(chi.sum() / pieces.sum()), size, white, free)


def _size(chi: float, pieces: float) -> float:
    """Probability that noise alone leaves at least this chi² in so many pieces of evidence."""
    excess = (math.sqrt(chi / pieces) - 1.0) / math.hypot(math.sqrt(0.5 / pieces), 0.5 * NOISE_ERROR)
    return float(special.ndtr(-excess))


def _whiteness(values: FloatArray, rounded: bool) -> float:
    """Probability that independent values are as correlated, from lags and from block sums, corrected for the chances.

    Rounding errors of a smooth motion beat from one run to the next, so neighbouring lags say nothing where they rule.
    """
    count = values.size
    if count < 5 * LAGS:
        return 1.0
    centred = values - values.mean()
    variance = float(centred @ centred)
    if variance == 0.0:
        return 1.0
    lags = np.array([float(centred[lag:] @ centred[:-lag]) for lag in range(1, LAGS + 1)]) / variance
    box = count * (count + 2.0) * float(np.sum(lags**2 / (count - np.arange(1, LAGS + 1))))
    found = [1.0 if rounded else float(special.chdtrc(LAGS, box))]
    for block in BLOCKS:
        blocks = count // block
        if blocks < 8:
            continue
        sums = centred[: blocks * block].reshape(blocks, block).sum(axis=1)
        found.append(float(special.chdtrc(blocks, float(sums @ sums) / (block * variance / count))))
    return min(1.0, len(found) * min(found))


def _independence(values: FloatArray, part: Readings) -> float:
    """Probability that independent values correlate so well with smooth functions of force, motion and time."""
    count = values.size
    if count < 100:
        return 1.0
    members = np.bincount(part.runs)

    def run_mean(signal: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(part.runs, weights=signal) / members)

    record = part.record
    stretch = max(record.samples // 300, 1)
    position = record.position - record.position.mean()
    velocity = np.gradient(np.convolve(position, np.ones(stretch) / stretch, mode="same"), record.time)
    force = record.force_at(record.time)
    time = record.time - record.time.mean()
    columns = [
        position,
        velocity,
        np.sign(velocity),
        force,
        time,
        position**2,
        velocity * np.abs(velocity),
        position**3,
    ]
    basis = np.stack([run_mean(column) for column in columns], axis=1)
    basis -= basis.mean(axis=0)
    basis = basis[:, basis.std(axis=0) > 0.0]
    frame = np.linalg.qr(basis / np.linalg.norm(basis, axis=0))[0]
    centred = values - values.mean()
    share = float(np.sum((frame.T @ centred) ** 2) / max(float(centred @ centred), 1e-300))
    return float(special.chdtrc(basis.shape[1], count * share))
