"""The damped step inside bounds: held to numpy's solution and to the conditions of optimality."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import FloatArray
from msd_ident.estimate.damped_step import damped_step

FREE = np.full(5, np.inf)


def _problem(seed: int) -> tuple[FloatArray, FloatArray]:
    """Gauss–Newton matrix and half gradient of a random problem whose entries have sizes of many magnitudes."""
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(5, 40)) * 10.0 ** rng.uniform(-6.0, 6.0, (5, 1))
    return jacobian @ jacobian.T, jacobian @ rng.normal(size=40)


@given(st.integers(0, 10_000), st.floats(1e-6, 10.0))
def test_inside_the_bounds_it_is_the_solution_of_the_damped_equations(seed: int, damping: float) -> None:
    matrix, gradient = _problem(seed)
    move, promised = damped_step(matrix, gradient, damping, -FREE, FREE)
    damped = matrix + damping * np.diag(matrix.diagonal())
    np.testing.assert_allclose(damped @ move, -gradient, rtol=1e-6, atol=1e-9 * float(np.max(np.abs(gradient))))
    assert promised == pytest.approx(-2.0 * gradient @ move - move @ matrix @ move)
    assert promised > 0.0


@given(st.integers(0, 10_000))
def test_at_the_bounds_the_free_entries_are_solved_again(seed: int) -> None:
    matrix, gradient = _problem(seed)
    whole, _ = damped_step(matrix, gradient, 1e-3, -FREE, FREE)
    lowest, highest = -0.3 * np.abs(whole), 0.7 * np.abs(whole)
    move, _ = damped_step(matrix, gradient, 1e-3, lowest, highest)
    assert np.all((lowest <= move) & (move <= highest))
    inside = (lowest < move) & (move < highest)
    damped = matrix + 1e-3 * np.diag(matrix.diagonal() * inside)  # a held entry is not damped
    left = (damped @ move + gradient) / np.sqrt(matrix.diagonal())
    size = float(np.max(np.abs(gradient / np.sqrt(matrix.diagonal()))))
    assert np.all(np.abs(left[inside]) <= 1e-6 * size)


def test_an_entry_without_influence_and_a_direction_that_is_not_told_stay() -> None:
    jacobian = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0], [2.0, 4.0, 6.0]])
    move, promised = damped_step(jacobian @ jacobian.T, jacobian @ np.ones(3), 0.0, -FREE[:3], FREE[:3])
    assert move[1] == 0.0 and move[2] == 0.0
    assert move[0] == pytest.approx(-6.0 / 14.0) and promised == pytest.approx(36.0 / 14.0)
