"""What a search does with a Jacobian, compiled: steps of its finite differences, Broyden's update, further rows.

A search fits some hundred models, each in a few steps; in numpy, calls of a few microseconds each would take as long as
the simulations.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from msd_ident.compiled import Library
from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import RELATIVE_STEP
from msd_ident.tuning import fixed

LIBRARY = Library(__name__, f"{__name__}_loops")
_LINEAR = ("f8[:,:]", "f8[:,:]")  # a Jacobian and its Gauss-Newton matrix
_broyden_update = LIBRARY.function("broyden_update", "f8[:]", "f8[:]", _LINEAR, _LINEAR)
_with_rows = LIBRARY.function("with_rows", _LINEAR, "i8[:]", "f8[:,:]", _LINEAR)

_FELT = fixed(1024.0, "accuracy", "least finite-difference step, in units in the last place of what it moves")


def relative_step(slack: float) -> float:
    """Effect of a finite-difference step, as a part of the motion: above the errors that simulations with this slack
    may have.
    """
    return RELATIVE_STEP * math.sqrt(slack)


def safe_steps(point: FloatArray, steps: FloatArray, upper: FloatArray) -> FloatArray:
    """Steps (p,) that rounding does not swallow, negative where they would leave the upper bound.

    Args:
        point: (p,) where the finite differences are taken.
        steps: (p,) positive steps.
        upper: (p,) bound of the point.
    """
    safe = np.maximum(steps, _FELT * np.spacing(np.abs(point)))  # beside a huge phase a small step is none
    return np.where(point + safe > upper, -safe, safe)


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
    updated, matrix = np.empty_like(jacobian), np.empty_like(normal)
    _broyden_update(move, change, (jacobian, normal), (updated, matrix))
    return updated, matrix


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
    _with_rows((jacobian, normal), places, further, (larger, matrix))
    return larger, matrix
