"""An identification does not wait for a diagnosis that runs beside it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import Graph, graph, until  # noqa: E402
from rclpy.serialization import serialize_message  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from servos import geared  # noqa: E402

import msd_sim.api  # noqa: E402
from msd_ident.data.record import Record  # noqa: E402
from msd_ident.io import BagWriter, write_csv  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import nanoseconds, time_message  # noqa: E402
from msd_ident.ros.common.parameters import overrides  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_interfaces.action import Diagnose  # noqa: E402
from msd_interfaces.srv import Identify  # noqa: E402

START_NS = 1_700_000_000_000_000_000
#: Longest that an identification may take here [s], on a machine that others keep busy: bench/beside.py measures.
PATIENCE = 5.0


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def a_long_diagnosis(folder: Path) -> Diagnose.Goal:
    """Several rigs with oddities, each diagnosed on its own."""
    paths = []
    for seed in range(6):
        made = msd_sim.api.simulate({"rig": "odd", "experiment": "steps", "seed": seed})
        record = Record(made.time, made.position, made.force_time, made.force)
        write_csv(record, folder / f"odd_{seed}.csv")
        paths.append(f"odd_{seed}.csv")
    return Diagnose.Goal(bag_paths=paths)


def fill(node: Identifier) -> None:
    """Three seconds of a step at 1 kHz in the live buffer."""
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": "paper", "rate": 1000.0})
    keep = made.time < 3.0
    for at, value in zip(made.force_time.tolist(), made.force.tolist(), strict=True):
        node.buffer.add_force(START_NS + round(at * 1e9), value)
    node.buffer.add_positions(START_NS + np.rint(made.time[keep] * 1e9).astype(np.int64), made.position[keep])


def test_identify_is_answered_while_a_diagnosis_runs(ros: Graph, tmp_path: Path) -> None:
    node = ros.add(Identifier(overrides({"auto_fit": False, "bag_folder": str(tmp_path)}), context=ros.context))
    fill(node)
    assert ros.call(Identify, names.IDENTIFY, Identify.Request()).success  # compiled and loaded
    stages: list[str] = []
    goal = a_long_diagnosis(tmp_path)
    handle, result = ros.goal(Diagnose, names.DIAGNOSE, goal, lambda f: stages.append(f.stage))
    until(lambda: "looking at the data" in stages, "the diagnosis to be in its fits")
    for _ in range(3):
        begin = time.monotonic()
        answer = ros.call(Identify, names.IDENTIFY, Identify.Request())
        assert answer.success and time.monotonic() - begin < PATIENCE
        assert not result.done(), "the diagnosis was over before"
    handle.cancel_goal_async()
    until(result.done, "the answer to the cancelled goal", PATIENCE)
    assert result.result().result.message == "cancelled"
    window = nanoseconds(answer.estimate.window_end) - nanoseconds(answer.estimate.window_start)
    assert window == pytest.approx(2.999e9, abs=2e6)


def test_a_diagnosis_tells_its_window(ros: Graph, tmp_path: Path) -> None:
    ros.add(Identifier(overrides({"auto_fit": False, "bag_folder": str(tmp_path)}), context=ros.context))
    steps = {"name": "steps", "hold": 0.6}
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": steps, "rate": 200.0})
    write_csv(Record(made.time, made.position, made.force_time, made.force), tmp_path / "steps.csv")
    _, result = ros.goal(Diagnose, names.DIAGNOSE, Diagnose.Goal(bag_paths=["steps.csv"], start=0.5, end=4.0))
    until(result.done, "the diagnosis", 110.0)
    (found,) = result.result().result.diagnoses
    assert (nanoseconds(found.window_end) - nanoseconds(found.window_start)) / 1e9 == pytest.approx(3.5, abs=0.02)


def test_all_joints_of_a_bag(ros: Graph, tmp_path: Path) -> None:
    """A parameter of the node; a joint whose effort is no force gets its sentence."""
    given = {"auto_fit": False, "bag_folder": str(tmp_path), "all_joints": True}
    ros.add(Identifier(overrides(given), context=ros.context))
    writer = BagWriter(tmp_path / "arm")
    writer.add_topic("/joint_states", "sensor_msgs/msg/JointState")
    servo = geared(1)
    for at, position, effort in zip(servo.time, servo.position, servo.force, strict=True):
        # With speeds: rclpy's serialize_message leaves bytes behind a message whose middle list is empty.
        speeds = [0.0, 0.0]
        message = JointState(name=["elbow", "tool"], position=[position, 0.0], velocity=speeds, effort=[effort, 0.0])
        ns = START_NS + round(float(at) * 1e9)
        message.header.stamp = time_message(ns)
        writer.write("/joint_states", serialize_message(message), ns, ns)
    writer.close()
    _, result = ros.goal(Diagnose, names.DIAGNOSE, Diagnose.Goal(bag_paths=["arm"]))
    until(result.done, "the diagnosis", 110.0)
    assert result.result().result.success, result.result().result.message
    first, second = result.result().result.diagnoses
    assert first.path == "arm elbow" and "geared position servo" in first.summary and first.verdict == ""
    assert second.path == "arm tool" and second.verdict == ""
    _, result = ros.goal(Diagnose, names.DIAGNOSE, Diagnose.Goal())
    until(result.done, "the refusal")
    assert result.result().result.message.startswith("all_joints goes with bags; expected bag_paths")
