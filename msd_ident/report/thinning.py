"""Fewer points for the eye: no peak is lost."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from msd_ident.record import FloatArray

#: Most points drawn per curve; beyond that the extremes of each bin are kept.
MAXIMUM_POINTS = 4000


def thinned(time: FloatArray, values: FloatArray, points: int = MAXIMUM_POINTS) -> tuple[FloatArray, FloatArray]:
    """Least and greatest value of each of ``points / 2`` bins, in time order: (≤ points,) each."""
    if values.size <= points:
        return time, values
    edges = np.linspace(0, values.size, points // 2 + 1).astype(int)
    keep: list[int] = []
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        part = values[low:high]
        keep += sorted({low + int(part.argmin()), low + int(part.argmax())})
    index = np.asarray(keep)
    return time[index], values[index]


def spaced(size: int, points: int) -> npt.NDArray[np.intp]:
    """Indices of at most ``points`` of ``size`` samples, evenly spaced: for clouds, where extremes would mislead."""
    return np.unique(np.linspace(0, size - 1, min(size, points)).astype(np.intp))
