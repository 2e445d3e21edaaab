"""The missing force: recovered with an honest band, from regular and irregular stamps, without differentiating."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from msd_ident.data.record import Record
from msd_ident.residuals.disturbance import missing_force
from msd_sim.api import Simulated, simulate

PLANT = (0.9407, 3.927, 694.1)
RIG = {"mass": PLANT[0], "damping": PLANT[1], "stiffness": PLANT[2], "friction_coefficient": 0.0}


def made(noise: float, **more: object) -> tuple[Record, Simulated]:
    spec = {**RIG, "encoder": {"counts_per_metre": 0.0, "noise": noise}, "experiment": {"name": "steps", "hold": 0.5}}
    found = simulate({**spec, **more})
    return Record(found.time, found.position, found.force_time, found.force), found


@pytest.mark.parametrize("noise", [2e-6, 5e-5])
def test_recovers_drag_within_its_band(noise: float) -> None:
    record, truth = made(noise, effects={"quadratic_drag": {"drag_coefficient": 4.0}})
    found = missing_force(record, PLANT, noise)
    drag = 4.0 * truth.motion.velocity * np.abs(truth.motion.velocity)
    error = found.force - drag
    assert np.std(error) < 0.2 * np.std(drag)
    assert np.mean(np.abs(error) < 2.0 * found.std) > 0.9
    assert np.corrcoef(found.velocity, truth.motion.velocity)[0, 1] > 0.999


def test_friction_shows_as_a_step_with_the_velocity() -> None:
    record, truth = made(5e-6, effects={"coulomb_friction": {"coulomb_force": 0.3}})
    found = missing_force(record, PLANT, 5e-6)
    fast = np.abs(truth.motion.velocity) > 0.1
    assert np.median(found.force[fast] * np.sign(truth.motion.velocity[fast])) == pytest.approx(0.3, rel=0.1)


def test_nothing_missing_is_nothing_found() -> None:
    record, _ = made(1e-5)
    found = missing_force(record, PLANT, 1e-5)
    assert np.mean(np.abs(found.force) < 2.0 * found.std) > 0.9
    assert found.size < 0.02


def test_irregular_stamps_and_a_force_with_its_own_clock() -> None:
    time = np.sort(np.random.default_rng(4).uniform(0.0, 4.0, 3000))
    record, truth = made(5e-6, effects={"coulomb_friction": {"coulomb_force": 0.3}}, time=time)
    found = missing_force(record, PLANT, 5e-6)
    fast = np.abs(truth.motion.velocity) > 0.1
    assert np.median(found.force[fast] * np.sign(truth.motion.velocity[fast])) == pytest.approx(0.3, rel=0.1)


def test_a_zero_elsewhere_is_not_a_missing_force() -> None:
    record, _ = made(1e-5)
    shifted = Record(record.time, record.position + 0.01, record.force_time, record.force)
    assert missing_force(shifted, PLANT, 1e-5, zero=0.01).size < 0.02
    assert missing_force(shifted, PLANT, 1e-5).size > 1.0


@pytest.mark.parametrize("noise", [1e-5, 1e-7, 1e-9])
def test_readings_of_nothing_but_noise_leave_no_force_at_all(noise: float) -> None:
    """A force that hardly walks is known all but exactly; a smoother that inverts its covariance diverges there."""
    time = np.arange(12_000) / 1000.0
    readings = noise * np.random.default_rng(5).standard_normal(time.size)
    still = Record(time=time, position=readings, force_time=time[:1], force=np.zeros(1))
    found = missing_force(still, (0.9407, 3.927, 694.1), noise)
    assert np.sqrt(np.mean(found.force**2)) < 694.1 * noise
    assert np.min(found.std) > 0.0 and np.max(found.std) < 694.1 * noise


def test_the_smoother_is_the_gaussian_posterior() -> None:
    """Against all states at once, by linear algebra: prior walk of the force, then every reading."""
    h, samples, plant, noise = 0.02, 60, (1.0, 2.0, 100.0), 1e-4
    time = h * np.arange(samples)
    readings = 1e-2 * np.sin(9.0 * time) + noise * np.random.default_rng(1).standard_normal(samples)
    force = np.zeros(1)
    found = missing_force(Record(time=time, position=readings, force_time=time[:1], force=force), plant, noise)
    expected, spread = _posterior(time, readings, plant, noise, found.walk)
    assert np.max(np.abs(found.force - expected)) < 1e-6 * np.max(np.abs(expected))
    assert np.max(np.abs(found.std / spread - 1.0)) < 1e-6


def _posterior(
    time: np.ndarray, readings: np.ndarray, plant: tuple[float, float, float], noise: float, walk: float
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation (n,) of the force, given all readings but the first, whose state is the prior."""
    m, b, k = plant
    h, n = float(time[1] - time[0]), time.size
    step = expm(h * np.array([[0.0, 1.0, 0.0], [-k / m, -b / m, -1.0 / m], [0.0, 0.0, 0.0]]))
    noise_in = walk * np.array([
        [h**5 / (20 * m * m), h**4 / (8 * m * m), -(h**3) / (6 * m)],
        [h**4 / (8 * m * m), h**3 / (3 * m * m), -(h**2) / (2 * m)],
        [-(h**3) / (6 * m), -(h**2) / (2 * m), h],
    ])  # fmt: skip
    reach = float(np.ptp(readings))
    variance = max(noise, 1e-9 * reach) ** 2
    first = np.diag([variance, max(reach / h, 1e-12) ** 2 * 1e-2, max(k * reach, m * reach) ** 2 + walk])
    covariance = np.zeros((3 * n, 3 * n))
    covariance[:3, :3] = first
    for i in range(1, n):
        here, before = slice(3 * i, 3 * i + 3), slice(3 * i - 3, 3 * i)
        covariance[here, : 3 * i] = step @ covariance[before, : 3 * i]
        covariance[: 3 * i, here] = covariance[here, : 3 * i].T
        covariance[here, here] = step @ covariance[before, before] @ step.T + noise_in
    mean = np.zeros(3 * n)
    mean[0] = readings[0]
    for i in range(1, n):
        mean[3 * i : 3 * i + 3] = step @ mean[3 * i - 3 : 3 * i]
    seen, force = np.arange(3, 3 * n, 3), np.arange(2, 3 * n, 3)
    inner = covariance[np.ix_(seen, seen)] + variance * np.eye(n - 1)
    gain = np.linalg.solve(inner, covariance[np.ix_(seen, force)]).T
    after = covariance[np.ix_(force, force)] - gain @ covariance[np.ix_(seen, force)]
    return mean[force] + gain @ (readings[1:] - mean[seen]), np.sqrt(np.diag(after))
