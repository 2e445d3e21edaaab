"""Likelihood of a residual with correlated samples: one-step prediction errors of an autoregressive process.

The residual of an incomplete model is large and slow. Its sum of squares hides what happens at high frequencies; its
one-step prediction errors weigh all frequencies alike (Box & Jenkins 1970).
"""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import FloatArray

#: Coefficients of the process.
ORDER = 20


def log_likelihood(residual: FloatArray) -> float:
    """Log likelihood of a residual (n,) as a Gaussian autoregressive process, except for a constant."""
    centred = residual - residual.mean()
    count = centred.size
    past = np.stack([centred[ORDER - lag : count - lag] for lag in range(1, ORDER + 1)], axis=1)
    now = centred[ORDER:]
    weights = np.linalg.lstsq(past, now, rcond=None)[0]
    error = now - past @ weights
    return -0.5 * int(now.size) * math.log(max(float(error @ error) / now.size, 1e-300))
