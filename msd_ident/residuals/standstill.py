"""Motion of a model while the cart stands still.

An encoder that gives one value for longer than half a swing shows that the cart stands still, however many readings the
standstill holds: dry friction or a stop holds it. A model without it swings on. For the sum of squares this is one piece
of evidence among the many of the motion before. But a model's error in motion says nothing about its motion at rest, so
what a model still moves there counts by itself.
"""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.residuals.noise_model import Readings


def chi(residual: FloatArray, readings: Readings) -> float:
    """Motion of a model within the standstills of a record, in units of the noise.

    Args:
        residual: (n,) model − data in units of the noise (``Readings.root``).
        readings: the record with its weights.

    Returns:
        Sum over the standstills of the variance of the model's position, beyond that of the rounding error, which hides
        as much.
    """
    moved = 0.0
    for start, stop in readings.standstills:
        part = residual[start:stop]
        moved += max(float(np.sum((part - part.mean()) ** 2)) - 1.0, 0.0)
    return moved
