"""A cart that was held and then falls, without a swing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from msd_ident.data.noise import noise_of
from msd_ident.data.record import Record, from_samples
from msd_ident.features import extract
from msd_ident.features.let_go import let_go
from msd_ident.workflow import pipeline
from msd_ident.workflow.preparation import prepare
from msd_sim import api

#: Encoder step [m] and sampling period [s].
STEP, PERIOD = 5e-4, 0.02


def dropped(held: float, creeps: float = 0.0) -> Record:
    """A cart that a hand holds for some seconds, with a slow creep [m/s], and that then goes to its rest."""
    spring = {"mass": 1.0, "damping": 6.0, "stiffness": 13.0, "friction_coefficient": 0.0}
    free = api.simulate({**spring, "initial_position": 0.5, "force_time": [0.0], "force": [0.0], "duration": 3.0,
                         "rate": 1.0 / PERIOD})  # fmt: skip
    before = 0.5 + creeps * PERIOD * np.arange(round(held / PERIOD))[::-1]
    position = np.concatenate((before, free.position))
    time = PERIOD * np.arange(position.size)
    return from_samples(time, np.zeros(time.size), STEP * np.round(position / STEP))


@pytest.mark.parametrize("creeps", [0.0, 1e-3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_was_held_is_left_out(creeps: float, sign: float) -> None:
    record = dropped(2.0, creeps)
    turned = from_samples(record.time, np.zeros(record.samples), sign * record.position)
    found = extract(turned)
    assert found.kind == "none" and found.freed == pytest.approx(2.0, abs=0.15) and found.freed >= 2.0 - PERIOD
    assert found.remarks[0].startswith("The first 2.") and "held or pulled by hand" in found.remarks[0]
    used = prepare([turned])
    assert used.records[0].time[0] == found.freed and found.remarks[0] in used.warnings


@pytest.mark.parametrize(("noise", "step"), [(1e-3, STEP), (5e-3, STEP), (1e-4, 6e-3)])
def test_what_was_held_is_found_in_noise_and_coarse_readings(noise: float, step: float) -> None:
    record = dropped(2.0)
    rough = record.position + noise * np.random.default_rng(3).normal(size=record.samples)
    rough[30] += 0.2
    seen = from_samples(record.time, np.zeros(record.samples), step * np.round(rough / step))
    assert let_go(seen, noise_of(seen)) == pytest.approx(2.1, abs=0.15)


def test_what_rests_and_is_pushed_was_not_held() -> None:
    """A hand pushes a damped cart away from its rest, to which it comes back: the rest before is evidence."""
    record = dropped(0.0)
    rest, push = np.zeros(100), np.linspace(0.0, record.position[0], 25)
    position = np.concatenate((rest, push, record.position))
    pushed = from_samples(PERIOD * np.arange(position.size), np.zeros(position.size), position)
    assert let_go(pushed, noise_of(pushed)) is None and extract(pushed).freed is None


def test_a_record_without_a_swing_beside_one_that_swings_has_no_rest_before() -> None:
    spring = {"mass": 1.0, "damping": 0.3, "stiffness": 13.0, "friction_coefficient": 0.0}
    made = api.simulate({**spring, "initial_position": 0.5, "force_time": [0.0], "force": [0.0], "duration": 12.0,
                         "rate": 1.0 / PERIOD})  # fmt: skip
    swings = from_samples(made.time, np.zeros(made.time.size), STEP * np.round(made.position / STEP))
    used = prepare([swings, dropped(2.0)])
    assert used.form is not None and used.rest_before == (None, None)
    assert used.records[1].time[0] == pytest.approx(2.0, abs=0.15)


def test_what_moves_from_the_start_is_kept_whole() -> None:
    record = dropped(0.0)
    assert let_go(record, noise_of(record)) is None and extract(record).freed is None
    assert prepare([record]).records[0].time[0] == record.time[0]


def test_what_never_moves_is_not_let_go() -> None:
    time = PERIOD * np.arange(200)
    noise = 1e-4 * np.random.default_rng(1).normal(size=time.size)
    still = from_samples(time, np.zeros(time.size), np.where(time > 2.0, 1e-4, 0.0) + noise)
    assert let_go(still, noise_of(still)) is None


def test_no_tone_moves_what_was_held(asking_about: Callable[..., None]) -> None:
    """Of a measured joint that was held and dropped, a tone was named that moved it from its rest."""
    asking_about("periodic_disturbance", "coulomb_friction", "quadratic_drag")
    found = pipeline.diagnose([dropped(2.0, 1e-3)])
    assert not found.causes and found.verdict == "adequate"
    assert found.extended.model["stiffness"] == pytest.approx(13.0, rel=0.05)
