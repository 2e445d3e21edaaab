"""The compiled parts of a Jacobian's life do what their formulas say."""

from __future__ import annotations

import numpy as np

from msd_ident.estimate.jacobian import broyden_update, safe_steps, with_rows

RANDOM = np.random.default_rng(5)
JACOBIAN = RANDOM.normal(size=(4, 60)) * np.array([[1.0], [1e3], [1e-4], [10.0]])
NORMAL = JACOBIAN @ JACOBIAN.T


def test_an_updated_jacobian_explains_the_step_and_nothing_across_it() -> None:
    size = np.sqrt(NORMAL.diagonal())
    move, change = RANDOM.normal(size=4) / size, RANDOM.normal(size=60)
    jacobian, normal = broyden_update(move, change, JACOBIAN, NORMAL)
    np.testing.assert_allclose(move @ jacobian, change, atol=1e-12)
    np.testing.assert_allclose(normal, jacobian @ jacobian.T, rtol=1e-10)
    across = np.linalg.svd((move * size)[None, :])[2][1:] / size
    np.testing.assert_allclose(across @ jacobian, across @ JACOBIAN, atol=1e-12)


def test_further_rows_stand_where_the_larger_vector_has_them() -> None:
    further = RANDOM.normal(size=(2, 60))
    jacobian, normal = with_rows(JACOBIAN, NORMAL, np.array([2, -1, 0, 1, -1]), further)
    np.testing.assert_array_equal(jacobian, [JACOBIAN[2], further[0], JACOBIAN[0], JACOBIAN[1], further[1]])
    np.testing.assert_allclose(normal, jacobian @ jacobian.T, rtol=1e-10, atol=1e-10)


def test_a_step_is_felt_beside_a_huge_number_and_stays_inside_the_bounds() -> None:
    point, upper = np.array([1.0, 1e12, 1.0]), np.array([np.inf, np.inf, 1.0 + 1e-9])
    steps = safe_steps(point, np.array([1e-6, 1e-6, 1e-6]), upper)
    assert steps[0] == 1e-6
    assert point[1] + steps[1] - point[1] > 0.1
    assert steps[2] == -1e-6
