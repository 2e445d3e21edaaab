"""The missing force: recovered with an honest band, from regular and irregular stamps, without differentiating."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.diagnose.missing import missing_force
from msd_ident.record import Record
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
