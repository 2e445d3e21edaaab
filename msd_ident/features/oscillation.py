"""Frequency and damping of a free oscillation from its turning points: all of them, and the paper's first two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.features import equations
from msd_ident.features.swings import Extreme
from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray

#: A turning point counts while it is this many of its standard deviations away from rest.
_SIGNIFICANT = 5.0


@dataclass(frozen=True)
class TwoPeaks:
    """The paper's values from two peaks on the same side, eqs. 3 to 7."""

    first: Extreme
    second: Extreme
    logarithmic_decrement: Quantity
    damped_period: Quantity
    damped_frequency: Quantity
    damping_ratio: Quantity
    natural_frequency: Quantity


@dataclass(frozen=True)
class Swing:
    """One half-swing: amplitude at its middle [m], local damping ratio and natural frequency [rad/s].

    ζ(A) rises as A falls with dry friction and falls with drag.
    """

    amplitude: float
    damping_ratio: float
    natural_frequency: float


def two_peaks(turns: Sequence[Extreme], rest: float, rest_std: float) -> TwoPeaks | None:
    """Eqs. 3 to 7 from the first two turning points on the side of the first one; ``None`` without a decrement."""
    same = [turn for turn in turns if turn.side == turns[0].side] if turns else []
    if len(same) < 2:
        return None
    one, two = same[0], same[1]
    high, low = one.side * (one.value - rest), one.side * (two.value - rest)
    if not high > low > 0.0:
        return None
    decrement = equations.logarithmic_decrement(one.value, two.value, rest)
    decrement_std = math.sqrt(
        (one.value_std / high) ** 2 + (two.value_std / low) ** 2 + (rest_std * (1.0 / low - 1.0 / high)) ** 2
    )
    ratio = equations.damping_ratio(decrement)
    ratio_std = decrement_std * (1.0 - ratio**2) ** 1.5 / (2.0 * math.pi)
    period = equations.damped_period(one.time, two.time)
    period_std = math.hypot(one.time_std, two.time_std)
    damped = equations.damped_frequency(period)
    frequency = equations.natural_frequency(damped, ratio)
    frequency_std = frequency * math.hypot(period_std / period, ratio * ratio_std / (1.0 - ratio**2))
    return TwoPeaks(
        first=one,
        second=two,
        logarithmic_decrement=Quantity(decrement, decrement_std, "1"),
        damped_period=Quantity(period, period_std, "s"),
        damped_frequency=Quantity(damped, damped * period_std / period, "rad/s"),
        damping_ratio=Quantity(ratio, ratio_std, "1"),
        natural_frequency=Quantity(frequency, frequency_std, "rad/s"),
    )


def significant(turns: Sequence[Extreme], rest: float, rest_std: float) -> list[Extreme]:
    """Turning points, from the first on, that stand clear of the rest position and go on shrinking."""
    kept: list[Extreme] = []
    for turn in turns:
        height = turn.side * (turn.value - rest)
        if height < _SIGNIFICANT * math.hypot(turn.value_std, rest_std):
            break
        if kept and height > 1.02 * kept[-1].side * (kept[-1].value - rest):
            break
        kept.append(turn)
    return kept


def all_peaks(turns: Sequence[Extreme], rest: float, rest_std: float) -> tuple[Quantity, Quantity] | None:
    """(ωn, ζ) by weighted regression over all turning points; ``None`` with fewer than three.

    Half-periods give ωd; ln(height) falls by πζ/√(1 − ζ²) a half-swing. Scatter beyond the noise, as dry friction
    or drag make it, widens the intervals.
    """
    used = significant(turns, rest, rest_std)
    if len(used) < 3:
        return None
    order = np.arange(len(used), dtype=np.float64)
    height = np.array([turn.side * (turn.value - rest) for turn in used])
    height_std = np.array([math.hypot(turn.value_std, rest_std) for turn in used])
    time_std = np.array([turn.time_std if math.isfinite(turn.time_std) else 1.0 for turn in used])
    half, half_std = _slope(order, np.array([turn.time for turn in used]), time_std)
    fall, fall_std = _slope(order, np.log(height), height_std / height)
    decrement = max(-fall, 1e-9)
    ratio = decrement / math.hypot(decrement, math.pi)
    ratio_std = fall_std * (1.0 - ratio**2) ** 1.5 / math.pi
    frequency = equations.natural_frequency(math.pi / half, ratio)
    frequency_std = frequency * math.hypot(half_std / half, ratio * ratio_std / (1.0 - ratio**2))
    return Quantity(frequency, frequency_std, "rad/s"), Quantity(ratio, ratio_std, "1")


def _slope(x: FloatArray, y: FloatArray, std: FloatArray) -> tuple[float, float]:
    """Slope of a weighted straight line and its standard deviation, widened by scatter beyond ``std``."""
    weight = np.maximum(std, 1e-15) ** -2.0
    middle = float(np.sum(weight * x) / np.sum(weight))
    spread = float(np.sum(weight * (x - middle) ** 2))
    slope = float(np.sum(weight * (x - middle) * y)) / spread
    rest = y - np.sum(weight * y) / np.sum(weight) - slope * (x - middle)
    excess = float(np.sum(weight * rest**2)) / (x.size - 2) if x.size > 2 else 1.0
    return slope, math.sqrt(max(excess, 1.0) / spread)


def swings(turns: Sequence[Extreme], rest: float, rest_std: float) -> tuple[Swing, ...]:
    """ζ(A) and ωn(A), one a half-swing, in time order."""
    used = significant(turns, rest, rest_std)
    found = []
    for one, two in zip(used, used[1:], strict=False):
        high, low = one.side * (one.value - rest), two.side * (two.value - rest)
        decrement = math.log(high / low)
        ratio = decrement / math.hypot(decrement, math.pi)
        damped = math.pi / (two.time - one.time)
        found.append(Swing(math.sqrt(high * low), ratio, equations.natural_frequency(damped, abs(ratio))))
    return tuple(found)


def dead_width(found: Sequence[Swing]) -> float:
    """Half-width Fc/k [m] of the zone in which dry friction may hold the cart, from ζ(A) ≈ ζ + 2Fc/(πkA); 0 if none.

    The rest value of a cart with dry friction is uncertain by that much.
    """
    if len(found) < 3:
        return 0.0
    inverse = np.array([1.0 / swing.amplitude for swing in found])
    ratio = np.array([swing.damping_ratio for swing in found])
    slope, std = _slope(inverse, ratio, np.full(ratio.size, 1e-6) * inverse / inverse.min())
    return 0.5 * math.pi * slope if slope > 2.0 * std else 0.0
