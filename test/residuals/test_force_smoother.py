"""The compiled filter and smoother: against all states at once, and with a stiff plant."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

from msd_ident.residuals.force_smoother import STATES, WORK, Law, Readings, filtered, smoothed
from msd_ident.residuals.force_smoother_loops import _transition

STEP, SAMPLES = 0.02, 60
READING = np.array([1.0, 0.0, 0.0, 1.0, 0.0])


def generator(law: Law) -> np.ndarray:
    """(5, 5) of (x, v, d, c, c')."""
    made = np.zeros((STATES, STATES))
    made[0, 1] = made[3, 4] = 1.0
    made[1, :3] = -law.k / law.m, -law.b / law.m, -1.0 / law.m
    made[4, 3:] = -1.0 / law.memory**2, -2.0 / law.memory
    return made


def posterior(readings: np.ndarray, law: Law) -> tuple[np.ndarray, np.ndarray]:
    """Means (n, 5) of all states and standard deviations (n,) of the force, given all readings but the first."""
    n, h, m = readings.size, STEP, law.m
    step = expm(h * generator(law))
    added = np.zeros((STATES, STATES))
    added[:3, :3] = law.walk * np.array([
        [h**5 / (20 * m * m), h**4 / (8 * m * m), -(h**3) / (6 * m)],
        [h**4 / (8 * m * m), h**3 / (3 * m * m), -(h**2) / (2 * m)],
        [-(h**3) / (6 * m), -(h**2) / (2 * m), h],
    ])  # fmt: skip
    slow = generator(law)[3:, 3:]
    still = solve_continuous_lyapunov(slow, -np.diag([0.0, 4.0 * law.smooth / law.memory**3]))
    assert still[0, 0] == pytest.approx(law.smooth), "the variance of the smooth error is its own"
    added[3:, 3:] = still - step[3:, 3:] @ still @ step[3:, 3:].T
    reach = float(np.ptp(readings))
    first = np.zeros((STATES, STATES))
    first[:3, :3] = np.diag([law.variance + law.smooth, (reach / h) ** 2 * 1e-2, max(law.k, m) ** 2 * reach**2])
    first[2, 2] += law.walk
    first[3:, 3:] = still
    first[0, 3] = first[3, 0] = -law.smooth
    whole = np.zeros((STATES * n, STATES * n))
    whole[:STATES, :STATES] = first
    mean = np.zeros(STATES * n)
    mean[0] = readings[0]
    for i in range(1, n):
        here, before = slice(STATES * i, STATES * i + STATES), slice(STATES * (i - 1), STATES * i)
        whole[here, : STATES * i] = step @ whole[before, : STATES * i]
        whole[: STATES * i, here] = whole[here, : STATES * i].T
        whole[here, here] = step @ whole[before, before] @ step.T + added
        mean[here] = step @ mean[before]
    seen = np.kron(np.eye(n)[1:], READING)
    inner = seen @ whole @ seen.T + law.variance * np.eye(n - 1)
    gain = np.linalg.solve(inner, seen @ whole).T
    after = whole - gain @ seen @ whole
    return (mean + gain @ (readings[1:] - seen @ mean)).reshape(n, STATES), np.sqrt(np.diag(after)[2::STATES])


@pytest.mark.parametrize("smooth", [0.0, 1e-6])
def test_the_smoother_is_the_gaussian_posterior(smooth: float) -> None:
    law = Law(1.0, 2.0, 100.0, 1e-8, 30.0, smooth, 0.05)
    time = STEP * np.arange(SAMPLES)
    readings = 1e-2 * np.sin(9.0 * time) + 1e-4 * np.random.default_rng(1).standard_normal(SAMPLES)
    states, work, spread = np.empty((SAMPLES, STATES)), np.empty((SAMPLES, WORK)), np.empty(SAMPLES)
    steps = np.full(SAMPLES - 1, STEP)
    filtered(Readings(steps, readings, np.zeros(SAMPLES - 1)), law, states, work)
    smoothed(steps, law, states, work, spread)
    means, deviation = posterior(readings, law)
    for column in range(STATES):
        scale = max(float(np.max(np.abs(means[:, column]))), 1e-12)
        assert np.max(np.abs(states[:, column] - means[:, column])) < 1e-6 * scale
    assert np.max(np.abs(np.sqrt(spread) / deviation - 1.0)) < 1e-6


@pytest.mark.parametrize(("m", "b", "k"), [(1.0, 2.0, 400.0), (1e-5, 1.5, 0.0), (1e-3, 0.1, 1e5), (1.0, 0.1, -50.0)])
def test_a_step_is_exact_for_stiff_and_for_unstable_plants(m: float, b: float, k: float) -> None:
    law = Law(m, b, k, 1e-8, 1.0, 1e-6, 0.03)
    made, force = np.empty((STATES, STATES)), np.empty(2)
    _transition(STEP, law, made, force)
    expected = expm(STEP * generator(law))
    assert np.max(np.abs(made - expected)) < 1e-9 * np.max(np.abs(expected))
    assert force == pytest.approx(-expected[:2, 2])
