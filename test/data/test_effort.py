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


def test_a_joint_that_stands_still_has_no_model() -> None:
    """Of a hand that rests, friction was said to be what its effort shows."""
    resting = 1e-5 * np.round(np.random.default_rng(0).normal(size=2000))
    found = judge(replace(torque(0), position=0.3 + resting))
    assert not found.usable
    assert found.sentence.startswith("it stands still (") and "so there is no model: move it" in found.sentence
    assert judge(replace(torque(0), position=np.where(np.arange(2000) % 2, 0.1, 0.2))).sentence.startswith(
        "it stands still (2 different readings within 0.1 rad"
    )


def test_a_joint_that_hardly_moves() -> None:
    coarse = replace(torque(0), position=0.4 * np.round(torque(0).position / 0.4))
    assert judge(coarse).sentence.startswith("it hardly moves (6 different readings of 2000)")


def test_an_effort_of_the_other_sign_has_no_model_and_says_so() -> None:
    found = judge(replace(torque(0), force=-torque(0).force))
    assert not found.usable and found.inertia < 0.0
    assert found.sentence.startswith("no model, as its inertia would be negative: its sign may be turned: ")
    assert "--force-scale -1" in found.sentence and "friction" not in found.sentence


def test_an_effort_that_carries_gravity_has_no_model() -> None:
    """Friction was said to be what it shows, though the place alone accounts for it."""
    drive, random = torque(0), np.random.default_rng(1)
    slow = np.convolve(random.normal(size=drive.samples), np.ones(200) / 200.0, "same")
    found = judge(replace(drive, force=20.0 * np.sin(drive.position) + 8.0 * slow))
    assert not found.usable
    assert found.sentence.startswith("no model, as its inertia does not show: its effort carries gravity, a spring")


def test_friction_that_drives_is_no_model() -> None:
    drive = torque(0)
    speed = np.gradient(drive.position, drive.time)
    found = judge(replace(drive, force=0.4 * np.gradient(speed, drive.time) - 0.3 * speed))
    assert not found.usable and found.inertia > 0.0
    assert found.sentence.startswith("no model, as its friction would drive it instead of braking")


def test_an_effort_that_the_motion_does_not_explain() -> None:
    drive = torque(0)
    found = judge(replace(drive, force=np.sin(7.3 * drive.time)))
    assert not found.usable
    assert found.sentence.startswith("the motion does not explain its effort: other joints or a contact load it")
