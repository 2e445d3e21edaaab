"""Loops of ``jacobian``, for numba to compile: what they find, they fill in."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit


@njit(error_model="numpy", fastmath={"reassoc", "contract"})
def _product(one, other):
    """Inner product; numpy's would bring a library of linear algebra into the compiled code, which loads longer."""
    total = 0.0
    for j in range(one.size):
        total += one[j] * other[j]
    return total


@njit(error_model="numpy")
def broyden_update(move, change, before, after):
    """Fill the Jacobian and the Gauss-Newton matrix ``after`` a step from those ``before`` it."""
    jacobian, normal = before
    updated, matrix = after
    along, length = np.empty(move.size), 0.0
    for i in range(move.size):
        size = max(normal[i, i], 1e-300)  # an entry may move nothing
        along[i] = size * move[i]
        length += along[i] * move[i]
    surprise = change.copy()
    for i in range(move.size):
        along[i] /= length
        for j in range(change.size):
            surprise[j] -= move[i] * jacobian[i, j]
    further, across = _product(surprise, surprise), np.empty(move.size)
    for i in range(move.size):
        across[i] = _product(jacobian[i], surprise)
        for j in range(change.size):
            updated[i, j] = jacobian[i, j] + along[i] * surprise[j]
    for i in range(move.size):
        for k in range(move.size):
            matrix[i, k] = normal[i, k] + along[i] * across[k] + across[i] * along[k] + further * along[i] * along[k]


@njit(error_model="numpy")
def with_rows(known, places, further, whole):
    """Fill the ``whole`` Jacobian and Gauss-Newton matrix from the ``known`` ones and ``further`` rows."""
    jacobian, normal = known
    larger, matrix = whole
    fresh = 0
    for i in range(places.size):
        if places[i] < 0:
            for j in range(larger.shape[1]):
                larger[i, j] = further[fresh, j]
            fresh += 1
        else:
            for j in range(larger.shape[1]):
                larger[i, j] = jacobian[places[i], j]
            for k in range(i):
                if places[k] >= 0:
                    matrix[i, k] = matrix[k, i] = normal[places[i], places[k]]
            matrix[i, i] = normal[places[i], places[i]]
    for i in range(places.size):
        if places[i] < 0:
            for k in range(places.size):
                matrix[i, k] = matrix[k, i] = _product(larger[i], larger[k])
