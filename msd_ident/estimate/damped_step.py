"""The step of Levenberg and Marquardt inside bounds, which all fits take.

References: Marquardt 1963 (scaling by the diagonal); Kanzow et al. 2004 (projection onto bounds).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import NULL


@njit(nogil=True, cache=True, error_model="numpy")
def damped_step(
    matrix: FloatArray, gradient: FloatArray, damping: float, lowest: FloatArray, highest: FloatArray
) -> tuple[FloatArray, float]:
    """Damped Gauss–Newton step; entries that would leave the bounds are held there, and the rest is solved again.

    With D the root of the matrix's diagonal, it solves (D⁻¹·A·D⁻¹ + λ·I)·D·s = −D⁻¹·g. An entry that the data does not
    tell beside the others stays where it is.

    Args:
        matrix: (p, p) Gauss–Newton matrix A.
        gradient: (p,) half the gradient g of the sum of squares.
        damping: λ.
        lowest, highest: (p,) bounds of the step.

    Returns:
        The step (p,), and the decrease −2·gᵀs − sᵀA·s of the sum of squares that the linear model predicts for it.
    """
    count = gradient.size
    size = np.ones(count)
    for i in range(count):
        if matrix[i, i] > 0.0:
            size[i] = math.sqrt(matrix[i, i])
    scaled, right = matrix / size.reshape(-1, 1) / size, -gradient / size
    for i in range(count):
        scaled[i, i] += damping
    move, free = np.zeros(count), np.ones(count, dtype=np.bool_)
    for _ in range(count):
        _solve(scaled, right - scaled @ np.where(free, 0.0, move * size), free, move)
        move = np.where(free, move / size, move)
        inside = True
        for i in range(count):
            if free[i] and (move[i] < lowest[i] or move[i] > highest[i]):
                move[i] = min(max(move[i], lowest[i]), highest[i])
                free[i] = inside = False
        if inside:
            break
    return move, -float(move @ (2.0 * gradient + matrix @ move))


@njit(nogil=True, cache=True, error_model="numpy")
def _solve(matrix, right, free, solution):  # type: ignore[no-untyped-def]
    """Fill the free entries of the solution, by Cholesky's method."""
    index = np.flatnonzero(free)
    count = index.size
    factor, value = np.empty((count, count)), right[index]
    for a in range(count):
        for c in range(a + 1):
            element = matrix[index[a], index[c]]
            for e in range(c):
                element -= factor[a, e] * factor[c, e]
            if c < a:
                factor[a, c] = element / factor[c, c]
            else:
                factor[a, a] = math.sqrt(element) if element > NULL else math.inf
        for c in range(a):
            value[a] -= factor[a, c] * value[c]
        value[a] /= factor[a, a]
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            value[a] -= factor[c, a] * value[c]
        value[a] /= factor[a, a]
        solution[index[a]] = value[a]
