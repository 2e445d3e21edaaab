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
_OTHER = {"hz", "kg", "g", "w", "j", "%", "c", "°c", "k", "pa"}
_RATES = ("/", "^", "²")
_IN_BRACKETS = re.compile(r"\s*[\[(]\s*([^\[\]()]*[^\[\]()\s\d:,])\s*[\])]$")
_ENDING = re.compile(r"(?:_|\s*/\s*)([A-Za-z]+)$")
#: Signs of a product in a unit: N·m, N*m, N-m, N m.
_PRODUCT = re.compile(r"[·*\s-]")


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
    return _ENDING.sub("", _IN_BRACKETS.sub("", column.strip())).strip().lower()


def unit(column: str) -> tuple[str, str]:
    """Unit of a heading in lower case without signs of a product, and as it is written; empty where there is none.

    The second one is empty for what merely ends the name, which need not be a unit.
    """
    found = _IN_BRACKETS.search(column.strip())
    if found:
        written = found.group(1)
        return _PRODUCT.sub("", written.lower().replace("µ", "u").replace("μ", "u")), written
    found = _ENDING.search(column.strip().replace("µ", "u").replace("μ", "u"))
    return (found.group(1).lower(), "") if found else ("", "")


def is_unit(text: str) -> bool:
    """Whether a text, with brackets around it or without, is a unit that a heading may have; so is an empty one."""
    name = _PRODUCT.sub("", text.strip().strip("()[]").lower().replace("µ", "u").replace("μ", "u"))
    return name in {"", "-", *_LENGTH, *_FORCE, *_TIME, *_OTHER} or any(sign in name for sign in _RATES)


def _looked_up(
    column: str, known: dict[str, tuple[str, float]], default: tuple[str, float], expected: str, option: str
) -> tuple[str, float]:
    name, written = unit(column)
    other = name in {*_LENGTH, *_FORCE, *_TIME, *_OTHER} or any(sign in written for sign in _RATES)
    if written and name not in known and other:
        raise DataError(
            f"column {column} is in {written}; expected {expected}: choose another --{option}, or give --{option}-unit "
            f"and --{option}-scale"
        )
    return known.get(name, default)
