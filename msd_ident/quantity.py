"""A number with its unit and its interval: what every result is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

#: Two-sided 95 % quantile of the normal distribution.
Z95 = 1.959963984540054
#: Standard deviation of a normal distribution over its median absolute deviation.
MAD = 1.482602218505602


def counted(number: int | str, noun: str) -> str:
    """A number of things in words, such as ``1 topic`` and ``2 topics``."""
    return f"{number} {noun}" if str(number) == "1" else f"{number} {noun}s"


@dataclass(frozen=True)
class Quantity:
    """An estimated value, its standard deviation and its unit.

    ``std`` is NaN where the data leaves the value open; then ``low`` and ``high`` are NaN
    too, and whoever prints it prints no interval.
    """

    value: float
    std: float
    unit: str

    @property
    def low(self) -> float:
        """Lower end of the 95 % interval."""
        return self.value - Z95 * self.std

    @property
    def high(self) -> float:
        """Upper end of the 95 % interval."""
        return self.value + Z95 * self.std

    @property
    def known(self) -> bool:
        """Whether the data decides the value, i.e. there is an interval to print."""
        return math.isfinite(self.value) and math.isfinite(self.std)


def two_digits(value: float) -> str:
    """Two digits of a number, or the whole number where it has more."""
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def probability(value: float) -> str:
    """A probability in per cent that never claims certainty."""
    percent = 100.0 * value
    if percent > 99.9:
        return "> 99.9 %"
    if percent < 0.01:
        return "< 0.01 %"
    return f"{percent:.1f} %" if percent >= 1.0 else f"{percent:.2g} %"
