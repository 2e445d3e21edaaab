"""Which experiments are poor: by their force, and by nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.selection.excitation import changes, poor
from msd_sim import api, lottery

TIME = np.arange(0.0, 6.0, 0.001)
SWING = 0.3


def record(force: np.ndarray) -> Record:
    return from_samples(TIME, force, 0.001 * np.sin(TIME))


def pushes(*levels: float) -> Record:
    """Each level held for an equal part of the time."""
    return record(np.repeat(levels, TIME.size // len(levels)).astype(float)[: TIME.size])


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (pushes(0.0, 2.0), True),
        (pushes(2.0, 2.0), True),
        (pushes(0.0, 2.0, 0.0), True),
        (pushes(0.0, 1.0, 2.0, 3.0, 4.0, 5.0), True),
        (pushes(0.0, 2.0, -2.0, 0.0, 1.0, 0.0), False),
        (pushes(0.0, 0.0), True),
        (record(np.interp(TIME, [0.0, 3.0, 6.0], [-1.0, 1.0, -1.0])), True),
        (record(np.sin(2.0 * math.pi * TIME / SWING)), False),
    ],
    ids=["step", "release", "pulse", "stairs", "steps", "rest", "ramp", "sine"],
)
def test_poor_is_what_changes_quickly_less_than_four_times_or_in_one_direction(found: Record, expected: bool) -> None:
    assert poor([found], SWING) is expected


def test_several_records_of_one_experiment_count_together() -> None:
    assert not poor([pushes(0.0, 2.0, 0.0), pushes(0.0, -1.0, 0.0)], SWING)


def test_changes_are_those_of_the_force() -> None:
    np.testing.assert_allclose(changes(pushes(0.0, 2.0, -1.0, -1.0, 0.0, 0.0), SWING), [2.0, -3.0, 1.0])


EXPERIMENTS = {"steps": 200.0, "sweep": 500.0, "step": 1000.0, "release": 1000.0, "ramp": 250.0}


@pytest.mark.parametrize(("name", "rate"), EXPERIMENTS.items(), ids=EXPERIMENTS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_experiments_of_the_lottery(name: str, rate: float, seed: int) -> None:
    drawn = lottery.draw(seed, None, False, name, rate)
    made = api.simulate(drawn.spec)
    swing = 2.0 * math.pi * math.sqrt(drawn.spec["mass"] / drawn.spec["stiffness"])
    found = Record(made.time, made.position, made.force_time, made.force)
    assert poor([found], swing) is (name in ("step", "release", "ramp"))
