"""Fit of a model to records by simulation error, with 95 % intervals.

In: a model with starting values, and records. Out: a ``FitResult``: parameters with covariance, open directions, SEE.
Begin with ``fitting``, then ``problem`` (what is free) and ``least_squares``.
"""

from __future__ import annotations

from msd_ident.estimate.fitting import fit
from msd_ident.estimate.formulation import regression_start
from msd_ident.estimate.identifiability import OpenDirection
from msd_ident.estimate.noise_floors import noise_floor
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.result import FitResult
from msd_ident.estimate.see import see, see_reduction

__all__ = [
    "FitResult",
    "Initial",
    "OpenDirection",
    "fit",
    "noise_floor",
    "regression_start",
    "see",
    "see_reduction",
]
