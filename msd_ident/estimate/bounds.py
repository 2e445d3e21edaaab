"""Bounds of a problem's vector: those of physics, and what the records could tell at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.model import Model
from msd_ident.tuning import fixed

if TYPE_CHECKING:
    from msd_ident.estimate.problem import Nuisance

_FAR = fixed(
    1e6,
    "accuracy",
    "spans of a record beyond which no relaxed spring is looked for: its force is constant in all digits that the "
    "record shows, and positions that are counted from there lose digits",
)


def bounds(
    model: Model,
    free: tuple[int, ...],
    nuisances: Sequence[Nuisance],
    typical: Magnitudes,
    records: tuple[Record, ...],
) -> tuple[FloatArray, FloatArray]:
    """Bounds of the solver's vector: those of the free parameters, then those of the entries of single records.

    Each parameter declares the sizes beyond which no record of a motion could tell its value (``Parameter.least``,
    ``most``, ``ceiling``). These bounds keep the search out of regions that the simulation follows only in millions of
    steps.

    Args:
        model: gives the parameters and the bounds that physics sets.
        free: indices of the free parameters in ``model.names``.
        nuisances: the entries after the free parameters. Zeros, and positions from them, lie within ``_FAR`` spans of
            the readings. Velocities have no bounds.
        typical: typical force, length and time of the records.
        records: the longest duration and the shortest sample period among them enter.

    Returns:
        Lower and upper bounds, each (len(free) + len(nuisances),).
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
    for nuisance in nuisances:
        least, most = _entry_bounds(nuisance, records[nuisance.record].position, typical.length)
        lower.append(least)
        upper.append(most)
    return np.array(lower), np.array(upper)


def _entry_bounds(nuisance: Nuisance, readings: FloatArray, length: float) -> tuple[float, float]:
    """Bounds of an entry of a record with these readings [m], of a typical ``length`` where they do not change."""
    if nuisance.kind == "initial velocity":
        return -np.inf, np.inf
    far = _FAR * (float(np.ptp(readings)) or length)
    if nuisance.kind == "zero":
        return float(readings.min()) - far, float(readings.max()) + far
    far += float(np.ptp(readings) + np.abs(readings).max())  # counted from a zero that is free, or from 0
    return -far, far
