"""Highest peaks of a signal that a scan has made."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.effort import KEPT


def highest(gain: FloatArray) -> list[int]:
    """Places of the highest local maxima of a signal (n,), its ends included, the highest first; at most ``KEPT``."""
    padded = np.concatenate(([-np.inf], gain, [-np.inf]))
    peaks = np.flatnonzero((gain >= padded[:-2]) & (gain >= padded[2:]))
    return [int(i) for i in peaks[np.argsort(gain[peaks])[::-1]][:KEPT]]
