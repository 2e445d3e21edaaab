"""The part of a motion that a simulation explains, as a figure and in words."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from msd_ident.data.record import FloatArray, Record


def explained_percent(residuals: Iterable[FloatArray], records: Iterable[Record]) -> float:
    """Part of the motion's variance that a simulation explains [%], constant errors left aside.

    Args:
        residuals: simulation − data, one (n,) for each record.
        records: the records.
    """
    left = sum(float(np.sum((residual - residual.mean()) ** 2)) for residual in residuals)
    moved = sum(float(np.sum((record.position - record.position.mean()) ** 2)) for record in records)
    return 100.0 * (1.0 - left / moved)


def percent_text(percent: float) -> str:
    """An explained part with two digits of what is left to 100 %."""
    left = abs(100.0 - percent)
    if not math.isfinite(left):
        return "no"
    digits = min(max(1 - math.floor(math.log10(left)), 0), 9) if left > 0.0 else 0
    return f"{percent:.{digits}f}"
