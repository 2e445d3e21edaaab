"""Intervals: correlated and rounded residuals are worth less than as many independent ones."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.signal

from msd_ident.data.record import FloatArray
from msd_ident.estimate.covariance import (
    Linearisation,
    autoregression,
    evidence,
    inverse_beside,
    rest_phases,
    rounding_variance,
)

SAMPLES = 1500
TIME = np.arange(SAMPLES) / SAMPLES
#: A linear model with slow columns, so that the solution is exact and only the intervals are on trial.
COLUMNS = np.stack([np.ones(SAMPLES), TIME, np.sin(20.0 * TIME) * np.exp(-2.0 * TIME)])


def _deviation(errors: FloatArray) -> FloatArray:
    """Deviations of the least-squares solution from the truth (0), in its own standard deviations."""
    gram = COLUMNS @ COLUMNS.T
    solution = np.linalg.solve(gram, COLUMNS @ errors)
    residual = solution @ COLUMNS - errors
    found = evidence(Linearisation(residual, COLUMNS.copy(), np.cumsum(np.ones(SAMPLES)), 0.0))
    inverse = inverse_beside(gram, np.zeros((3, 0)))
    covariance = inverse @ found.meat @ inverse
    return np.asarray(solution / np.sqrt(np.diag(covariance)))


def _coverage(errors_of: object, trials: int = 300) -> float:
    assert callable(errors_of)
    rng = np.random.default_rng(12)
    inside = [np.abs(_deviation(errors_of(rng))) < 1.96 for _ in range(trials)]
    return float(np.mean(inside))


def test_white_errors_are_covered() -> None:
    assert 0.93 < _coverage(lambda rng: rng.normal(size=SAMPLES)) < 0.97


def test_correlated_errors_are_covered_where_plain_least_squares_is_not() -> None:
    def errors(rng: np.random.Generator) -> FloatArray:
        return np.asarray(scipy.signal.lfilter([1.0], [1.0, -1.6, 0.7], rng.normal(size=SAMPLES)))

    assert 0.91 < _coverage(errors) < 0.98
    rng = np.random.default_rng(3)
    gram = COLUMNS @ COLUMNS.T
    plain = []
    for _ in range(200):
        error = errors(rng)
        solution = np.linalg.solve(gram, COLUMNS @ error)
        spread = np.std(solution @ COLUMNS - error) * np.sqrt(np.diag(np.linalg.inv(gram)))
        plain.append(np.abs(solution / spread) < 1.96)
    assert np.mean(plain) < 0.6


def test_errors_that_fade_are_covered() -> None:
    assert 0.92 < _coverage(lambda rng: np.exp(-4.0 * TIME) * rng.normal(size=SAMPLES)) < 0.98


def test_autoregression_finds_its_own_process() -> None:
    values = scipy.signal.lfilter([2.0], [1.0, -1.2, 0.5], np.random.default_rng(0).normal(size=50_000))
    coefficients, variance = autoregression(np.asarray(values), values.size)
    np.testing.assert_allclose(coefficients[:3], [1.0, -1.2, 0.5], atol=0.03)
    assert variance == pytest.approx(4.0, rel=0.05)


def test_white_values_need_no_autoregression() -> None:
    coefficients, variance = autoregression(np.random.default_rng(0).normal(size=5000), 5000)
    assert coefficients.size == 1
    assert variance == pytest.approx(1.0, rel=0.05)


def test_correlated_residuals_are_fewer_pieces_of_evidence() -> None:
    rng = np.random.default_rng(1)
    white = rng.normal(size=SAMPLES)
    ringing = np.asarray(scipy.signal.lfilter([1.0], [1.0, -1.9, 0.95], white))
    position = np.cumsum(np.ones(SAMPLES))
    assert evidence(Linearisation(white, COLUMNS.copy(), position, 0.0)).effective_samples == SAMPLES
    assert evidence(Linearisation(ringing, COLUMNS.copy(), position, 0.0)).effective_samples < 0.1 * SAMPLES


def test_rounding_of_a_quiet_encoder_does_not_average_away() -> None:
    assert rounding_variance(1.0, 0.0) == pytest.approx(1.0 / 12.0, rel=0.03)
    assert rounding_variance(1.0, 1.0) < 1e-8


def test_rounding_variance_is_that_of_the_mean_of_rounded_readings() -> None:
    rng = np.random.default_rng(2)
    noise = 0.25
    means = [np.mean(np.round(place + noise * rng.normal(size=4000)) - place) for place in np.linspace(-0.5, 0.5, 101)]
    assert np.var(means) == pytest.approx(rounding_variance(1.0, noise), rel=0.15)


def test_rest_phases_are_long_stretches_without_motion() -> None:
    position = np.concatenate([np.linspace(0.0, 10.0, 50), np.full(40, 10.0), np.linspace(10.0, 0.0, 50), np.zeros(5)])
    assert [(span.start, span.stop) for span in rest_phases(position, 0.1)] == [(49, 91)]
    assert rest_phases(position, 0.0) == []


def test_a_rest_counts_as_one_reading() -> None:
    """A constant seen by an encoder without noise: its spread is that of rounding, however many samples."""
    position = np.full(SAMPLES, 0.3)
    moving = np.linspace(1.0, 200.0, SAMPLES)
    whole = np.concatenate([moving, position])
    residual = np.random.default_rng(0).uniform(-0.5, 0.5, whole.size)
    residual[SAMPLES:] = 0.2
    only_rest = np.concatenate([np.zeros(SAMPLES), np.ones(SAMPLES)])[None, :]
    found = evidence(Linearisation(residual, only_rest, whole, 1.0))
    spread = math.sqrt(found.meat[0, 0]) / SAMPLES
    assert spread == pytest.approx(1.0 / math.sqrt(12.0), rel=0.1)
