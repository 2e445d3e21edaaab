"""Likelihood of a residual whose samples hang together: one-step errors of an autoregressive process.

The residual of a model that lacks something is large and slow. Its sum of squares hides what happens at high
frequencies; its one-step errors count every frequency alike (Box & Jenkins 1970).
"""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import FloatArray

#: Coefficients of the process.
ORDER = 20


def log_likelihood(residual: FloatArray) -> float:
    """Of a residual (n,) as a Gaussian autoregressive process, but for what is the same for every residual."""
    centred = residual - residual.mean()
    count = centred.size
    past = np.stack([centred[ORDER - lag : count - lag] for lag in range(1, ORDER + 1)], axis=1)
    now = centred[ORDER:]
    weights = np.linalg.lstsq(past, now, rcond=None)[0]
    error = now - past @ weights
    return -0.5 * int(now.size) * math.log(max(float(error @ error) / now.size, 1e-300))
