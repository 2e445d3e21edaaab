"""Compiling beforehand what the first identification and the first diagnosis would compile."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from msd_ident.data import compiled
from msd_ident.data.record import from_samples
from msd_ident.estimate import jacobian
from msd_ident.model import Plant, simulate
from msd_ident.residuals import noise_model, nonparametric
from msd_ident.workflow import pipeline


def warm_up() -> None:
    """Load all compiled functions, or compile them: a short record goes through what every diagnosis uses.

    What only some records need is called by itself: it would take a search among all causes.
    """
    time = np.arange(0.0, 2.0, 5e-3)
    force = np.select([time < 0.1, time < 0.7, time < 1.3], [0.0, 10.0, -6.0], 0.0)
    pushed = from_samples(time, force, 0.0 * time)
    moved = simulate(Plant(1.0, 3.0, 600.0), pushed).position
    record = replace(pushed, position=np.round(moved / 1e-5) * 1e-5)
    found = pipeline.diagnose([record])
    nonparametric.measure(noise_model.prepare([record]), found.extended.model, found.extended.initial, found.base.see)
    compiled.all_pole(np.ones(2), time)
    compiled.pole_zero(np.ones(2), np.ones(2), time)
    jacobian.with_rows(np.eye(2), np.eye(2), np.arange(2), np.eye(2))
