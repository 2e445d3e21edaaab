"""Bounds of a problem's vector: those of physics, and what the records could tell at all."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.model import Model

#: Sizes beyond which no record of the motion could tell, in natural sizes of the parameter's unit. They keep a search
#: out of regions where the motion has to be followed in millions of steps.
_LEAST = {
    "mass": 1e-3,
    "second_mass": 1e-3,
    "hysteresis_length": 1e-3,
    "cogging_pitch": 2e-2,
    "stribeck_velocity": 1e-3,
}
_MOST = {
    "damping": 1e3,
    "second_stiffness": 1e3,
    "second_damping": 1e3,
    "drag_coefficient": 1e3,
    "cubic_stiffness": 1e3,
    "quadratic_stiffness": 1e3,
}


def bounds(
    model: Model, free: tuple[int, ...], rest: int, typical: Magnitudes, records: tuple[Record, ...]
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper ones of the free parameters, then of ``rest`` entries that have none."""
    duration = max(record.duration for record in records)
    period = min(record.period for record in records)
    most = {"disturbance_frequency": np.pi / period, "lag_time": duration, "time_offset": 0.25 * duration}
    # A slow ramp moves far more slowly than its plant could: what bounds a mass is a swing within a sample.
    quickest = min((period / typical.time) ** 2, _LEAST["mass"])
    least = {**_LEAST, "mass": quickest, "second_mass": quickest}
    lower, upper = [], []
    for parameter in (model.parameters[i] for i in free):
        size = typical.of(parameter.unit)
        reach = most.get(parameter.name, _MOST.get(parameter.name, np.inf) * size)
        lower.append(max(parameter.lower, least.get(parameter.name, -np.inf) * size, -reach))
        upper.append(min(parameter.upper, reach))
    return np.array(lower + [-np.inf] * rest), np.array(upper + [np.inf] * rest)
