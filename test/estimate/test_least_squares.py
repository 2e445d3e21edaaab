"""The solver: held to scipy's answers, inside bounds, and honest about failure."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import FloatArray
from msd_ident.estimate.least_squares import Normal, SolverOptions, minimise

Function = Callable[[FloatArray], FloatArray]


class Squares:
    """A residual function as the solver's objective, Jacobian by central differences."""

    def __init__(self, function: Function) -> None:
        self.function = function

    def cost(self, point: FloatArray) -> float:
        residual = self.function(point)
        return 0.5 * float(residual @ residual)

    def linearise(self, point: FloatArray) -> Normal:
        residual = self.function(point)
        step = 1e-6 * np.maximum(np.abs(point), 1.0)
        columns = [(self.function(point + d) - self.function(point - d)) / (2.0 * d.max()) for d in np.diag(step)]
        jacobian = np.array(columns)
        return Normal(0.5 * float(residual @ residual), jacobian @ residual, jacobian @ jacobian.T)


def _limits(size: int, lower: float = -np.inf, upper: float = np.inf, iterations: int = 200) -> SolverOptions:
    return SolverOptions(np.full(size, lower), np.full(size, upper), np.ones(size), iterations)


def _rosenbrock(point: FloatArray) -> FloatArray:
    return np.array([10.0 * (point[1] - point[0] ** 2), 1.0 - point[0]])


def _decay(point: FloatArray) -> FloatArray:
    time = np.linspace(0.0, 4.0, 80)
    return point[0] * np.exp(-point[1] * time) + point[2] - (2.0 * np.exp(-1.3 * time) - 0.5)


def test_rosenbrock() -> None:
    outcome = minimise(Squares(_rosenbrock), np.array([-1.2, 1.0]), _limits(2))
    assert outcome.converged
    np.testing.assert_allclose(outcome.point, [1.0, 1.0], atol=1e-6)


@settings(max_examples=30)
@given(st.tuples(st.floats(0.5, 5.0), st.floats(0.2, 4.0), st.floats(-1.0, 1.0)))
def test_agrees_with_scipy_inside_bounds(start: tuple[float, float, float]) -> None:
    bounds = ([0.0, 0.0, -0.3], [10.0, 10.0, 10.0])
    ours = minimise(
        Squares(_decay), np.array(start), SolverOptions(np.array(bounds[0]), np.array(bounds[1]), np.ones(3), 200)
    )
    begin = np.clip(start, np.array(bounds[0]) + 1e-3, bounds[1])
    theirs = scipy.optimize.least_squares(_decay, begin, bounds=bounds, xtol=1e-12, ftol=1e-12, gtol=1e-12)
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-5, abs=1e-12)
    np.testing.assert_allclose(ours.point, theirs.x, rtol=1e-3, atol=1e-4)
    assert ours.point[2] >= -0.3


def test_a_start_outside_the_bounds_is_brought_in() -> None:
    outcome = minimise(Squares(_decay), np.array([3.0, 2.0, 5.0]), _limits(3, lower=0.1, upper=1.5))
    assert np.all(outcome.point >= 0.1) and np.all(outcome.point <= 1.5)


def test_a_null_direction_does_not_drift() -> None:
    def sum_only(point: FloatArray) -> FloatArray:
        return np.full(10, point[0] + point[1] - 3.0)

    outcome = minimise(Squares(sum_only), np.array([5.0, 2.0]), _limits(2))
    assert outcome.converged
    np.testing.assert_allclose(outcome.point, [3.0, 0.0], atol=1e-6)


def test_too_few_iterations_are_told() -> None:
    outcome = minimise(Squares(_rosenbrock), np.array([-1.2, 1.0]), _limits(2, iterations=2))
    assert not outcome.converged
    assert outcome.message == "Not converged: the error still fell after 2 iterations; give a better start."


def test_a_bound_is_never_left_by_rounding() -> None:
    """(lower - x) + x is not lower: a law refused such a value, and with it the whole diagnosis."""
    lower = 1e-9
    for start in np.random.default_rng(1).uniform(0.01, 3.0, 200):
        found = minimise(Squares(lambda x: np.array([x[0] + 1.0, 0.1])), np.array([start]), _limits(1, lower, 9.0))
        assert found.point[0] >= lower
