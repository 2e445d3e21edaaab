"""Units that a column's heading ends with: ``position_mm``, ``control_effort_v``, ``Angle (rad)``, ``Time [s]``."""

from __future__ import annotations

import math
import re

from msd_ident.errors import DataError

#: Ending of a heading → unit of the record and factor to it.
_LENGTH = {
    "m": ("m", 1.0),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "um": ("m", 1e-6),
    "in": ("m", 0.0254),
    "inch": ("m", 0.0254),
    "rad": ("rad", 1.0),
    "mrad": ("rad", 1e-3),
    "deg": ("rad", math.pi / 180),
    "°": ("rad", math.pi / 180),
    "degrees": ("rad", math.pi / 180),
    "count": ("count", 1.0),
    "counts": ("count", 1.0),
    "ticks": ("count", 1.0),
}
_FORCE = {
    "n": ("N", 1.0),
    "mn": ("N", 1e-3),
    "kn": ("N", 1e3),
    "nm": ("N·m", 1.0),
    "v": ("V", 1.0),
    "mv": ("V", 1e-3),
    "a": ("A", 1.0),
    "ma": ("A", 1e-3),
}
_TIME = {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
#: Units in brackets that are none of a position or force.
_OTHER = {"hz", "kg", "g", "w", "j", "%", "c", "°c", "k", "pa", "mps", "dps", "rpm", "rps"}
_SYMBOLS = {*_LENGTH, *_FORCE, *_TIME, *_OTHER}
#: Symbols that are one only in a product: as words alone they are names, such as a least value.
_IN_PRODUCTS = {"min", "h", "km", "ft"}
_RATES = ("/", "^", "**", "²", "³", "⁻")
_IN_BRACKETS = re.compile(r"\s*[\[(]\s*([^\[\]()]*[^\[\]()\s:,])\s*[\])]$")
_ENDING = re.compile(r"(?:_|\s*/\s*)([A-Za-z]+)$")
#: Signs of a product in a unit: N·m, N*m, N-m, N.m, N m.
_PRODUCT = re.compile(r"[·⋅*.\s-]")
_SYMBOL = re.compile(r"[^\W\d_]+|°")


def force_unit(column: str) -> tuple[str, float]:
    """Unit and factor to it of a force column; newtons where the heading does not say.

    Raises:
        DataError: its unit, in brackets, is that of something else.
    """
    return _looked_up(column, _FORCE, ("N", 1.0), "a force, a torque, a voltage or a current", "force")


def position_unit(column: str) -> tuple[str, float]:
    """Unit and factor to it of a position column; metres where the heading does not say.

    Raises:
        DataError: its unit, in brackets, is that of something else.
    """
    return _looked_up(column, _LENGTH, ("m", 1.0), "a length, an angle or counts", "position")


def of_no_force(position: str) -> str:
    """Unit of the forces of a free decay, whose position has this unit: a joint's are torques."""
    return "N·m" if position == "rad" else "N"


def time_factor(column: str) -> float:
    """Factor from the numbers of a time column to seconds."""
    return _TIME.get(unit(column)[0], 1.0)


def stem(column: str) -> str:
    """Heading without its unit, in lower case."""
    name = column.strip()
    found = _in_brackets(name)
    return _ENDING.sub("", name[: found.start()] if found else name).strip().lower()


def unit(column: str) -> tuple[str, str]:
    """Unit of a heading in lower case without signs of a product, and as it is written; empty where there is none.

    The second one is empty for what merely ends the name, which need not be a unit.
    """
    found = _in_brackets(column.strip())
    if found:
        return _plain(found.group(1)), found.group(1)
    found = _ENDING.search(column.strip().replace("µ", "u").replace("μ", "u"))
    return (found.group(1).lower(), "") if found else ("", "")


def is_unit(text: str) -> bool:
    """Whether a text, with brackets around it or without, is a unit that a heading may have; so is an empty one."""
    name = _plain(text.strip().strip("()[]"))
    return name in {"", "-", *_SYMBOLS} or any(sign in name for sign in _RATES)


def _plain(written: str) -> str:
    """A unit in lower case without signs of a product, as the tables have it."""
    return _PRODUCT.sub("", written.lower().replace("µ", "u").replace("μ", "u"))


def _in_brackets(column: str) -> re.Match[str] | None:
    """What stands in brackets at the end of a heading; with a digit at its end, only a power: it may be a channel."""
    found = _IN_BRACKETS.search(column)
    return found if found and (not found.group(1)[-1].isdecimal() or _is_power(found.group(1))) else None


def _is_power(text: str) -> bool:
    """Whether a text that ends with a digit is a unit, such as m/s^2, rad/s2, m s-2 or ms-2.

    A symbol and a digit alone are the name of a channel: A1, M2.
    """
    symbols = _SYMBOL.findall(text.lower().replace("µ", "u").replace("μ", "u"))
    joined = [symbol for symbol in symbols if symbol[-1] == "s" and symbol[:-1] in _LENGTH]  # ms-2 is m s-2
    if not symbols or not all(symbol in {*_SYMBOLS, *_IN_PRODUCTS, *joined} for symbol in symbols):
        return False
    signed = any(sign in text for sign in _RATES) or len(symbols) > 1
    return signed or bool(joined and "-" in text)


def _looked_up(
    column: str, known: dict[str, tuple[str, float]], default: tuple[str, float], expected: str, option: str
) -> tuple[str, float]:
    name, written = unit(column)
    other = name in _SYMBOLS or name[-1:].isdecimal() or any(sign in written for sign in _RATES)
    if written and name not in known and other:
        raise DataError(
            f"column {column} is in {written}; expected {expected}: choose another --{option}, or give --{option}-unit "
            f"and --{option}-scale"
        )
    return known.get(name, default)
