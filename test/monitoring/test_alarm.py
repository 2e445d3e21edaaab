"""The alarm: its bets are fair, its rate of false alarms is what is stated, and it is quick."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from msd_ident.monitoring.alarm import Detector, Ranks, Regression, rank_evidence, shift_evidence


def test_bets_are_fair() -> None:
    scores = np.linspace(-12.0, 12.0, 40_001)
    bets = np.array([shift_evidence(float(score)) for score in scores])
    mean = np.trapezoid(bets * stats.norm.pdf(scores), scores)
    assert 0.8 < mean <= 1.0 + 1e-6  # the largest are cut, which a detector that rings at 365 never feels
    p = np.logspace(-14, 0, 20_001)
    assert np.trapezoid([rank_evidence(float(one)) for one in p], p) == pytest.approx(1.0, abs=0.05)
    assert rank_evidence(0.0) >= 1e6 and rank_evidence(1.0) == 0.5


def test_scores_are_normal_whatever_level_slope_and_scatter() -> None:
    lots, scores = np.random.default_rng(0), []
    for _ in range(60):
        regression, level, slope, scatter = Regression(2), *(100.0 * lots.normal(size=2)), 10.0 ** lots.uniform(-3, 3)
        for _ in range(60):
            x = lots.normal()
            score = regression.update(level + slope * x + scatter * lots.normal(), np.array([1.0, x]))
            if math.isfinite(score):
                scores.append(score)
    assert len(scores) > 3000
    assert stats.kstest(scores, "norm").pvalue > 0.01
    assert abs(np.corrcoef(scores[:-1], scores[1:])[0, 1]) < 0.05


def test_mean_run_to_a_false_alarm_is_at_least_the_threshold() -> None:
    lots, runs, threshold = np.random.default_rng(1), [], 30.0
    for _ in range(60):
        regression, detector, count = Regression(1), Detector(), 0
        while detector.value < threshold:
            score = regression.update(3.0 + lots.normal(), np.array([1.0]))
            count += 1
            if math.isfinite(score):
                detector.update(shift_evidence(score))
        runs.append(count)
    assert np.mean(runs) >= threshold


@pytest.mark.parametrize(("shift", "most"), [(3.0, 6), (10.0, 2)])
def test_a_change_is_found_soon(shift: float, most: int) -> None:
    lots, delays = np.random.default_rng(2), []
    for _ in range(30):
        regression, detector, delay = Regression(1), Detector(), 0
        for number in range(200):
            score = regression.update(lots.normal() + shift * (number >= 100), np.array([1.0]))
            if math.isfinite(score):
                detector.update(shift_evidence(score))
            delay += number >= 100
            if number >= 100 and detector.value > 365.0:
                break
        delays.append(delay)
    assert np.median(delays) <= most


def test_state_goes_on_where_it_was() -> None:
    lots = np.random.default_rng(3)
    data = [(float(lots.normal()), np.array([1.0, lots.normal()])) for _ in range(20)]
    one, other = Regression(2), Regression(2)
    for cut in (1, 9):
        one, other = Regression(2), Regression(2)
        for value, row in data[:cut]:
            one.update(value, row)
        other.restore(one.state())
        told = [(one.update(value, row), other.update(value, row)) for value, row in data[cut:]]
        assert repr([a for a, _ in told]) == repr([b for _, b in told])


def test_ranks_of_equal_numbers_are_drawn_by_lot() -> None:
    ranks = Ranks(7)
    drawn = [ranks.update(0.0) for _ in range(400)]
    assert stats.kstest(drawn[20:], "uniform").pvalue > 0.01
    assert Ranks(7).update(0.0) == drawn[0]
    assert ranks.update(1.0) < 1.0 / 400.0
