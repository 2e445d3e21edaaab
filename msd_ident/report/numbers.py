"""Format of numbers: digits according to the interval, and usual units."""

from __future__ import annotations

import math
from dataclasses import dataclass

from msd_ident.quantity import Z95, Quantity


@dataclass(frozen=True)
class DisplayUnit:
    """A unit for people: what an SI number is multiplied by, and its name."""

    factor: float
    unit: str


def length_scale(size: float, unit: str) -> DisplayUnit:
    """Centimetres, millimetres or micrometres for a length [m] of this size; other units stay."""
    if unit != "m" or not math.isfinite(size):
        return DisplayUnit(1.0, unit)
    if size >= 5e-3:
        return DisplayUnit(100.0, "cm")
    return DisplayUnit(1e3, "mm") if size >= 5e-4 else DisplayUnit(1e6, "µm")


def shown(quantity: Quantity) -> Quantity:
    """The same quantity in the unit that tables use: lengths, and lengths per unit of force, in cm."""
    if quantity.unit != "m" and not quantity.unit.startswith("m/"):
        return quantity
    return Quantity(100.0 * quantity.value, 100.0 * quantity.std, f"c{quantity.unit}")


def decimals(value: float, std: float) -> int:
    """Decimal places that show two digits of the standard deviation, or four digits of the value."""
    scale = std if math.isfinite(std) and std > 0.0 else abs(value) * 1e-2
    if not math.isfinite(scale) or scale == 0.0:
        return 4
    return int(min(max(1 - math.floor(math.log10(scale)), 0), 9))


def number(value: float, digits: int = 4) -> str:
    """A bare number with ``digits`` significant digits, never in a form that a table must wrap."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    return f"{value:.{digits - 1}e}"


def value(quantity: Quantity) -> str:
    """The value alone, to the digits that its interval carries."""
    if not math.isfinite(quantity.value):
        return "–"
    if abs(quantity.value) >= 1e6 or (quantity.value != 0.0 and abs(quantity.value) < 1e-4) or _tiny(quantity):
        return number(quantity.value)
    return f"{quantity.value:.{decimals(quantity.value, quantity.std)}f}"


def interval(quantity: Quantity) -> str:
    """The 95 % interval as ``low … high``, or words where the data leaves the value open."""
    if not quantity.known:
        return "open"
    if quantity.std == 0.0:
        return "fixed"
    places = decimals(quantity.value, quantity.std)
    if (abs(quantity.value) < 1e-4 and quantity.value != 0.0) or _tiny(quantity):
        return f"{number(quantity.low)} … {number(quantity.high)}"
    return f"{quantity.low:.{places}f} … {quantity.high:.{places}f}"


def _tiny(quantity: Quantity) -> bool:
    """Whether neither a value nor its known interval has a digit among the first four decimals."""
    return quantity.std > 0.0 and max(abs(quantity.value), Z95 * quantity.std) < 1e-4


def with_band(quantity: Quantity) -> str:
    """``value ± half of the 95 % interval``; ``open`` where the data leaves the value open, which no number is then."""
    if not quantity.known:
        return interval(quantity)
    if quantity.std == 0.0:
        return f"{value(quantity)} ({interval(quantity)})"
    half = Z95 * quantity.std
    places = decimals(quantity.value, half)
    if abs(quantity.value) >= 1e6 or _tiny(quantity):
        return f"{number(quantity.value)} ± {number(half, 2)}"
    return f"{quantity.value:.{places}f} ± {half:.{places}f}"
