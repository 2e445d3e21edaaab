"""Dates with times, and times of day, in the cells of a table: loggers write them.

Dates are those of ISO 8601, ``2025-11-09T09:27:03.748Z``. Times are ``09:27:03.748``, or ``27:03.7`` as spreadsheets
and stop watches have them.
"""

from __future__ import annotations

import math
import re
from datetime import datetime

_CELL = re.compile(
    r"(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d):(\d\d)(?:[.,](\d{1,9}))? ?(Z|[+-]\d\d(?::?\d\d)?)?", re.ASCII
)
#: Hours, minutes and seconds; without hours a fraction is needed: 12:34 may be of hours and minutes.
_CLOCK = re.compile(r"(?:(\d{1,3}):([0-5]\d):([0-5]\d)(?:[.,](\d{1,9}))?|(\d{1,3}):([0-5]\d)[.,](\d{1,9}))", re.ASCII)
_NANO = 1_000_000_000


class OtherForm(ValueError):
    """A cell is a date or a time, and not of the form that its column has; the text is what was expected."""


class SinceFirst:
    """Seconds from the first date, or time of day, of a column to each of its cells, in the order of the lines.

    Times of day go on behind midnight: where the clock falls by more than half a day, a day is added. Those without
    hours go on behind a full hour.

    Attributes:
        count: cells that were dates or times.
    """

    def __init__(self) -> None:
        self.count = 0
        self._first = (0, "")
        self._example = ""
        self._last = self._added = self._period = 0
        self._falls: list[int] = []  # lines where a period was added

    def seconds(self, cell: str, line: int) -> float:
        """Seconds of a cell; NaN where it is neither a date nor a time.

        Args:
            cell: its text.
            line: its number, for the note.

        Raises:
            OtherForm: its form is not that of the first one.
        """
        date, time = nanoseconds(cell), clock(cell)
        if date is None and time is None:
            return math.nan
        stamp, form = date if date is not None else (0, "")
        if time is not None:
            stamp, form = self._going_on(*time, line), "time of day"
        if not self.count:
            self._first, self._example = (stamp, form), cell
        self.count += 1
        first, wanted = self._first
        if form != wanted:
            raise OtherForm(
                f"a time like the first one, {self._example}"
                if "time of day" in (form, wanted)
                else f"a date of the same zone as the first one ({wanted or 'none'})"
            )
        return (stamp - first) / _NANO

    def note(self, heading: str) -> str:
        """A sentence on times of day; empty for dates.

        Args:
            heading: of the column.
        """
        if self._first[1] != "time of day":
            return ""
        said = f"column {heading} has times of day, which are read as seconds from the first one, {self._example}"
        if not self._falls:
            return f"{said}."
        more = f" and {len(self._falls) - 1} more" if len(self._falls) > 1 else ""
        passed, added = ("midnight", "a day") if self._period > 3600 * _NANO else ("a full hour", "an hour")
        return f"{said}; {added} was added where the clock passes {passed} (line {self._falls[0]}{more})."

    def _going_on(self, stamp: int, period: int, line: int) -> int:
        """Time [ns] of a clock that begins again after a period [ns]; lines that came late do not move it on."""
        change = stamp - self._last if self.count else 0
        if 2 * change < -period and self._last < period:
            self._added += period
            self._falls.append(line)
            self._period = period
        elif 2 * change > period and self._added:
            self._added -= period
            self._falls.pop()
        self._last = stamp
        return stamp + self._added


def is_time(cell: str) -> bool:
    """Whether a cell is a date with a time, or a time of day."""
    return nanoseconds(cell) is not None or clock(cell) is not None


def clock(cell: str) -> tuple[int, int] | None:
    """Time [ns] of a time of day, and after how many it begins again; None where a cell is no such time."""
    found = _CLOCK.fullmatch(cell)
    if found is None:
        return None
    hour, minute, second, fraction, minute_alone, second_alone, fraction_alone = found.groups()
    if minute_alone is not None:
        return _nano(60 * int(minute_alone) + int(second_alone), fraction_alone), 3600 * _NANO
    return _nano(3600 * int(hour) + 60 * int(minute) + int(second), fraction), 86_400 * _NANO


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
    return _nano(seconds, fraction), zone or ""


def _nano(seconds: int, fraction: str | None) -> int:
    return seconds * _NANO + int((fraction or "").ljust(9, "0"))
