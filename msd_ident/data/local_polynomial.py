"""The local polynomials of Savitzky and Golay (1964), with the digits of ``scipy.signal.savgol_filter``.

Importing scipy.signal takes a quarter of a second, a tenth of ``msd diagnose``.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.linalg
import scipy.ndimage

from msd_ident.data.record import FloatArray


def local_polynomial(signal: FloatArray, window: int, degree: int, derivative: int, step: float) -> FloatArray:
    """A signal, or its derivative, by the polynomial that fits best around each value.

    Args:
        signal: (n,), evenly sampled; its unit is u.
        window: number of values that a polynomial is fitted to, odd, at most n; at the ends it stays inside.
        degree: of the polynomial.
        derivative: its order d, at most the degree.
        step: between two values [s].

    Returns:
        (n,) [u/sᵈ].
    """
    half = window // 2
    powers = np.arange(half, -half - 1, -1, dtype=np.float64) ** np.arange(degree + 1, dtype=np.float64)[:, None]
    wanted = np.zeros(degree + 1)
    wanted[derivative] = math.factorial(derivative) / step**derivative
    weights = _solved(powers, wanted)
    found: FloatArray = scipy.ndimage.convolve1d(signal, weights, mode="constant")
    found[:half] = _at(signal[:window], degree, derivative, np.arange(float(half))) / step**derivative
    found[-half:] = _at(signal[-window:], degree, derivative, np.arange(half + 1.0, window)) / step**derivative
    return found


def _at(values: FloatArray, degree: int, derivative: int, places: FloatArray) -> FloatArray:
    """Derivative, per step, of the polynomial through (w,) values, at some of their places 0 … w - 1."""
    powers = np.arange(values.size, dtype=np.float64)[:, None] ** np.arange(degree, -1.0, -1.0)
    scale = np.sqrt(np.sum(powers * powers, axis=0))
    coefficients = _solved(powers / scale, values) / scale
    for order in range(derivative):
        rest = degree - order
        coefficients = coefficients[:rest] * np.arange(rest, 0.0, -1.0)
    found = np.zeros(places.size)
    for coefficient in coefficients:
        found = found * places + coefficient
    return found


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    found: FloatArray = scipy.linalg.lstsq(matrix, right, cond=np.finfo(np.float64).eps * max(matrix.shape))[0]
    return found
