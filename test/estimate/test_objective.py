"""The sum of squares: its gradient is that of its cost, and rests weigh as much as one short stretch."""

from __future__ import annotations

import numpy as np
import pytest
from fitrigs import DEMO, measured
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import objective
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.objective import SquaredError, gram, motion_weights
from msd_ident.estimate.problem import Initial, Problem


def waiting() -> Record:
    encoder = {"counts_per_metre": 0.0, "noise": 2e-5}
    return measured(DEMO, {"name": "paper", "start": 0.2, "hold": 0.5}, rate=400.0, encoder=encoder, seed=5)


def posed() -> tuple[Problem, FloatArray]:
    """A problem with a balance at rest, and a vector beside its best."""
    problem = formulate(DEMO, (waiting(),))
    assert problem.balances
    values = dict(zip(DEMO.names, DEMO.values * (1.02, 0.9, 1.01, 1.2), strict=True))
    return problem, problem.vector(values, [Initial(1e-4, 0.0, 2e-4)])


@pytest.mark.parametrize("soft", [0.0, 1e-4])
@pytest.mark.parametrize("weighted", [False, True])
def test_the_gradient_is_that_of_the_cost(soft: float, weighted: bool) -> None:
    problem, point = posed()
    weights = (np.random.default_rng(1).uniform(0.1, 1.0, waiting().samples),) if weighted else ()
    error = SquaredError(problem, weights, soft)
    normal = error.linearise(point)
    assert normal.cost == pytest.approx(error.cost(point), rel=1e-12)
    steps = 1e-4 * np.maximum(np.abs(point), 1e-2 * problem.scale)
    for entry, step in enumerate(steps):
        aside = np.zeros(point.size)
        aside[entry] = step
        slope = (error.cost(point + aside) - error.cost(point - aside)) / (2.0 * step)
        assert normal.gradient[entry] == pytest.approx(slope, rel=2e-3, abs=1e-4 * normal.cost / step)


def test_far_beyond_the_residual_the_soft_loss_is_plain() -> None:
    problem, point = posed()
    plain, wide, narrow = (SquaredError(problem, soft=soft).cost(point) for soft in (0.0, 1.0, 1e-6))
    assert wide == pytest.approx(plain, rel=1e-5)
    assert narrow < 0.1 * plain


@given(st.integers(1, 5), st.integers(1, 40), st.booleans(), st.integers(0, 2**31))
def test_a_gram_matrix_is_the_same_in_any_blocks(rows: int, samples: int, weighted: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(rows, samples))
    weight = rng.uniform(0.0, 2.0, samples) if weighted else None
    whole = (jacobian * (1.0 if weight is None else weight)) @ jacobian.T
    with pytest.MonkeyPatch.context() as patch:
        for block in (1, 7, samples):
            patch.setattr(objective, "_BLOCK", block)
            np.testing.assert_allclose(gram(jacobian, weight), whole, atol=1e-12)


@pytest.mark.parametrize("still", [200, 1000])
def test_a_rest_weighs_as_much_as_one_block_however_long(still: int) -> None:
    block, noise = 20, 1e-5
    moving = 0.01 * np.sin(np.arange(600) / 30.0)
    position = np.concatenate([moving, np.full(still, moving[-1])])
    position = position + noise * np.random.default_rng(2).standard_normal(position.size)
    weights = motion_weights(position, 0.0, block)
    assert weights[620:].sum() == pytest.approx(block), "the block in which it comes to rest is one of motion"
    assert (weights[:620] == 1.0).all()


def test_a_swing_has_no_rest() -> None:
    position = 0.01 * np.sin(np.arange(2000) / 30.0) + 1e-5 * np.random.default_rng(2).standard_normal(2000)
    assert (motion_weights(position, 0.0, 20) == 1.0).all()
    assert (motion_weights(np.zeros(60), 0.0, 20) == 1.0).all(), "too short to tell"
