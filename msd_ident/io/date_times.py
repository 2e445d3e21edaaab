"""Dates with times in the cells of a table (ISO 8601, ``2025-11-09T09:27:03.748Z``): loggers write them."""

from __future__ import annotations

import re
from datetime import datetime

_CELL = re.compile(
    r"(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d):(\d\d)(?:[.,](\d{1,9}))? ?(Z|[+-]\d\d(?::?\d\d)?)?", re.ASCII
)
_NANO = 1_000_000_000


def nanoseconds(cell: str) -> tuple[int, str] | None:
    """Time [ns] of a date in the years 1 to 9999, by its own clock, and its zone; None where a cell is no such date."""
    found = _CELL.fullmatch(cell)
    if found is None:
        return None
    year, month, day_of_month, hour, minute, second = map(int, found.groups()[:6])
    fraction, zone = found.groups()[6:]
    try:
        day = datetime(year, month, day_of_month, hour, minute, second)
    except ValueError:
        return None
    seconds = day.toordinal() * 86_400 + day.hour * 3600 + day.minute * 60 + day.second
    return seconds * _NANO + int((fraction or "").ljust(9, "0")), zone or ""
