"""Thins curves for the screen: the least and the greatest value of each pixel column are kept, so no peak is lost."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray

#: Points that one pixel column needs at most.
POINTS_A_COLUMN = 2


def thinned(
    time: FloatArray, values: FloatArray, start: float, end: float, columns: int
) -> tuple[FloatArray, FloatArray]:
    """The part from ``start`` to ``end`` in at most about two points a column.

    Columns are counted from time 0, not from ``start``: a point does not change while the window passes over it.

    Args:
        time: (n,) rising [s].
        values: (n,) of any unit; NaN where there is none.
        start, end: of the window [s].
        columns: of pixels in the window.

    Returns:
        Time [s] and values, (m,) each: the samples themselves where they are few, else the least and the greatest one
        of each column, in the order in which they came.
    """
    low, high = np.searchsorted(time, (start, end), side="left")
    # One sample on either side, so that the line goes on to the edge.
    low, high = max(int(low) - 1, 0), min(int(high) + 1, time.size)
    time, values = time[low:high], values[low:high]
    if time.size <= POINTS_A_COLUMN * columns:
        return time.copy(), values.copy()
    width = (end - start) / columns
    column = np.floor(time / width)
    begins = np.flatnonzero(np.diff(column, prepend=-math.inf))
    least, greatest = np.fmin.reduceat(values, begins), np.fmax.reduceat(values, begins)
    kept = np.sort(np.concatenate([_first(values, least, begins), _first(values, greatest, begins)]))
    return time[kept], values[kept]


def held(time: FloatArray, values: FloatArray, start: float, end: float, columns: int) -> tuple[FloatArray, FloatArray]:
    """The same for a signal that keeps its value until the next sample, as corners of its steps.

    Before its first sample it is unknown.
    """
    if not time.size:
        return np.empty(0), np.empty(0)
    first = max(int(np.searchsorted(time, start, side="right")) - 1, 0)
    last = int(np.searchsorted(time, end, side="right"))
    time, values = time[first:last], values[first:last]
    if time.size > POINTS_A_COLUMN * columns:
        return thinned(time, values, start, end, columns)
    if not time.size:
        return np.empty(0), np.empty(0)
    at = np.append(np.repeat(np.maximum(time, start), 2)[1:], end)
    return at, np.repeat(values, 2)


def _first(values: FloatArray, wanted: FloatArray, begins: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Index of the first sample of each column that has the wanted value; of its first where none has (NaN)."""
    sizes = np.diff(begins, append=values.size)
    hits = np.flatnonzero(values == np.repeat(wanted, sizes))
    columns, first = np.unique(np.searchsorted(begins, hits, side="right") - 1, return_index=True)
    found = begins.copy()
    found[columns] = hits[first]
    return found
