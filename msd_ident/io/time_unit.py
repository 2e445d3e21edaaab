"""Unit of a time column: from an option, from its heading, or from whole numbers that can be nothing else."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.io import units

#: Seconds since 1970 of the years 2001 to 2096, where a clock may stand.
_CLOCK = (1e9, 4e9)
#: Factor to seconds and name of the units that clocks count in.
_UNITS = ((1e-9, "nanoseconds"), (1e-6, "microseconds"), (1e-3, "milliseconds"))
#: Sampling periods [s] that whole numbers from 0 on may have in these units: slower than 5 kHz in nanoseconds, up to
#: 5 kHz and not below 5 Hz in microseconds. As seconds they would be minutes; milliseconds are not told from seconds.
_PERIODS = {"nanoseconds": (2e-4, 0.2), "microseconds": (1e-3, 0.2)}


def factor(heading: str, time: FloatArray, given: float | None) -> tuple[float, str]:
    """Factor from the numbers of a time column to seconds, and a note on one that nobody gave.

    Args:
        heading: of the column.
        time: (n,) its numbers, all finite.
        given: ``--time-scale``, or ``None``.
    """
    if given is not None:
        return given, ""
    named = units.time_factor(heading)
    if named is not None:
        return named, f"column {heading} was multiplied by {named:g}, as its unit says." if named != 1.0 else ""
    scale, name = _counted(time)
    if not name:
        unknown = units.unknown_in_brackets(heading)
        unknown = "" if ":" in unknown else unknown  # HH:MM:SS, which the table has read
        said = f"column {heading} is read in seconds: {unknown} is no unit of time. If it is one, give --time-scale."
        return 1.0, said if unknown else ""
    period = scale * float(np.median(np.abs(np.diff(time))))
    return scale, (
        f"column {heading} has whole numbers and no unit: they are taken as {name}, which gives {1.0 / period:.4g} Hz; "
        "if they are not, use --time-scale."
    )


def _counted(time: FloatArray) -> tuple[float, str]:
    """Factor and name of the unit that whole numbers (n,) count in; the name is empty where it may be seconds."""
    if time.size < 2 or np.any(time != np.rint(time)):
        return 1.0, ""
    begin, step = float(time[0]), float(np.median(np.abs(np.diff(time))))
    for scale, name in _UNITS:
        if _CLOCK[0] < begin * scale < _CLOCK[1] and step * scale < 1.0:
            return scale, name
    for scale, name in _UNITS:
        shortest, longest = _PERIODS.get(name, (np.inf, 0.0))
        if shortest <= step * scale <= longest:
            return scale, name
    return 1.0, ""
