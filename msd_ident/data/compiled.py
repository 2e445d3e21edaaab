"""Functions of scipy.signal and scipy.ndimage, compiled, with the same digits.

Importing scipy.signal takes a quarter of a second, a fifth of ``msd identify``; these and ``local_polynomial`` are all
that it and ``msd diagnose`` need of it. Importing scipy.ndimage takes a thirtieth of ``msd identify``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from msd_ident.compiled import Library
from msd_ident.data.record import FloatArray

LIBRARY = Library(__name__, f"{__name__}_loops")
_all_pole = LIBRARY.function("all_pole", "f8[:]", "f8[:,:]", "f8[:,:]")
_pole_zero = LIBRARY.function("pole_zero", "f8[:]", "f8[:]", "f8[:]", "f8[:]")
_ranked = LIBRARY.function("ranked", "f8[:]", "i8", "i8", "f8[:]")
_peaks = LIBRARY.function("peaks", "f8[:]", "f8", "i8[:]")


def all_pole(coefficients: FloatArray, signal: FloatArray) -> FloatArray:
    """A signal through 1 / (1 + a₁z⁻¹ + … + a_pz⁻ᵖ), at rest before it, as ``scipy.signal.lfilter([1], a, signal)``.

    Args:
        coefficients: (p + 1,) a, the first of them 1.
        signal: (n,) or (k, n), each row on its own.
    """
    rows = np.atleast_2d(np.ascontiguousarray(signal, dtype=np.float64))
    found = np.empty_like(rows)
    _all_pole(np.ascontiguousarray(coefficients, dtype=np.float64), rows, found)
    return found.reshape(signal.shape)


def pole_zero(above: FloatArray, below: FloatArray, signal: FloatArray) -> FloatArray:
    """A signal through (b₀ + … + b_pz⁻ᵖ) / (a₀ + … + a_pz⁻ᵖ), at rest before it, as ``scipy.signal.lfilter``.

    Args:
        above: (p + 1,) b, with p at least 1.
        below: (p + 1,) a, the first of them not 0.
        signal: (n,).
    """
    upper, lower = np.asarray(above, dtype=np.float64) / below[0], np.asarray(below, dtype=np.float64) / below[0]
    given = np.ascontiguousarray(signal, dtype=np.float64)
    found = np.empty_like(given)
    _pole_zero(upper, lower, given, found)
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
    found = np.empty(signal.size - window + 1)
    _ranked(np.ascontiguousarray(signal, dtype=np.float64), rank, window, found)
    return found


def peaks(signal: FloatArray, prominence: float) -> npt.NDArray[np.int64]:
    """Indices of local maxima that stand out, flat tops by their middle; as ``scipy.signal.find_peaks`` finds them.

    Args:
        signal: (n,).
        prominence: height of a maximum above the higher one of the two lowest points that separate it from higher
            ground, or from the ends.
    """
    found = np.zeros(signal.size // 2 + 2, np.int64)  # no two neighbours are maxima; the last entry says how many
    _peaks(np.ascontiguousarray(signal, dtype=np.float64), prominence, found)
    return found[: found[-1]]
