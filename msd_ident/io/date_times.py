"""Dates with times in a table (ISO 8601, ``2025-11-09T09:27:03.748Z``) as seconds: loggers write them."""

from __future__ import annotations

import re

import numpy as np

#: A cell of its own that is a date and a time of day, with the zone if it has one.
_CELL = re.compile(
    r'(?<![^\n,;\t"]) *(\d{4}-\d\d-\d\d)[T ](\d\d:\d\d:\d\d(?:[.,]\d{1,9})?)'
    r' ?(Z|[+-]\d\d(?::?\d\d)?)? *(?![^\n,;\t"])'
)
#: Characters at the beginning of a file within which the first one stands.
_AHEAD = 20_000


def as_seconds(text: str) -> str:
    """Text in which each date with a time is written as seconds since the first one.

    Args:
        text: lines of cells. It stays as it is where no cell is a date, where zones differ, or where one is no date
            (a 13th month).
    """
    if not _CELL.search(text[:_AHEAD]):
        return text
    found = _CELL.findall(text)
    if len({zone for _, _, zone in found}) > 1:
        return text
    try:
        stamps = np.array([f"{day}T{clock.replace(',', '.')}" for day, clock, _ in found], dtype="datetime64[ns]")
    except ValueError:
        return text
    seconds = iter(((stamps - stamps[0]) / np.timedelta64(1, "s")).tolist())
    return _CELL.sub(lambda _: repr(next(seconds)), text)
