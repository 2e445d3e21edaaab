"""Sizes of a motion that starting values are made from."""

from __future__ import annotations

import numpy as np

from msd_ident.model.model import Model
from msd_ident.record import Record


def amplitude(record: Record) -> float:
    """Half the range of the positions [m]; never zero."""
    return max(0.5 * float(np.ptp(record.position)), 1e-9)


def speed(record: Record) -> float:
    """A robust largest speed [m/s]: the steepest tenth of a 2 % stretch of the record, at least one sample."""
    stretch = max(record.samples // 50, 1)
    rise = np.abs(record.position[stretch:] - record.position[:-stretch])
    run = record.time[stretch:] - record.time[:-stretch]
    return max(float(np.quantile(rise / run, 0.95)), 1e-9)


def force(record: Record, plant: Model) -> float:
    """The largest force at work [N]: commanded, or the spring's in a free motion; never zero."""
    commanded = float(np.max(np.abs(record.force)))
    spring = plant["stiffness"] * amplitude(record)
    return max(commanded, spring, 1e-9)


def natural_frequency(record: Record, plant: Model) -> float:
    """Natural frequency [rad/s] of the plant, or of one swing a record where there is no spring."""
    spring = plant["stiffness"] / plant["mass"]
    return max(float(np.sqrt(max(spring, 0.0))), 2.0 * np.pi / record.duration)
