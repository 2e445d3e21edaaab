"""Noise of the readings, and how much independent evidence they contain.

The rounding error of an encoder is the same in all samples of a run of equal readings, so these contain no more
information than one of them. So a run of equal readings counts as one piece of evidence, which its samples share.

Noise ahead of the encoder dithers it. At rest the error of a reading y = round(x + e) has then a part that stays, which
falls steeply with the noise: in units of the encoder step, with σ of e, its variance is exp(−4π²σ²)/(2π²) beside
σ² + 1/12 in all (Widrow and Kollár, Quantization Noise, 2008, chapter 4). Where it is negligible, every sample is a
piece of evidence, although neighbours are often equal: runs would be long where the error is small. So it is without an
encoder step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import noise_floor
from msd_ident.estimate.levels import ALIKE, NEGLIGIBLE, TENTH
from msd_ident.quantity import MAD
from msd_ident.residuals.octaves import Octaves, octaves
from msd_ident.tuning import fixed, tuned

_EXACT = fixed(2e-6, "accuracy", "part of the motion: no solver and no clock is better")
NOISE_ERROR = tuned(
    0.1, unit="1", why="relative error that the estimate of the noise's variance may have", chosen="by hand"
)
#: Noise [encoder steps] that is hardly more than that of rounding: nothing dithers it.
_ALL_ROUNDING = ALIKE / math.sqrt(12.0)
#: Crossings of its mean by the force from which on a stretch stands for the whole record: the mean of so many
#: independent pieces is known to a tenth of their spread.
_TURNS = round(1.0 / TENTH**2)


@dataclass(frozen=True)
class Readings:
    """A record with the weights of its samples.

    Attributes:
        record: the record.
        noise: standard deviation of a reading [m].
        weight: (n,) share of a piece of evidence that each sample holds, in (0, 1].
        runs: (n,) number of the run of equal readings that each sample belongs to.
        step: encoder step [m], 0 where none is visible.
    """

    record: Record
    noise: float
    weight: FloatArray
    runs: npt.NDArray[np.intp]
    step: float = 0.0

    @cached_property
    def evidence(self) -> float:
        """Sum of the weights, in pieces of evidence."""
        return float(self.weight.sum())

    @property
    def rounded(self) -> bool:
        """Whether rounding dominates: readings repeat more often than noise lets them, or the noise is all rounding."""
        return self.evidence < 0.8 * self.record.samples or self.noise < _ALL_ROUNDING * self.step

    @cached_property
    def factor(self) -> FloatArray:
        """(n,) weight over noise squared: what a squared residual is multiplied by."""
        return self.weight / self.noise**2

    @cached_property
    def root(self) -> FloatArray:
        """(n,) root of ``factor``: what turns a residual into units of the noise."""
        return np.asarray(np.sqrt(self.factor))

    @cached_property
    def octaves(self) -> Octaves:
        """Bands of the record's frequencies."""
        return octaves(self.record)

    @cached_property
    def standstills(self) -> tuple[tuple[int, int], ...]:
        """First sample, and the one behind the last, of each run of equal readings that outlasts half a swing."""
        edges = np.concatenate(([0], np.flatnonzero(np.diff(self.runs)) + 1, [self.runs.size]))
        shortest = 0.5 * self.record.samples / self.octaves.swings
        pairs = zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
        return tuple((start, stop) for start, stop in pairs if stop - start > max(shortest, 1.0))

    def thinned(self, keep: int) -> Readings:
        """Every n-th sample, about ``keep`` of them, with the whole force; the same object if it has too few."""
        stride = self.record.samples // keep
        if stride < 2:
            return self
        record = replace(
            self.record,
            time=self.record.time[::stride],
            position=self.record.position[::stride],
            force_time=self.record.force_time,
            force=self.record.force,
        )
        return of_record(record, self.noise, self.step)

    def stretch(self, keep: int) -> Readings:
        """The part of about ``keep`` samples with the largest motion, if it moves and is driven like the whole record.

        The same object if no part is alike, or if the force changes too rarely in it: in a decay, after a few steps, in
        a slow sweep.
        """
        record = self.record
        begins = range(0, record.samples - keep + 1, max(keep // 4, 1))
        parts = [record.window(record.time[first], record.time[first + keep - 1]) for first in begins]
        best = max(parts, key=lambda part: float(np.std(part.position)), default=record)
        alike = all(
            np.ptp(some) >= np.ptp(whole) / ALIKE and np.std(some) < ALIKE * np.std(whole)
            for some, whole in ((best.position, record.position), (best.force, record.force))
        )
        swings = np.count_nonzero(np.diff(np.sign(best.force - best.force.mean())))
        return of_record(best, self.noise, self.step) if alike and swings >= _TURNS else self

    def with_mean_force(self) -> Readings:
        """The same readings with one force between any two samples: its mean there, which has the same impulse.

        The same object if the force is held and changes less often than the position is sampled. The motion is then
        wrong by about (ωh)²/24 of the part that changes within a sample interval h.
        """
        if self._changes_seldom:
            return self
        record = self.record
        mean = np.diff(_impulse(record)[0]) / np.diff(record.time)
        return replace(self, record=replace(record, force_time=record.time[:-1], force=mean, hold="zero"))

    def with_force_lines(self) -> Readings:
        """The same readings with one line of force between any two samples: with its impulse and its first moment.

        The same object if the force is held and changes less often than the position is sampled. The motion is then
        wrong by about (ωh)⁴/720 of the part that changes within a sample interval h.
        """
        if self._changes_seldom:
            return self
        record = self.record
        impulse, integral = _impulse(record)
        step = np.diff(record.time)
        mean = np.diff(impulse) / step
        moment = 0.5 * step * (impulse[1:] + impulse[:-1]) - np.diff(integral)  # about the middle
        half = 6.0 * moment / step**2
        stamps = np.column_stack((record.time[:-1], np.nextafter(record.time[1:], -math.inf))).ravel()
        lines = np.column_stack((mean - half, mean + half)).ravel()
        return replace(self, record=replace(record, force_time=stamps, force=lines, hold="linear"))

    @property
    def _changes_seldom(self) -> bool:
        """Whether the force is held, and changes less often than the position is sampled."""
        record = self.record
        return record.hold == "zero" and int(np.count_nonzero(np.diff(record.force))) < record.samples

    def chi(self, residual: FloatArray) -> float:
        """Weighted sum of squares of a residual (n,) in units of the noise; about ``evidence`` for the true model."""
        return float(self.factor @ residual**2)

    def by_run(self, residual: FloatArray) -> FloatArray:
        """Mean residual of each run, in units of the noise."""
        sums = np.bincount(self.runs, weights=residual)
        return np.asarray(sums / np.bincount(self.runs) / self.noise)


def _impulse(record: Record) -> tuple[FloatArray, FloatArray]:
    """(n,) integral of the force [N·s] from the first sample to each, and (n,) that of this integral [N·s²]."""
    inside = (record.force_time > record.time[0]) & (record.force_time < record.time[-1])
    grid = np.union1d(record.time, record.force_time[inside])
    step, first = np.diff(grid), record.force_at(grid[:-1])
    last = first
    if record.hold == "linear":
        last = np.where(grid[:-1] < record.force_time[0], 0.0, record.force_at(grid[1:]))
    impulse = np.concatenate(([0.0], np.cumsum(0.5 * (first + last) * step)))
    added = impulse[:-1] * step + (2.0 * first + last) / 6.0 * step**2
    integral = np.concatenate(([0.0], np.cumsum(added)))
    samples = np.searchsorted(grid, record.time)
    return impulse[samples], integral[samples]


def of_record(record: Record, noise: float, step: float = 0.0) -> Readings:
    """Weights for readings with the given noise and encoder step [m].

    Args:
        record: with the positions.
        noise: standard deviation ahead of the encoder [m].
        step: of the encoder [m]; 0 if none is visible.
    """
    change = np.flatnonzero(np.diff(record.position) != 0.0)
    edges = np.concatenate(([0], change + 1, [record.samples]))
    lengths = np.diff(edges)
    if _dithered(int(lengths.max()), record.samples, noise, step):
        lengths = np.ones(record.samples, dtype=np.intp)
    runs = np.repeat(np.arange(lengths.size), lengths)
    return Readings(record, noise, 1.0 / np.repeat(lengths, lengths).astype(np.float64), runs, step)


def _dithered(longest: int, samples: int, noise: float, step: float) -> bool:
    """Whether noise makes the rounding errors of an encoder independent of each other.

    Its size must be enough for that, and the record must show it: no run of equal readings is longer than such noise
    lets one be.

    Args:
        longest: samples of the longest run of equal readings.
        samples: of the record.
        noise: standard deviation of a reading [m].
        step: of the encoder [m].
    """
    ahead = (noise / step) ** 2 - 1.0 / 12.0 if step > 0.0 else 0.0
    if ahead <= 0.0:
        return False
    stays = math.exp(-4.0 * math.pi**2 * ahead) / (2.0 * math.pi**2)
    equal = math.erf(0.5 / math.sqrt(2.0 * ahead))  # in the middle between two steps
    return stays < NEGLIGIBLE * (ahead + 1.0 / 12.0) and samples * equal ** (longest - 1) > NEGLIGIBLE


def prepare(records: Sequence[Record]) -> tuple[Readings, ...]:
    """Readings of each record, with the noise of its own rest phases and encoder, or else that of the group."""
    group = noise_floor(tuple(records))
    return tuple(_prepared(record, group) for record in records)


def _prepared(record: Record, group: float) -> Readings:
    step = quality.encoder_step(record)
    return of_record(record, _noise(record, group, step), step)


def _noise(record: Record, group: float, step: float) -> float:
    own = quality.noise_floor(record)
    told = own if math.isfinite(own) and own > 0.0 else group
    if not (math.isfinite(told) and told > 0.0):
        told = scatter(record)
    return max(told, step / math.sqrt(12.0), _EXACT * float(np.ptp(record.position)), 1e-300)


def scatter(record: Record) -> float:
    """Noise [m] of a record without rest or encoder step: deviation of samples from a cubic through neighbours."""
    fourth = np.diff(record.position, 4) / math.sqrt(70.0)
    return MAD * float(np.median(np.abs(fourth - np.median(fourth))))
