"""What is read off the samples of a motion: the value at rest, and turning points to a fraction of a sample and of an
encoder step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from msd_ident.data import compiled
from msd_ident.data.noise import Noise
from msd_ident.data.record import FloatArray
from msd_ident.quantity import Quantity

#: Fewest samples that can show that the cart rests.
FEWEST = 3
#: A cart rests while the scatter is no more than this many noise floors.
_QUIET = 1.3
#: Part of a response, at its end, that its rest value is read from, and fewest samples of a response.
TAIL, SHORTEST = 0.15, 12
#: A turning point stands out by this many noise floors, or by this part of the whole swing.
_PROMINENCE_FLOORS, _PROMINENCE_SWING = 6.0, 0.01
#: Part of a half-swing on either side of a turning point that the polynomial through it uses.
_REACH = 0.25


def evidence(position: FloatArray) -> int:
    """Number of runs of equal readings in ``position`` (n,): a reading that the encoder repeats counts once."""
    return 1 + int(np.count_nonzero(np.diff(position)))


def is_quiet(position: FloatArray, noise: Noise) -> bool:
    """Whether readings show noise alone: no scatter beyond noise floor and one encoder step, and no drift.

    Args:
        position: (n,) readings [m].
        noise: of the encoder.
    """
    if position.size < FEWEST:
        return False
    scatter = float(np.std(position))
    # Few readings scatter more, and less, than the noise behind them.
    limit = (_QUIET + 3.0 / math.sqrt(2.0 * position.size)) * noise.floor
    if scatter > limit and float(np.ptp(position)) > 1.01 * noise.step:
        return False
    half = position.size // 2
    drift = abs(float(np.mean(position[:half])) - float(np.mean(position[-half:])))
    readings = max(evidence(position) // 2, 1)
    return drift <= max(4.0 * max(scatter, 1e-300) * math.sqrt(2.0 / readings), 0.51 * noise.step)


def rest_value(position: FloatArray, noise: Noise) -> Quantity:
    """Mean of quiet readings; its standard deviation counts a run of equal readings as one.

    Args:
        position: (n,) readings.
        noise: of the encoder; its floor is the least standard deviation of a reading.
    """
    spread = max(float(np.std(position)), noise.floor)
    return Quantity(float(np.mean(position)), spread / math.sqrt(evidence(position)), noise.unit)


def settled_value(position: FloatArray, noise: Noise) -> Quantity | None:
    """Rest value of readings (n,) that end quiet, from the last ``TAIL`` of them; else ``None``."""
    tail = position[-max(SHORTEST, int(TAIL * position.size)) :]
    return rest_value(tail, noise) if is_quiet(tail, noise) else None


def run_lengths(position: FloatArray) -> FloatArray:
    """For each reading (n,) the number of equal readings in its run."""
    starts = np.flatnonzero(np.concatenate(([True], np.diff(position) != 0.0)))
    lengths = np.diff(np.append(starts, position.size))
    return np.repeat(lengths, lengths).astype(np.float64)


@dataclass(frozen=True)
class Extreme:
    """A turning point.

    Attributes:
        time, time_std: instant and its standard deviation [s].
        value, value_std: reading and its standard deviation [m].
        side: +1 for a maximum, −1 for a minimum.
    """

    time: float
    value: float
    time_std: float
    value_std: float
    side: int


def extremes(time: FloatArray, position: FloatArray, floor: float) -> tuple[Extreme, ...]:
    """Turning points in time order.

    Args:
        time: (n,) [s].
        position: (n,) readings [m].
        floor: noise floor [m], from which the least prominence follows.
    """
    swing = float(np.ptp(position))
    prominence = max(_PROMINENCE_FLOORS * floor, _PROMINENCE_SWING * swing)
    if swing <= prominence or position.size < 8:
        return ()
    found = [(int(i), side) for side in (1, -1) for i in compiled.peaks(side * position, prominence)]
    found.sort()
    alternating = _alternating(found, position)
    return tuple(_refined(time, position, floor, alternating, n) for n in range(len(alternating)))


def _alternating(found: list[tuple[int, int]], position: FloatArray) -> list[tuple[int, int]]:
    """Highs and lows in turn; of neighbours on one side the further one stays."""
    kept: list[tuple[int, int]] = []
    for index, side in found:
        if kept and kept[-1][1] == side:
            if side * position[index] > side * position[kept[-1][0]]:
                kept[-1] = (index, side)
        else:
            kept.append((index, side))
    return kept


def _refined(time: FloatArray, position: FloatArray, floor: float, found: list[tuple[int, int]], n: int) -> Extreme:
    """A quartic through the neighbourhood of the turning point, by least squares, and its top."""
    index, side = found[n]
    neighbours = [found[j][0] for j in (n - 1, n + 1) if 0 <= j < len(found)]
    half = min((abs(j - index) for j in neighbours), default=min(index, position.size - 1 - index))
    first = _through(time, position, floor, index, half)
    if first is None:
        return Extreme(float(time[index]), float(position[index]), math.inf, floor, side)
    # In noise the highest sample may stand well beside the top: look again around the top.
    nearest = int(np.argmin(np.abs(time - first.time)))
    fit = (_through(time, position, floor, nearest, half) if nearest != index else None) or first
    bend = fit.bend
    if neighbours and half:
        # The bend of a swing of this height and duration: noise makes that of the fit too sharp or too flat.
        height = 0.5 * float(np.mean(np.abs(position[neighbours] - fit.value)))
        bend = height * (math.pi / (half * float(np.median(np.diff(time))))) ** 2
    return Extreme(fit.time, fit.value, fit.slope_std / max(bend, 1e-300), fit.value_std, side)


@dataclass(frozen=True)
class _Top:
    """Top of a polynomial [s], [m], its standard deviations [m/s], [m], and its second derivative [m/s²]."""

    time: float
    value: float
    slope_std: float
    value_std: float
    bend: float


def _through(time: FloatArray, position: FloatArray, floor: float, index: int, half: int) -> _Top | None:
    """Least squares around the sample ``index`` of a half-swing of ``half`` samples; ``None`` too near to an end."""
    reach = int(min(max(3, round(_REACH * half)), index, position.size - 1 - index))
    if reach < 2:
        return None
    window = slice(index - reach, index + reach + 1)
    centre, scale = float(time[index]), float(time[index + reach] - time[index])
    u = (time[window] - centre) / scale
    degree = 4 if reach >= 3 else 2
    basis = np.vander(u, degree + 1, increasing=True)
    coefficients: FloatArray = np.linalg.lstsq(basis, position[window], rcond=None)[0].astype(np.float64)
    top = _top(coefficients)
    powers = np.arange(degree + 1)
    row, slope_row = top**powers, powers * np.concatenate(([0.0], top ** powers[:-1]))
    # Equal readings in a row, the flat top of an encoder, are one piece of evidence and not many.
    repeats = u.size / evidence(position[window])
    covariance = np.linalg.inv(basis.T @ basis) * max(floor, 1e-300) ** 2 * repeats
    return _Top(
        time=centre + scale * top,
        value=float(row @ coefficients),
        slope_std=math.sqrt(float(slope_row @ covariance @ slope_row)) / scale,
        value_std=math.sqrt(float(row @ covariance @ row)),
        bend=abs(2.0 * float(coefficients[2])) / scale**2,
    )


def _top(coefficients: FloatArray) -> float:
    """Where the polynomial turns, within the window; 0 (the sample itself) when it does not."""
    slope = coefficients[1:] * np.arange(1, coefficients.size)
    roots = np.roots(slope[::-1])
    inside = [float(r.real) for r in roots if abs(r.imag) < 1e-9 and abs(r.real) <= 1.0]
    return min(inside, key=abs) if inside else 0.0
