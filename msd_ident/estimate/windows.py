"""Windows around each sample of a record."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray


def breadths(size: int, reach: int) -> FloatArray:
    """(size,) steps from the first to the last sample within ``reach`` of each: fewer at either end."""
    steps = np.full(size, 2.0 * reach)
    missing = np.arange(reach, 0, -1)[:size]
    steps[: missing.size] -= missing
    steps[size - missing.size :] -= missing[::-1]
    return steps
