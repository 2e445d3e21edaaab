"""An effort that can be the force, and one that cannot: measured drives, simulated rigs and geared servos."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from servos import geared, torque

from msd_ident.data.joint_effort import judge
from msd_ident.io import read


@pytest.mark.parametrize("seed", range(5))
def test_the_load_of_a_geared_servo_is_no_force(seed: int) -> None:
    found = judge(geared(seed))
    assert not found.usable
    assert found.sentence.startswith("its effort is not the force that moves it, as of a geared position servo")
    assert "measure a torque or a current behind no gear" in found.sentence


@pytest.mark.parametrize("seed", range(5))
def test_the_torque_of_a_drive_is(seed: int) -> None:
    found = judge(torque(seed))
    assert found.usable and found.inertia == pytest.approx(0.4, rel=0.1)


def test_a_measured_axis_with_a_force_is(shared_data: Path) -> None:
    found = judge(read(shared_data / "emps" / "emps_train.csv"))
    assert found.usable and found.explained > 0.9


@pytest.mark.parametrize("name", ["paper_step", "drag_steps"])
def test_a_rig_with_a_force_is(repository: Path, name: str) -> None:
    assert judge(read(repository / "bags" / name)).usable


def test_an_effort_that_is_always_the_same_is_none() -> None:
    still = replace(torque(0), force=np.zeros(2000))
    assert judge(still).sentence == "its effort is 0 all the time: none is measured"


def test_a_joint_that_does_not_move_says_nothing() -> None:
    still = replace(torque(0), position=np.where(np.arange(2000) % 2, 0.1, 0.2))
    assert judge(still).sentence.startswith("it hardly moves (2 different readings)")
