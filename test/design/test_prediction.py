"""Predicted readings, their derivatives, and what is left open of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from designrigs import ALL, SEEN, STEP, explanation
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import from_samples
from msd_ident.design.prediction import DRAWS, Predictor, Sensing, grid, sensing
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction

MODEL = Plant(0.94, 3.9, 694.0) + CoulombFriction(0.1)
PERIOD = 0.23


def predictor(known: float = 0.01, *initial: Initial) -> Predictor:
    return Predictor(replace(explanation(MODEL, known=known), initial=initial or (Initial(),)), 1e-4)


@given(st.floats(0.02, 3.0), st.floats(1e-4, 0.01))
def test_a_grid_covers_its_profile_and_stands_for_all_samples(period: float, between: float) -> None:
    seen = replace(SEEN, period=between)
    on = grid(ALL, period, seen)
    time = on.record.time
    assert time[0] == 0.0 and time[-1] == ALL.duration
    assert on.each * (time.size - 1) * between == pytest.approx(ALL.duration)
    np.testing.assert_array_equal(on.record.force_at(time[:-1]), ALL.force_at(time[:-1]))


@given(st.just(0.0) | st.floats(1e-7, 1e-3), st.floats(0.0, 10.0), st.floats(1.0, 10.0))
def test_a_sample_weighs_more_the_faster_it_moves_and_never_more_than_one(
    step: float, speed: float, faster: float
) -> None:
    seen = Sensing(max(1e-6, 0.3 * step), step, 1e-3)
    slow, fast = seen.weight(np.array([speed, speed * faster]))
    assert 0.0 <= slow <= fast <= 1.0
    assert step > 0.0 or slow == 1.0
    assert seen.dither <= seen.noise


def test_the_coarsest_encoder_and_the_finest_clock_count() -> None:
    time = np.arange(400) / 200.0
    smooth = 0.01 * np.sin(5.0 * time)
    fine = from_samples(time, time, smooth)
    coarse = from_samples(2.0 * time, time, np.round(smooth / 1e-3) * 1e-3)
    seen = sensing([fine, coarse], 3e-4)
    assert (seen.noise, seen.period) == (3e-4, fine.period) and seen.step == pytest.approx(1e-3)


def test_readings_are_those_of_a_simulation_from_the_start_nearest_to_the_relaxed_spring() -> None:
    aside, near, moving = Initial(0.01, 0.0, 0.2), Initial(-0.001, 0.0, 0.3), Initial(0.0, 0.1, 0.4)
    one = predictor(0.01, aside, near, moving)
    assert one.start == near
    on = grid(STEP, PERIOD, SEEN).record
    resting = replace(on, force=0.0 * on.force)
    assert one.positions(resting)[0] == pytest.approx(near.position + near.zero)
    plain = predictor()
    np.testing.assert_allclose(plain.positions(on), simulate(MODEL, on).position, atol=1e-9)


def test_the_jacobian_is_that_of_the_readings() -> None:
    one = predictor()
    on = grid(STEP, PERIOD, SEEN).record
    _, jacobian = one.linearised(on, one.point, np.zeros(2))
    np.testing.assert_array_equal(jacobian[-1], 1.0)
    for entry, value in enumerate(one.point[:3]):
        points = np.repeat(one.point[None, :], 2, axis=0)
        points[:, entry] += np.array([1.0, -1.0]) * 1e-4 * value
        ahead, behind = one.readings(on, points, np.zeros((2, 2)))
        slope = (ahead - behind) / (2e-4 * value)
        assert np.max(np.abs(jacobian[entry] - slope)) < 0.05 * np.max(np.abs(slope)), one.contender.free[entry]


@pytest.mark.parametrize("known", [1e-3, 0.1, 10.0])
def test_draws_scatter_as_the_data_leaves_it_but_not_beyond_a_straight_line(known: float) -> None:
    one = predictor(known)
    assert one.draws.shape == (DRAWS, 4)
    assert np.all(np.abs(one.draws) <= 0.3 * np.abs(one.point) * (1.0 + 1e-9))
    np.testing.assert_array_equal(one.draws, predictor(known).draws)
    np.testing.assert_allclose(one.covariance @ one.precision, np.eye(4), atol=1e-6)
    if known < 0.01:
        np.testing.assert_allclose(one.draws.std(axis=0) / one.point, known, rtol=0.35)


def test_the_drawn_motions_hold_the_fitted_one_and_spread_with_what_is_unknown() -> None:
    on = grid(STEP, PERIOD, SEEN).record
    spreads = []
    for known in (1e-6, 0.05):
        rows = predictor(known).drawn(on)
        np.testing.assert_array_equal(rows[0], predictor(known).positions(on))
        np.testing.assert_array_equal(rows[1:, 0], rows[0, 0])
        spreads.append(float(np.max(np.std(rows, axis=0))) / float(np.ptp(rows[0])))
    assert spreads[0] < 1e-5 and 0.01 < spreads[1] < 0.1
