"""``msd diagnose --all-joints``: an arm with a joint of each kind, in one table."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from badinputs import run
from rich.console import Console
from servos import geared, torque

from msd_ident.cli.joints import _show
from msd_ident.io import BagWriter, joints
from msd_ident.workflow.all_joints import JointResult

JOINTS = "sensor_msgs/msg/JointState"
START_NS = 1_700_000_000_000_000_000


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of ``/joint_states``: a torque drive, a geared servo, a joint that rests, one without effort."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    types = store.types
    drive, servo = torque(0), geared(0)
    folder = tmp_path_factory.mktemp("arm") / "bag"
    writer = BagWriter(folder)
    writer.add_topic("/joint_states", JOINTS)
    writer.add_topic("/gripper_states", JOINTS)
    for index, at in enumerate(drive.time.tolist()):
        ns = START_NS + round(at * 1e9)
        header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9), "")
        position = np.array([drive.position[index], servo.position[index], 0.25])
        effort = np.array([drive.force[index], servo.force[index], 0.0])
        message = types[JOINTS](header, ["shoulder", "elbow", "wrist"], position, np.array([]), effort)
        writer.write("/joint_states", bytes(store.serialize_cdr(message, JOINTS)), ns, ns)
        finger = types[JOINTS](header, ["finger"], position[:1], np.array([]), np.array([]))
        writer.write("/gripper_states", bytes(store.serialize_cdr(finger, JOINTS)), ns, ns)
    writer.close()
    return folder


def test_joints_of_a_bag(arm: Path) -> None:
    found = {joint.name: joint for joint in joints(arm)}
    assert list(found) == ["shoulder", "elbow", "wrist", "finger"]
    assert found["elbow"].effort == "/joint_states:effort[elbow]" and not found["finger"].has_effort


@pytest.mark.timeout(300)
def test_every_joint_in_one_table_with_a_sentence(arm: Path, tmp_path: Path, asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag")
    done = run("diagnose", str(arm), "--all-joints", "--json", str(tmp_path / "joints.json"))
    assert done.code == 0, done.err
    lines = {line["joint"]: line for line in map(json.loads, (tmp_path / "joints.json").read_text().splitlines())}
    assert {name: line["effort_usable"] for name, line in lines.items()} == {
        "shoulder": True, "elbow": False, "wrist": False, "finger": False,
    }  # fmt: skip
    assert "geared position servo" in lines["elbow"]["sentence"] and lines["elbow"]["diagnosis"] is None
    assert "no effort" in lines["finger"]["sentence"]
    mass = lines["shoulder"]["diagnosis"]["base"]["parameters"]["mass"]
    assert mass["unit"] == "kg·m²" and 0.1 < mass["value"] < 1.0
    for name in lines:
        assert name in done.out
    assert "e+12" not in done.out
    found = lines["shoulder"]["diagnosis"]
    assert f"{found['extended']['parameters']['mass']['value']:.4g} kg·m²" in done.out
    assert f"shoulder: {lines['shoulder']['sentence']}" in " ".join(done.out.split())


def test_the_inertia_is_that_of_the_model_with_the_named_causes(capsys: pytest.CaptureFixture[str]) -> None:
    def fit(mass: float) -> SimpleNamespace:
        return SimpleNamespace(quantities={"mass": SimpleNamespace(value=mass, unit="kg·m²")})

    diagnosis = SimpleNamespace(verdict="explained", base=fit(0.009359), extended=fit(0.0094071))
    _show(Path("arm"), [JointResult("elbow", True, "It sticks. " * 20, diagnosis)], Console(width=80))  # type: ignore[arg-type]
    told = capsys.readouterr().out
    assert "0.009407 kg·m²" in told and "0.009359" not in told
    assert len(told.splitlines()) < 12, "no narrow column of many lines"


def test_what_does_not_go_together_is_refused(arm: Path, repository: Path) -> None:
    for beside in (("--force", "none"), ("--together",), ("--on", str(arm)), ("--export", "python:rig.py")):
        done = run("diagnose", str(arm), "--all-joints", *beside)
        assert done.code == 2 and "--all-joints goes with one bag's joints" in done.err and beside[0] in done.err
    done = run("diagnose", str(repository / "bags" / "paper_step"), "--all-joints")
    assert done.code == 0 or "holds no joint" in done.err
