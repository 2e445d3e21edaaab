"""The step of Levenberg and Marquardt inside bounds, which all fits take.

References: Marquardt 1963 (scaling by the diagonal); Kanzow et al. 2004 (projection onto bounds).
"""

from __future__ import annotations

import numpy as np

from msd_ident.compiled import Library
from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import NULL

LIBRARY = Library(__name__, f"{__name__}_loops")
_ROW = "f8[:]"
_damped_step = LIBRARY.function("damped_step", "f8[:,:]", _ROW, ("f8", "f8"), (_ROW, _ROW), (_ROW, _ROW))


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
    move, decrease = np.zeros(gradient.size), np.empty(1)
    _damped_step(matrix, gradient, (damping, NULL), (lowest, highest), (move, decrease))
    return move, float(decrease[0])
