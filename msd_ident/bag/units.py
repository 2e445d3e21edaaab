"""Units that a column's name ends with: ``position_mm``, ``control_effort_v``, ``encoder_counts``."""

from __future__ import annotations

import math
import re

#: Ending of a column's name → unit of the record and factor to it.
_LENGTH = {
    "m": ("m", 1.0),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "um": ("m", 1e-6),
    "rad": ("rad", 1.0),
    "deg": ("rad", math.pi / 180),
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
    "a": ("A", 1.0),
}
_TIME = {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_ENDING = re.compile(r"(?:_|\s*[\[(/]\s*)([A-Za-zµ]+)\s*[\])]?$")


def force_unit(column: str) -> tuple[str, float]:
    """Unit and factor to it of a force column; newtons where the name does not say."""
    return _FORCE.get(_ending(column), ("N", 1.0))


def position_unit(column: str) -> tuple[str, float]:
    """Unit and factor to it of a position column; metres where the name does not say."""
    return _LENGTH.get(_ending(column), ("m", 1.0))


def time_factor(column: str) -> float:
    """Factor from the numbers of a time column to seconds."""
    return _TIME.get(_ending(column), 1.0)


def stem(column: str) -> str:
    """Name of a column without its unit, in lower case."""
    return _ENDING.sub("", column.strip()).strip().lower()


def _ending(column: str) -> str:
    found = _ENDING.search(column.strip())
    return found.group(1).lower() if found else ""
