"""What a search does with a Jacobian, compiled: steps of its finite differences, Broyden's update, further rows.

A search fits some hundred models, each in a few steps; in numpy, calls of a few microseconds each would take as long as
the simulations.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from msd_ident.data.record import FloatArray
from msd_ident.tuning import fixed

_FELT = fixed(1024.0, "accuracy", "least finite-difference step, in units in the last place of what it moves")


@njit(nogil=True, cache=True, error_model="numpy")
def safe_steps(point: FloatArray, steps: FloatArray, upper: FloatArray) -> FloatArray:
    """Steps (p,) that rounding does not swallow, negative where they would leave the upper bound.

    Args:
        point: (p,) where the finite differences are taken.
        steps: (p,) positive steps.
        upper: (p,) bound of the point.
    """
    safe = np.empty(point.size)
    for i in range(point.size):
        size = abs(point[i])  # beside a huge phase a small step is none
        safe[i] = max(steps[i], _FELT * (np.nextafter(size, math.inf) - size))
        if point[i] + safe[i] > upper[i]:
            safe[i] = -safe[i]
    return safe


@njit(nogil=True, cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _product(one: FloatArray, other: FloatArray) -> float:
    """Inner product; numpy's would bring a library of linear algebra into the compiled code, which loads longer."""
    total = 0.0
    for j in range(one.size):
        total += one[j] * other[j]
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def broyden_update(
    move: FloatArray, change: FloatArray, jacobian: FloatArray, normal: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Broyden's update (1965): the least change of the Jacobian J that explains what a step did.

    Entries of the vector count in units in which each matters alike. With the change a·cᵀ of J, the Gauss–Newton matrix
    becomes JJᵀ + a·(Jc)ᵀ + (Jc)·aᵀ + (cᵀc)·a·aᵀ.

    Args:
        move: (p,) the step, not zero.
        change: (n,) what the step changed of the residual.
        jacobian: (p, n) derivatives of the residual before the step.
        normal: (p, p) Gauss–Newton matrix before the step.

    Returns:
        Jacobian (p, n) and Gauss–Newton matrix (p, p) after it.
    """
    along, length = np.empty(move.size), 0.0
    for i in range(move.size):
        size = max(normal[i, i], 1e-300)  # an entry may move nothing
        along[i] = size * move[i]
        length += along[i] * move[i]
    along /= length
    surprise = change.copy()
    for i in range(move.size):
        for j in range(change.size):
            surprise[j] -= move[i] * jacobian[i, j]
    further, across = _product(surprise, surprise), np.empty(move.size)
    updated, matrix = np.empty_like(jacobian), np.empty_like(normal)
    for i in range(move.size):
        across[i] = _product(jacobian[i], surprise)
        for j in range(change.size):
            updated[i, j] = jacobian[i, j] + along[i] * surprise[j]
    for i in range(move.size):
        for k in range(move.size):
            matrix[i, k] = normal[i, k] + along[i] * across[k] + across[i] * along[k] + further * along[i] * along[k]
    return updated, matrix


@njit(nogil=True, cache=True, error_model="numpy")
def with_rows(
    jacobian: FloatArray, normal: FloatArray, places: npt.NDArray[np.intp], further: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Jacobian and Gauss–Newton matrix of a larger vector.

    Args:
        jacobian: (k, n) rows that are known.
        normal: (k, k) Gauss–Newton matrix of them.
        places: (p,) for each row of the larger Jacobian the known one that it is, or −1 for the next of ``further``.
        further: (q, n) rows that are not known.

    Returns:
        Jacobian (p, n) and Gauss–Newton matrix (p, p).
    """
    larger, matrix = np.empty((places.size, jacobian.shape[1])), np.empty((places.size, places.size))
    fresh = 0
    for i in range(places.size):
        if places[i] < 0:
            larger[i] = further[fresh]
            fresh += 1
        else:
            larger[i] = jacobian[places[i]]
            for k in range(i):
                if places[k] >= 0:
                    matrix[i, k] = matrix[k, i] = normal[places[i], places[k]]
            matrix[i, i] = normal[places[i], places[i]]
    for i in range(places.size):
        if places[i] < 0:
            for k in range(places.size):
                matrix[i, k] = matrix[k, i] = _product(larger[i], larger[k])
    return larger, matrix
