"""Fewer points for a plot, without losing peaks."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray

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


def spread(signal: FloatArray, points: int, bins: int = 50) -> npt.NDArray[np.intp]:
    """Indices of about ``points`` samples, as many from each part of the signal's range, evenly spaced in time.

    A cart is at rest most of the time: drawn sample by sample, a cloud would show little else.
    """
    if signal.size <= points:
        return np.arange(signal.size)
    edges = np.linspace(float(signal.min()), float(signal.max()), bins + 1)[1:-1]
    place = np.searchsorted(edges, signal)
    kept = [_spaced(np.flatnonzero(place == one), points // bins) for one in range(bins)]
    return np.sort(np.concatenate(kept))


def _spaced(index: npt.NDArray[np.intp], points: int) -> npt.NDArray[np.intp]:
    if index.size <= points:
        return index
    return index[np.unique(np.linspace(0, index.size - 1, points).astype(np.intp))]
