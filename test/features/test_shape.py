"""The whole step response at once."""

from __future__ import annotations

import warnings

import numpy as np

from msd_ident.features.shape import fit_shape
from msd_ident.quantity import Quantity


def test_a_search_that_runs_away_is_told_without_an_overflow():
    """Readings that only hang between two counts: seed 1 drives the frequency beyond every float."""
    count = 2.6e-5
    time = np.arange(1, 1001) * 1e-3
    position = np.round(np.random.default_rng(1).normal(0.5, 0.8, time.size)) * count
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fit_shape(time, position, Quantity(1.4e-5, 2e-6, "m"), 0.0, 1.8e-5) is None
