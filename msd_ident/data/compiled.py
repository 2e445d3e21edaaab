"""Functions of scipy.signal and scipy.ndimage, compiled, with the same digits.

Importing scipy.signal takes a quarter of a second, a fifth of ``msd identify``; these and ``local_polynomial`` are all
that it and ``msd diagnose`` need of it. Importing scipy.ndimage takes a thirtieth of ``msd identify``.
"""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt
from numba import njit

from msd_ident.data.record import FloatArray


def all_pole(coefficients: FloatArray, signal: FloatArray) -> FloatArray:
    """A signal through 1 / (1 + a₁z⁻¹ + … + a_pz⁻ᵖ), at rest before it, as ``scipy.signal.lfilter([1], a, signal)``.

    Args:
        coefficients: (p + 1,) a, the first of them 1.
        signal: (n,) or (k, n), each row on its own.
    """
    rows = np.atleast_2d(np.ascontiguousarray(signal, dtype=np.float64))
    return cast(FloatArray, _all_pole(coefficients, rows).reshape(signal.shape))


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _all_pole(coefficients, rows):  # type: ignore[no-untyped-def]
    """Direct form II, transposed: the sums have the order of scipy's, so that their rounding is the same."""
    order = coefficients.size - 1
    found = np.empty_like(rows)
    for row in range(rows.shape[0]):
        state = np.zeros(order + 1)
        for n in range(rows.shape[1]):
            value = state[0] + rows[row, n]
            for i in range(order):
                state[i] = state[i + 1] - coefficients[i + 1] * value
            found[row, n] = value
    return found


def pole_zero(above: FloatArray, below: FloatArray, signal: FloatArray) -> FloatArray:
    """A signal through (b₀ + … + b_pz⁻ᵖ) / (a₀ + … + a_pz⁻ᵖ), at rest before it, as ``scipy.signal.lfilter``.

    Args:
        above: (p + 1,) b, with p at least 1.
        below: (p + 1,) a, the first of them not 0.
        signal: (n,).
    """
    upper, lower = np.asarray(above, dtype=np.float64) / below[0], np.asarray(below, dtype=np.float64) / below[0]
    return cast(FloatArray, _pole_zero(upper, lower, np.ascontiguousarray(signal, dtype=np.float64)))


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _pole_zero(above, below, signal):  # type: ignore[no-untyped-def]
    order = above.size - 1
    found = np.empty_like(signal)
    state = np.zeros(order + 1)
    for n in range(signal.size):
        value = signal[n]
        result = state[0] + above[0] * value
        for i in range(order):
            state[i] = state[i + 1] + value * above[i + 1] - result * below[i + 1]
        found[n] = result
    return found


def ranked(signal: FloatArray, rank: int, window: int) -> FloatArray:
    """The value of a rank within each window, as ``scipy.ndimage.rank_filter`` finds it away from the ends.

    Args:
        signal: (n,).
        rank: 0 for the smallest value of the window, at most window - 1.
        window: number of values, at most n; short, for each is looked at.

    Returns:
        (n - window + 1,), of the window that begins at each value.
    """
    return cast(FloatArray, _ranked(np.ascontiguousarray(signal, dtype=np.float64), rank, window))


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _ranked(signal, rank, window):  # type: ignore[no-untyped-def]
    found = np.empty(signal.size - window + 1)
    ordered = np.empty(window)
    for n in range(signal.size):
        last = n
        if n >= window:
            last = window - 1
            old, i = signal[n - window], 0
            while i < last and ordered[i] != old:
                i += 1
            while i < last:
                ordered[i] = ordered[i + 1]
                i += 1
        while last > 0 and ordered[last - 1] > signal[n]:
            ordered[last] = ordered[last - 1]
            last -= 1
        ordered[last] = signal[n]
        if n >= window - 1:
            found[n - window + 1] = ordered[rank]
    return found


def peaks(signal: FloatArray, prominence: float) -> npt.NDArray[np.int64]:
    """Indices of local maxima that stand out, flat tops by their middle; as ``scipy.signal.find_peaks`` finds them.

    Args:
        signal: (n,).
        prominence: height of a maximum above the higher one of the two lowest points that separate it from higher
            ground, or from the ends.
    """
    return cast("npt.NDArray[np.int64]", _peaks(np.ascontiguousarray(signal, dtype=np.float64), prominence))


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _peaks(signal, prominence):  # type: ignore[no-untyped-def]
    last, found = signal.size - 1, []
    i = 1
    while i < last:
        if signal[i - 1] < signal[i]:
            end = i + 1
            while end < last and signal[end] == signal[i]:
                end += 1
            if signal[end] < signal[i]:
                middle = (i + end - 1) // 2
                if _prominence(signal, middle) >= prominence:
                    found.append(middle)
                i = end
        i += 1
    return np.array(found, dtype=np.int64)


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _prominence(signal, top):  # type: ignore[no-untyped-def]
    height = signal[top]
    left = right = height
    i = top
    while i >= 0 and signal[i] <= height:
        left = min(left, signal[i])
        i -= 1
    i = top
    while i < signal.size and signal[i] <= height:
        right = min(right, signal[i])
        i += 1
    return height - max(left, right)
