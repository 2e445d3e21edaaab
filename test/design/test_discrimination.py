"""What a refit leaves of the difference between rivals, and how often that decides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from designrigs import SEEN, STEP, explanation
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.design.discrimination import Discrimination, discriminate, occam, refit, sharpened, weights
from msd_ident.design.prediction import Predictor, Sensing, grid
from msd_ident.model import Model, Plant
from msd_ident.model.effects.quadratic_drag import QuadraticDrag

PLANT = Plant(0.94, 3.9, 694.0)
PERIOD = 0.23


def compared(*models: Model, known: float = 0.01, shares: np.ndarray | None = None) -> Discrimination:
    """One step, under each of the models."""
    predictors = [Predictor(explanation(model, known=known), 1e-4) for model in models]
    on = grid(STEP, PERIOD, SEEN)
    return discriminate(predictors, [one.predict(on.record) for one in predictors], on, SEEN, shares)


@settings(max_examples=25)
@given(st.integers(1, 4), st.integers(0, 2**31))
def test_a_refit_takes_what_lies_along_its_parameters_and_nothing_else(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    jacobian, weight = rng.normal(size=(count, 60)), rng.uniform(0.5, 2.0, 60)
    along, any_way = rng.normal(size=(2, count)) @ jacobian, rng.normal(size=(2, 60))
    free = refit(jacobian, weight, 1e-9 * np.eye(count))
    assert np.max(np.abs(free.left(along))) < 1e-6 * np.max((along * weight) @ along.T)
    whole, left = (any_way * weight) @ any_way.T, free.left(any_way)
    assert np.linalg.eigvalsh(left)[0] > -1e-9 and np.linalg.eigvalsh(whole - left)[0] > -1e-9
    np.testing.assert_allclose(free.left(any_way + along), left, atol=1e-5 * np.max(whole))
    held = refit(jacobian, weight, 1e12 * np.eye(count))
    np.testing.assert_allclose(held.left(any_way), whole, rtol=1e-6, atol=1e-6)


def test_the_same_model_is_never_decided_and_another_at_once() -> None:
    twins = compared(PLANT, PLANT)
    assert np.max(twins.decided) < 0.05
    others = compared(PLANT, PLANT.with_values({"mass": 1.1 * PLANT.mass}), known=1e-4)
    assert np.min(others.decided) > 0.99 and np.min(others.chi[~np.eye(2, dtype=bool)]) > 1e3
    assert others.asked(np.array([0.7, 0.3])).probability > 0.99


def test_what_the_parameters_may_take_up_does_not_decide() -> None:
    """A fifth of the drag is seen in one step where the plant is known, and hidden where it is not."""
    dragging = PLANT + QuadraticDrag(0.02)
    sure, unsure = (compared(PLANT, dragging, known=known) for known in (1e-6, 0.3))
    assert sure.chi[1, 0] > 1.5 * unsure.chi[1, 0]
    assert np.all(sure.decided >= unsure.decided)


def test_what_a_real_refit_leaves_scales_the_chi() -> None:
    models = (PLANT, PLANT.with_values({"damping": 4.5}))
    whole, half = compared(*models), compared(*models, shares=np.full((2, 2), 0.5))
    np.testing.assert_allclose(half.chi, 0.5 * whole.chi)
    assert np.all(half.decided <= whole.decided)


def test_the_error_of_the_laws_counts_in_a_new_record_too() -> None:
    """A difference of some noise levels was said to decide, between laws that leave 50 of the measured record."""
    predictors = [Predictor(explanation(one, known=1e-4), 1e-4) for one in (PLANT, PLANT.with_values({"mass": 0.945}))]
    on = grid(STEP, PERIOD, SEEN)
    made = [one.predict(on.record) for one in predictors]
    exact, rough = (
        discriminate(predictors, made, on, seen) for seen in (SEEN, replace(SEEN, variance=50.0**2 * 100.0))
    )
    assert np.min(exact.decided) > 0.95 and np.max(rough.decided) < 0.05
    assert weights(made[0], on, replace(SEEN, variance=4.0)) == pytest.approx(weights(made[0], on, SEEN) / 4.0)


def test_a_rival_alone_is_decided() -> None:
    assert compared(PLANT).decided.tolist() == [1.0]


@settings(max_examples=25)
@given(st.floats(0.0, 1e8))
def test_the_share_of_the_space_that_is_left_falls_with_what_is_known(information: float) -> None:
    one = Predictor(explanation(PLANT), 1e-4)
    scale = one.contender.scale
    left = occam(one, information * np.diag(scale**-2.0))
    assert left == pytest.approx(-0.5 * 3.0 * np.log1p(information), rel=1e-9, abs=1e-12)


def test_a_profile_adds_information_and_takes_none_away() -> None:
    one = Predictor(explanation(PLANT), 1e-4)
    on = grid(STEP, PERIOD, SEEN)
    prediction = one.predict(on.record)
    weight = weights(prediction, on, SEEN)
    added = sharpened(one, prediction, weight) - one.contender.information
    assert np.linalg.eigvalsh(added / np.outer(1.0 / one.contender.scale, 1.0 / one.contender.scale))[0] > -1e-3
    twice = sharpened(one, prediction, 2.0 * weight) - one.contender.information
    np.testing.assert_allclose(twice, 2.0 * added, rtol=1e-6)


def test_instants_of_a_grid_weigh_as_much_as_the_samples_that_they_stand_for() -> None:
    one = Predictor(explanation(PLANT), 1e-4)
    for period in (0.1, 0.4):
        on = grid(STEP, period, SEEN)
        total = weights(one.predict(on.record), on, SEEN).sum() * SEEN.noise**2
        assert total == pytest.approx(STEP.duration / SEEN.period, rel=0.01)
    coarse = Sensing(1e-5, 1e-4, 0.002)
    on = grid(STEP, PERIOD, coarse)
    assert weights(one.predict(on.record), on, coarse).sum() * coarse.noise**2 < 0.9 * STEP.duration / coarse.period
