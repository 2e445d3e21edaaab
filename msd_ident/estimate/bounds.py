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
    """Bounds of the solver's vector: those of the free parameters, then infinite ones for ``rest`` further entries.

    Each parameter declares the sizes beyond which no record of a motion could tell its value (``Parameter.least``,
    ``most``, ``ceiling``). These bounds keep the search out of regions that the simulation follows only in millions of
    steps.

    Args:
        model: gives the parameters and the bounds that physics sets.
        free: indices of the free parameters in ``model.names``.
        rest: number of entries after the free parameters (initial states and zeros).
        typical: typical force, length and time of the records.
        records: the longest duration and the shortest sample period among them enter.

    Returns:
        Lower and upper bounds, each (len(free) + rest,).
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
