"""Fitting a model to records by simulation error, with intervals one can believe."""

from __future__ import annotations

from msd_ident.fit.fitting import fit
from msd_ident.fit.noise import noise_floor
from msd_ident.fit.openness import OpenDirection
from msd_ident.fit.posing import regression_start
from msd_ident.fit.problem import Initial
from msd_ident.fit.refine import PaperRefinement, paper_refine
from msd_ident.fit.result import FitResult
from msd_ident.fit.see import see, see_reduction

__all__ = [
    "FitResult",
    "Initial",
    "OpenDirection",
    "PaperRefinement",
    "fit",
    "noise_floor",
    "paper_refine",
    "regression_start",
    "see",
    "see_reduction",
]
