"""Motion of a model while the cart stands still.

An encoder that gives one value for longer than half a swing shows that the cart stands still, however many readings
this is: dry friction or a stop holds it. A model without such a law swings on. For the sum of squares this is one piece
of evidence among the many of the motion before. But a model's error in motion says nothing about its motion at rest,
so what a model still moves there counts by itself.

A law that holds the cart accounts for a standstill as far as it holds: how far it yields before it slips is a matter of
its form at small motion, which the motion itself shows.
"""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.model import Model
from msd_ident.residuals.noise_model import Readings
from msd_ident.tuning import fixed

_HIDDEN = fixed(
    3.0,
    "mathematics",
    "largest variance of what moves within an encoder step q, in units of the rounding error's, q²/12",
)


def chi(residual: FloatArray, readings: Readings, model: Model) -> float:
    """Motion of a model within the standstills of a record, in units of the noise.

    Args:
        residual: (n,) model − data in units of the noise (``Readings.root``).
        readings: the record with its weights.
        model: its spring and what holds it say how far from its mean position there it may stand still.

    Returns:
        Sum over the standstills of the variance of the model's position beyond that reach, and beyond what an encoder
        step hides.
    """
    holding = sum(effect.holding for effect in model.effects)
    reach = holding / model.stiffness if model.stiffness > 0.0 else math.inf if holding > 0.0 else 0.0
    moved = 0.0
    for start, stop in readings.standstills:
        part = residual[start:stop]
        beyond = np.maximum(np.abs(part - part.mean()) - reach * float(readings.root[start]), 0.0)
        moved += max(float(beyond @ beyond) - _HIDDEN, 0.0)
    return moved
