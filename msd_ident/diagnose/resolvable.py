"""Where a law's inner parameters make sense on given data: within what its samples can resolve.

A pitch finer than the noise, a frequency above half the sampling rate or a stop out of reach can be anything; a search
that wanders there finds nothing and pays for it with very short solver steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.fit.problem import Problem
from msd_ident.model import Model
from msd_ident.record import Record

#: Pitches of cogging in parts of the travel: of a longer one the cart sees a bent spring.
PITCHES = (0.02, 1.5)


def ranges(records: Sequence[Record], plant: Model) -> dict[str, tuple[float, float]]:
    """Range of each inner parameter by name, in the records' units; ``plant`` is roughly the base model."""
    mass, stiffness = plant.mass, plant.stiffness
    reach = max(float(np.max(np.abs(record.position))) for record in records)
    span = max(float(np.ptp(record.position)) for record in records)
    duration = max(record.duration for record in records)
    period = min(record.period for record in records)
    speed = max(_top_speed(record) for record in records)
    fastest = 0.6 * np.pi / period
    rate = max(np.sqrt(stiffness / mass), 10.0 * np.pi / duration)  # of the plant's motion, or of a few swings
    force = max(float(np.max(np.abs(record.force))) for record in records) or mass * span * rate**2
    return {
        "second_mass": (0.02 * mass, 5.0 * mass),
        "second_stiffness": (1e-3 * mass * rate**2, 30.0 * mass * rate**2),
        "second_damping": (0.0, mass * rate),
        "disturbance_frequency": (np.pi / duration, fastest),
        "cogging_pitch": (PITCHES[0] * span, PITCHES[1] * span),
        "hysteresis_length": (1e-3 * span, 2.0 * span),
        "stribeck_velocity": (3e-3 * speed, 2.0 * speed),
        "stop_position": (0.02 * span, reach + 0.2 * span),
        "stop_stiffness": (0.0, 300.0 * max(stiffness, force / span)),
        "backlash_half_width": (0.0, 0.5 * span),
        "lag_time": (0.0, 0.25 * duration),
        "time_offset": (-0.05 * duration, 0.05 * duration),
        "gain_slope": (-0.9 / force, 10.0 / force),
        "force_limit": (0.1 * force, force),
        "stiffness_drift_rate": (-0.9 / duration, 5.0 / duration),
        "position_friction_slope": (-10.0 / span, 10.0 / span),
    }


def _top_speed(record: Record) -> float:
    stretch = max(record.samples // 300, 1)
    rise = np.abs(record.position[stretch:] - record.position[:-stretch])
    return float(np.max(rise / (record.time[stretch:] - record.time[:-stretch])))


def within(problem: Problem, limits: dict[str, tuple[float, float]]) -> Problem:
    """The problem with its bounds narrowed to these ranges."""
    lower, upper = problem.lower.copy(), problem.upper.copy()
    for place, index in enumerate(problem.free):
        low, high = limits.get(problem.model.names[index], (-np.inf, np.inf))
        lower[place], upper[place] = max(lower[place], low), min(upper[place], high)
    return replace(problem, lower=lower, upper=upper)
