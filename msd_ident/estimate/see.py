"""Standard error of estimate (eq. 14) and its reduction (eq. 15)."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.errors import UsageError


def see(residual: FloatArray | Iterable[FloatArray]) -> float:
    """SEE = √(Σ(model − data)²/(n − 2)), eq. 14, in the residual's unit.

    Args:
        residual: one residual (n,), or several, which are pooled as if they were one record.

    Raises:
        UsageError: fewer than 3 samples.
    """
    parts = [residual] if isinstance(residual, np.ndarray) else list(residual)
    samples = sum(part.size for part in parts)
    if samples <= 2:
        raise UsageError(f"SEE of {samples} residuals; expected at least 3: give the whole record's residual")
    return math.sqrt(sum(float(part @ part) for part in parts) / (samples - 2))


def see_reduction(original: float, refined: float) -> float:
    """Reduction of the SEE [%] by a refinement, 100·(original − refined)/original, eq. 15; negative if the SEE grew.

    Raises:
        UsageError: the original SEE is not positive.
    """
    if not original > 0.0:
        raise UsageError(f"original SEE is {original}; expected a positive number to reduce")
    return 100.0 * (original - refined) / original
