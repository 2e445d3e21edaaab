"""Encoder step and measurement noise, from the samples alone: no model is needed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Record
from msd_ident.quantity import MAD

#: Standard deviation of a uniform error one step wide, in steps.
_UNIFORM = 1.0 / math.sqrt(12.0)
#: Neighbours on each side from which a sample is interpolated.
_REACH = 4
#: Part of the spectrum that counts as its end, samples that it needs, and the part of what an interpolation leaves
#: below which that is overrated.
_END, _FEWEST, _OVERRATED = 0.125, 400, 0.5
#: Samples that are interpolated at once: few enough to stay in the cache.
_BLOCK = 16_384


@dataclass(frozen=True)
class Noise:
    """Noise of an encoder.

    Attributes:
        floor: noise floor [unit].
        step: encoder step [unit], 0 if none is seen.
        unit: of the position.
    """

    floor: float
    step: float
    unit: str


def noise_of(record: Record) -> Noise:
    """Noise floor and encoder step of a record."""
    return Noise(noise_floor(record), encoder_step(record), record.position_unit)


def _asked_once(what: Callable[[Record], float]) -> Callable[[Record], float]:
    """The same, kept with the record, whose samples never change."""

    @wraps(what)
    def known(record: Record) -> float:
        return record.kept(what.__name__, lambda: what(record), small=True)

    return known


@_asked_once
def encoder_step(record: Record) -> float:
    """Distance between neighbouring encoder readings [unit of the position]; 0.0 when the readings lie on no grid.

    The differences between the readings that occur, in rising order, must be whole multiples of the smallest one.
    Readings with noise of their own do not pass: their smallest difference is an accident.
    """
    levels = np.unique(record.position)
    rounding = 16 * np.finfo(np.float64).eps * float(np.max(np.abs(levels)))
    gaps = np.diff(levels)
    gaps = gaps[gaps > rounding]
    if not gaps.size:
        return 0.0
    step, reach = float(np.min(gaps)), 8.5
    while True:
        # Printed readings are rounded to so many digits. The wider the gaps, the better is the step known from them,
        # and the better it must be known for the next: begin with the narrow ones and double the width.
        near = gaps[gaps < reach * step]
        counts = np.rint(near / step)
        step = float(np.sum(near) / np.sum(counts))
        on_grid = float(np.mean(np.abs(near / step - counts) < 0.1))
        if on_grid < 0.95 and (near.size >= 20 or near.size == gaps.size):
            return 0.0
        if near.size == gaps.size:
            return step
        reach *= 2


@_asked_once
def noise_floor(record: Record) -> float:
    """Standard deviation of the measurement noise, quantisation included [unit of the position].

    Each sample is compared with the value that the polynomial through its neighbours has at its stamp: what is left
    of a sampled motion there is tiny, what is left of white noise is known. Outliers, which are kinks of the motion
    (stops, steps of the force), are left out. Where the encoder rests on one value the comparison shows nothing, and
    the error of an encoder is uniform over one step: the floor is never below step/√12.

    With few samples a swing no polynomial follows the motion. What is left then is the motion's; where the end of the
    spectrum holds far less, that is the noise.
    """
    step = encoder_step(record)
    quantisation = step * _UNIFORM
    residual, moving = _interpolation_error(record, step)
    parts = [part for part in (residual[moving], residual[~moving]) if part.size]
    variance = sum(part.size * _variance(part, quantisation) for part in parts) / max(residual.size, 1)
    fast = _spectral_end(record)
    estimated = fast if fast < _OVERRATED * math.sqrt(variance) else math.sqrt(variance)
    return max(quantisation, estimated)


def _spectral_end(record: Record) -> float:
    """Standard deviation of white noise as strong as the fastest ``_END`` of the spectrum; infinite without one.

    The median of the periodogram there, which for white noise is ln 2 of its mean: lines do not count.
    """
    stamps = np.diff(record.time)
    if record.samples < _FEWEST or float(np.ptp(stamps)) > 0.5 * float(np.mean(stamps)):
        return math.inf
    line = np.linspace(record.position[0], record.position[-1], record.samples)
    window = np.hanning(record.samples)
    power = np.abs(np.fft.rfft((record.position - line) * window)) ** 2 / float(np.sum(window**2))
    return math.sqrt(float(np.median(power[int((1.0 - _END) * power.size) :])) / math.log(2.0))


def _interpolation_error(record: Record, step: float) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Error of interpolating each sample from its neighbours, in units of the noise of one sample, and who moves."""
    time, position = record.time, record.position
    begins = range(0, max(time.size - 2 * _REACH, 1), _BLOCK)
    parts = [slice(begin, begin + _BLOCK + 2 * _REACH) for begin in begins]
    found = [_interpolated(time[part], position[part], step) for part in parts]
    return np.concatenate([error for error, _ in found]), np.concatenate([moves for _, moves in found])


def _interpolated(time: FloatArray, position: FloatArray, step: float) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """The same of a stretch of samples, all but the first and last few.

    Lagrange's formula with the true stamps; the noise of neighbours and sample adds up to the factor divided by.
    """
    middle = slice(_REACH, time.size - _REACH)
    offsets = [k for k in range(-_REACH, _REACH + 1) if k != 0]

    def shifted(values: FloatArray, by: int) -> FloatArray:
        return values[_REACH + by : values.size - _REACH + by]

    estimate = np.zeros(time[middle].size)
    power = np.ones_like(estimate)
    for j in offsets:
        weight = np.ones_like(estimate)
        for i in offsets:
            if i != j:
                weight *= (time[middle] - shifted(time, i)) / (shifted(time, j) - shifted(time, i))
        estimate += weight * shifted(position, j)
        power += weight**2
    # Beside a gap the neighbours lie on one side only and the formula extrapolates: no use.
    usable = power < 10.0
    error = ((position[middle] - estimate) / np.sqrt(power))[usable]
    travel = np.abs(shifted(position, _REACH) - shifted(position, -_REACH))[usable]
    return error, travel > 2.5 * step


def _variance(residual: FloatArray, quantisation: float) -> float:
    """Mean square without outliers; their limit stands on the median, and on the step where most values are 0."""
    limit = 4.0 * max(MAD * float(np.median(np.abs(residual))), quantisation)
    return float(np.mean(residual[np.abs(residual) <= limit] ** 2))
