"""The whole step response at once."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from msd_ident.features.shape import ResponseProblem, fit_shape, unit_step_response
from msd_ident.quantity import Quantity


def test_a_search_that_runs_away_is_told_without_an_overflow():
    """Readings that only hang between two counts: seed 1 drives the frequency beyond every float."""
    count = 2.6e-5
    time = np.arange(1, 1001) * 1e-3
    position = np.round(np.random.default_rng(1).normal(0.5, 0.8, time.size)) * count
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fit_shape(time, position, Quantity(1.4e-5, 2e-6, "m"), 0.0, 1.8e-5) is None


@pytest.mark.parametrize("ratio", [0.2, 0.999, 1.0, 1.001, 3.0])
def test_the_slopes_of_the_response_are_those_of_its_differences(ratio):
    """Columns: logarithms of ωn and ζ, start, rest value, delay in units of its uncertainty."""
    time = np.linspace(0.0, 1.0, 400)
    position = 3e-3 * unit_step_response(time, 12.0, 0.4)
    problem = ResponseProblem(time, position, np.linspace(0.5, 1.0, 400), Quantity(1e-4, 2e-6, "m"), 1e-3, 1e-6)
    point = np.array([np.log(12.0), np.log(ratio), 0.1, 0.9, -0.5])
    steps = 1e-4 * np.eye(5)
    measured = [(problem.residual(point + step) - problem.residual(point - step)) / 2e-4 for step in steps]
    np.testing.assert_allclose(problem.slopes(point), np.transpose(measured), atol=1e-6)
