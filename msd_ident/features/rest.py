"""Rest values: the reading at rest and its uncertainty."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.quantity import Quantity

#: Fewest samples that can show that the cart rests.
FEWEST = 3
#: A cart rests while the scatter is no more than this many noise floors.
_QUIET = 1.3


def evidence(position: FloatArray) -> int:
    """Number of runs of equal readings in ``position`` (n,): a reading that the encoder repeats counts once."""
    return 1 + int(np.count_nonzero(np.diff(position)))


def is_quiet(position: FloatArray, floor: float, step: float) -> bool:
    """Whether readings show noise alone: no scatter beyond noise floor and one encoder step, and no drift.

    Args:
        position: (n,) readings [m].
        floor: noise floor [m].
        step: encoder step [m], 0 if unknown.
    """
    if position.size < FEWEST:
        return False
    scatter = float(np.std(position))
    # Few readings scatter more, and less, than the noise behind them.
    limit = (_QUIET + 3.0 / math.sqrt(2.0 * position.size)) * floor
    if scatter > limit and float(np.ptp(position)) > 1.01 * step:
        return False
    half = position.size // 2
    drift = abs(float(np.mean(position[:half])) - float(np.mean(position[-half:])))
    readings = max(evidence(position) // 2, 1)
    return drift <= max(4.0 * max(scatter, 1e-300) * math.sqrt(2.0 / readings), 0.51 * step)


def rest_value(position: FloatArray, floor: float, unit: str) -> Quantity:
    """Mean of quiet readings; its standard deviation counts a run of equal readings as one.

    Args:
        position: (n,) readings.
        floor: noise floor, the least standard deviation of a reading.
        unit: of both.
    """
    spread = max(float(np.std(position)), floor)
    return Quantity(float(np.mean(position)), spread / math.sqrt(evidence(position)), unit)


def run_lengths(position: FloatArray) -> FloatArray:
    """For each reading (n,) the number of equal readings in its run."""
    starts = np.flatnonzero(np.concatenate(([True], np.diff(position) != 0.0)))
    lengths = np.diff(np.append(starts, position.size))
    return np.repeat(lengths, lengths).astype(np.float64)
