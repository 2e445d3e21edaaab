"""Frequency and damping of a free oscillation from its turning points: all of them, and the paper's first two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.data.record import FloatArray
from msd_ident.features import equations
from msd_ident.features.rest_and_turns import Extreme
from msd_ident.quantity import Quantity

#: The way between two turning points counts while it is this many of its standard deviations.
_SIGNIFICANT = 5.0
#: From so many turning points on, they tell the middle of the oscillation better than the place of rest does.
_OWN_MIDDLE = 4


@dataclass(frozen=True)
class TwoPeaks:
    """The paper's values from two peaks on the same side, eqs. 3 to 7.

    Attributes:
        first, second: the peaks.
        logarithmic_decrement: δ, eq. 3.
        damped_period: Td [s], eq. 5.
        damped_frequency: ωd [rad/s], eq. 6.
        damping_ratio: ζ, eq. 4.
        natural_frequency: ωn [rad/s], eq. 7.
    """

    first: Extreme
    second: Extreme
    logarithmic_decrement: Quantity
    damped_period: Quantity
    damped_frequency: Quantity
    damping_ratio: Quantity
    natural_frequency: Quantity


@dataclass(frozen=True)
class AllPeaks:
    """Values from all turning points.

    Attributes:
        natural_frequency: ωn [rad/s].
        damping_ratio: ζ.
        middle: of the oscillation [m].
    """

    natural_frequency: Quantity
    damping_ratio: Quantity
    middle: Quantity


@dataclass(frozen=True)
class Swing:
    """Local values around one turning point, from the distances between three turning points.

    A rest value that dry friction has shifted does not enter. ζ(A) rises as A falls with dry friction, and falls with
    drag.

    Attributes:
        amplitude: A [m].
        damping_ratio, damping_ratio_std: ζ and its standard deviation.
        natural_frequency, natural_frequency_std: ωn and its standard deviation [rad/s].
    """

    amplitude: float
    damping_ratio: float
    damping_ratio_std: float
    natural_frequency: float
    natural_frequency_std: float


def two_peaks(turns: Sequence[Extreme], rest: Quantity) -> TwoPeaks | None:
    """Eqs. 3 to 7 from the first two turning points on the side of the first one.

    Args:
        turns: turning points in time order.
        rest: reading at rest, xss.

    Returns:
        None if there are fewer than two, or if the second is not lower than the first.
    """
    same = [turn for turn in turns if turn.side == turns[0].side] if turns else []
    if len(same) < 2:
        return None
    one, two = same[0], same[1]
    high, low = one.side * (one.value - rest.value), one.side * (two.value - rest.value)
    if not high > low > 0.0:
        return None
    decrement = equations.logarithmic_decrement(one.value, two.value, rest.value)
    decrement_std = math.sqrt(
        (one.value_std / high) ** 2 + (two.value_std / low) ** 2 + (rest.std * (1.0 / low - 1.0 / high)) ** 2
    )
    ratio = equations.damping_ratio(decrement)
    ratio_std = decrement_std * (1.0 - ratio**2) ** 1.5 / (2.0 * math.pi)
    period = equations.damped_period(one.time, two.time)
    period_std = math.hypot(one.time_std, two.time_std)
    damped = equations.damped_frequency(period)
    frequency, frequency_std = _undamped(damped, damped * period_std / period, ratio, ratio_std)
    return TwoPeaks(
        first=one,
        second=two,
        logarithmic_decrement=Quantity(decrement, decrement_std, "1"),
        damped_period=Quantity(period, period_std, "s"),
        damped_frequency=Quantity(damped, damped * period_std / period, "rad/s"),
        damping_ratio=Quantity(ratio, ratio_std, "1"),
        natural_frequency=Quantity(frequency, frequency_std, "rad/s"),
    )


def _undamped(damped: float, damped_std: float, ratio: float, ratio_std: float) -> tuple[float, float]:
    """ωn by eq. 7 and its standard deviation."""
    frequency = equations.natural_frequency(damped, ratio)
    return frequency, frequency * math.hypot(damped_std / damped, ratio * ratio_std / (1.0 - ratio**2))


def _ratio_of_half(fall: float) -> float:
    """ζ of a logarithmic decrement per half-swing: eq. 4 with δ = 2·fall."""
    return equations.damping_ratio(2.0 * fall)


def significant(turns: Sequence[Extreme]) -> list[Extreme]:
    """The first turning points, as long as the distances between them are clearly above the noise and do not grow.

    Where noise is nearly as large as the motion, fitted turning points may change their order; there they end too.
    """
    kept = list(turns[:1])
    before = math.inf
    for one, two in zip(turns, turns[1:], strict=False):
        way = abs(two.value - one.value)
        seen = way >= _SIGNIFICANT * math.hypot(one.value_std, two.value_std) and two.time > one.time
        if not seen or way > 1.02 * before:
            break
        kept.append(two)
        before = way
    return kept


def all_peaks(turns: Sequence[Extreme], rest: Quantity | None, unit: str) -> AllPeaks | None:
    """ωn and ζ from all turning points.

    Half-periods give ωd. The heights above the middle shrink by exp(−πζ/√(1 − ζ²)) in each half-swing. With enough
    points the middle is fitted too, because dry friction may hold the cart beside the rest value. Scatter beyond the
    noise, as dry friction or drag cause it, widens the intervals.

    Args:
        turns: turning points in time order.
        rest: reading at rest; None if it was not measured.
        unit: of the positions.

    Returns:
        None if there are fewer than three turning points, or too few to fit the middle and no ``rest``.
    """
    used = significant(turns)
    if len(used) < 3 or (len(used) < _OWN_MIDDLE and rest is None):
        return None
    order = np.arange(len(used), dtype=np.float64)
    time_std = np.array([turn.time_std if math.isfinite(turn.time_std) else 1.0 for turn in used])
    half, half_std = _slope(order, np.array([turn.time for turn in used]), time_std)
    fitted = _fit_heights(used, rest if len(used) < _OWN_MIDDLE else None)
    if fitted is None:
        return None
    fall, middle = fitted
    ratio = _ratio_of_half(max(fall.value, 1e-9))
    ratio_std = fall.std * (1.0 - ratio**2) ** 1.5 / math.pi
    damped = math.pi / half
    frequency, frequency_std = _undamped(damped, damped * half_std / half, ratio, ratio_std)
    return AllPeaks(
        natural_frequency=Quantity(frequency, frequency_std, "rad/s"),
        damping_ratio=Quantity(ratio, ratio_std, "1"),
        middle=Quantity(middle.value, middle.std, unit),
    )


def _fit_heights(used: Sequence[Extreme], rest: Quantity | None) -> tuple[Quantity, Quantity] | None:
    """(logarithmic decrement a half-swing, middle) of values c + side·A·exp(−i·fall), by weighted least squares."""
    order = np.arange(len(used), dtype=np.float64)
    side = np.array([turn.side for turn in used], dtype=np.float64)
    value = np.array([turn.value for turn in used])
    std = np.array([max(turn.value_std, 1e-9 * abs(used[1].value - used[0].value)) for turn in used])
    ways = np.abs(np.diff(value))
    fall = float(np.median(np.log(ways[:-1] / ways[1:])))
    height = ways[0] / (1.0 + math.exp(-fall))
    start = np.array([value[0] - side[0] * height, height, fall])

    def residual(point: FloatArray) -> FloatArray:
        misfit = (point[0] + side * point[1] * np.exp(-order * point[2]) - value) / std
        return misfit if rest is None else np.append(misfit, (point[0] - rest.value) / max(rest.std, 1e-300))

    scale = np.array([height, height, 0.1])
    found = scipy.optimize.least_squares(residual, start, x_scale=scale, method="lm")
    if not np.all(np.isfinite(found.x)):
        return None
    excess = 2.0 * float(found.cost) / max(found.fun.size - 3, 1)
    jacobian = found.jac * scale
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * max(excess, 1.0)
    spread = np.sqrt(np.diag(covariance)) * scale
    return Quantity(float(found.x[2]), float(spread[2]), "1"), Quantity(float(found.x[0]), float(spread[0]), "")


def _slope(x: FloatArray, y: FloatArray, std: FloatArray) -> tuple[float, float]:
    """Slope of a weighted straight line and its standard deviation, widened by scatter beyond ``std``."""
    weight = np.maximum(std, 1e-15) ** -2.0
    middle = float(np.sum(weight * x) / np.sum(weight))
    spread = float(np.sum(weight * (x - middle) ** 2))
    slope = float(np.sum(weight * (x - middle) * y)) / spread
    rest = y - np.sum(weight * y) / np.sum(weight) - slope * (x - middle)
    excess = float(np.sum(weight * rest**2)) / (x.size - 2) if x.size > 2 else 1.0
    return slope, math.sqrt(max(excess, 1.0) / spread)


def swings(turns: Sequence[Extreme]) -> tuple[Swing, ...]:
    """ζ(A) and ωn(A) from every three consecutive turning points, in time order."""
    used = significant(turns)
    found = []
    for one, two, three in zip(used, used[1:], used[2:], strict=False):
        wide, narrow = abs(two.value - one.value), abs(three.value - two.value)
        ratio = _ratio_of_half(math.log(wide / narrow))
        fall_std = math.sqrt(
            (one.value_std / wide) ** 2
            + (three.value_std / narrow) ** 2
            + (two.value_std * (1.0 / narrow - 1.0 / wide)) ** 2
        )
        ratio_std = fall_std * (1.0 - ratio**2) ** 1.5 / math.pi
        damped = 2.0 * math.pi / (three.time - one.time)
        damped_std = damped * math.hypot(one.time_std, three.time_std) / (three.time - one.time)
        undamped = _undamped(damped, damped_std, ratio, ratio_std)
        found.append(Swing(0.5 * math.sqrt(wide * narrow), ratio, ratio_std, *undamped))
    return tuple(found)


def dead_width(turns: Sequence[Extreme]) -> float:
    """Half-width Fc/k [m] of the zone in which dry friction may hold the cart; 0 if no dry friction shows.

    With viscous and dry friction the distances S between turning points follow the straight line S' = r S − 2(1 + r)
    Fc/k.
    """
    used = significant(turns)
    if len(used) < 5:
        return 0.0
    way = np.abs(np.diff([turn.value for turn in used]))
    std = math.sqrt(2.0) * np.array([turn.value_std for turn in used[2:]])
    ratio, _ = _slope(way[:-1], way[1:], std)
    offset = way[1:] - ratio * way[:-1]
    offset_std = max(float(np.std(offset)), float(np.mean(std))) * math.sqrt(1.0 + way.mean() ** 2 / way.var())
    width = -float(np.mean(offset)) / (2.0 * (1.0 + ratio))
    significant_width = 2.0 * offset_std / math.sqrt(offset.size) / (2.0 * (1.0 + ratio))
    return width if ratio > 0.0 and width > significant_width else 0.0
