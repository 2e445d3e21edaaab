"""Intervals of an identified model that lacks something.

The covariance of a fit is that of its residual as noise. The error of a law is no noise: it repeats with the motion,
and a record shows a few features of it, however many samples it has. So the variance v along ν = ``SHAPES`` features is

    v = σ² + (Σ e² − N σ²) / ν,

with the residual e, the noise σ and the number of samples N. Where only the readings tell, the covariance is at least
v·(JᵀJ)⁻¹, the rule of ``diagnosis.intervals``, so that both commands state one interval for one model. What rest at the
start tells is no worse known for an error of a law in motion: with its weights W, A = JᵀJ + W and its part R of the
meat, the covariance is at least A⁻¹ (v·JᵀJ + R) A⁻¹.
"""

from __future__ import annotations

import numpy as np

from msd_ident.estimate import FitResult
from msd_ident.estimate.levels import SHAPES
from msd_ident.residuals.noise_model import NOISE_ERROR


def widened(result: FitResult) -> FitResult:
    """A fit with intervals that hold the error of its laws; the same where it leaves no more than noise.

    Open and fixed parameters keep their standard deviation.
    """
    squares = sum(float(residual @ residual) for residual in result.residuals)
    noise = result.noise_floor**2
    beyond = squares - (1.0 + NOISE_ERROR) * result.samples * noise
    if not beyond > 0.0:
        return result
    law = np.diag(result.plain) * (noise + beyond / SHAPES) + np.diag(result.rest)
    return result.with_std(np.sqrt(np.maximum(np.diag(result.covariance), law)))
