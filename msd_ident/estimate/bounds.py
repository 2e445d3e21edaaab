"""Bounds of a problem's vector: those of physics, and what the records could tell at all."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.model import Model


def bounds(
    model: Model, free: tuple[int, ...], rest: int, typical: Magnitudes, records: tuple[Record, ...]
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper ones of the free parameters, then of ``rest`` entries that have none.

    Each parameter says beyond which sizes no record of the motion could tell (``Parameter.least``, ``most``,
    ``ceiling``). That keeps a search out of regions where the motion has to be followed in millions of steps.
    """
    duration = max(record.duration for record in records)
    period = min(record.period for record in records)
    # A slow ramp moves far more slowly than its plant could: what bounds a mass is then a swing within a sample.
    quickest = min((period / typical.time) ** 2, 1.0 / NATURAL_RANGE)
    lower, upper = [], []
    for parameter in (model.parameters[i] for i in free):
        size = typical.of(parameter.unit)
        reach = parameter.most * size if parameter.ceiling is None else parameter.ceiling(duration, period)
        least = quickest if parameter.inertia else parameter.least
        lower.append(max(parameter.lower, least * size, -reach))
        upper.append(min(parameter.upper, reach))
    return np.array(lower + [-np.inf] * rest), np.array(upper + [np.inf] * rest)
