"""Windows around each sample of a record."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray


def breadths(size: int, reach: int) -> FloatArray:
    """Number of sample steps in a window around each sample.

    Args:
        size: samples of the record.
        reach: half width of the window [samples].

    Returns:
        (size,): 2 · reach inside the record, fewer at either end, where the window is cut off.
    """
    steps = np.full(size, 2.0 * reach)
    missing = np.arange(reach, 0, -1)[:size]
    steps[: missing.size] -= missing
    steps[size - missing.size :] -= missing[::-1]
    return steps
