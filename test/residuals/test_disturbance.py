"""The missing force: recovered with an honest band, from regular and irregular stamps, without differentiating."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal

from msd_ident.data.record import Record
from msd_ident.residuals.disturbance import equivalent, lacking_force, missing_force
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


def wandering(record: Record, size: float, rate: float) -> np.ndarray:
    """A smooth error (n,) of this size [m] with nothing above this frequency [Hz]."""
    white = np.random.default_rng(7).standard_normal(record.samples)
    low = scipy.signal.sosfiltfilt(scipy.signal.butter(2, rate, fs=1.0 / record.period, output="sos"), white)
    return np.asarray(size * low / np.std(low))


def test_a_smooth_error_of_the_sensor_is_no_force() -> None:
    """As a force it would take m ω² e: a multiple of all forces that act."""
    record, _ = made(1e-6)
    error = wandering(record, 2e-4, 40.0)
    read = Record(record.time, record.position + error, record.force_time, record.force)
    found = lacking_force(read, -error, PLANT, 1e-6)
    plain = missing_force(read, PLANT, 1e-6)
    assert np.sqrt(np.mean(found.force**2 + found.std**2)) < 0.3, "of 8 N that act"
    assert plain.size > 4.0, "without a sensor that errs the same readings ask for it"


def test_a_lacking_force_stays_one_where_the_sensor_may_err() -> None:
    record, truth = made(5e-6, effects={"coulomb_friction": {"coulomb_force": 0.3}})
    clean, _ = made(0.0)
    found = lacking_force(record, clean.position - record.position, PLANT, 5e-6)
    fast = np.abs(truth.motion.velocity) > 0.1
    assert np.median(found.force[fast] * np.sign(truth.motion.velocity[fast])) == pytest.approx(0.3, rel=0.15)


def test_the_equivalent_plant_is_the_linear_force_next_to_what_acts() -> None:
    """A spring and a damper that the model does not know, of a plant without either."""
    record, _ = made(1e-6)
    bare = missing_force(record, (PLANT[0], 0.0, 0.0), 1e-6)
    assert equivalent(bare) == pytest.approx(PLANT[1:], rel=0.02)


def test_a_residual_moves_like_the_plant_equivalent_to_all_that_acts_in_the_simulation() -> None:
    """The spring and the damper may be laws beside the plant, as gravity is: they are those of the simulated motion."""
    record, _ = made(1e-6)
    clean, _ = made(0.0)
    found = lacking_force(record, clean.position - record.position, (PLANT[0], 0.0, 0.0), 1e-6)
    assert found.plant == pytest.approx(PLANT, rel=0.02)
    speed = np.gradient(clean.position, clean.time)
    assert np.corrcoef(found.velocity, speed)[0, 1] > 0.999
