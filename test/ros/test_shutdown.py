"""Nodes end on a signal with exit code 0 and no traceback, however often it comes; bags are closed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

import numpy as np  # noqa: E402
from bagmaker import JOINTS, START_NS, joints, stamps  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_ident.design import Profile, Segment  # noqa: E402
from msd_ident.design.profile_file import to_yaml  # noqa: E402
from msd_ident.io import BagWriter, SourceOptions, open_bag, read  # noqa: E402
from msd_interfaces.action import Diagnose, RunExperiment  # noqa: E402

#: Asks for the diagnosis of ``diagnosing``.
LONG = Diagnose.Goal(bag_paths=["long.csv"])


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


@contextmanager
def running(ros: Graph, kind: str, **parameters: object) -> Iterator[subprocess.Popen[str]]:
    """A node's process, once it is in the graph."""
    name = f"{kind}_{uuid.uuid4().hex}"
    given = [f"{key}:={value}" for key, value in parameters.items()]
    command = [sys.executable, "-m", f"msd_ident.ros.{kind}", "--ros-args", "-r", f"__node:={name}"]
    command += [word for value in given for word in ("-p", value)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            until(lambda: name in ros.node.get_node_names() or process.poll() is not None, f"the {kind}", 60.0)
            yield process
        finally:
            process.kill()


def ended(process: subprocess.Popen[str]) -> str:
    """Its output; the exit code is 0 and there is no traceback."""
    output, _ = process.communicate(timeout=60.0)
    assert process.returncode == 0 and "Traceback" not in output, output
    return output


def interrupt_twice(process: subprocess.Popen[str]) -> None:
    os.kill(process.pid, signal.SIGINT)
    os.kill(process.pid, signal.SIGINT)


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGHUP])
def test_the_identifier_ends_while_it_gets_ready(ros: Graph, ending: signal.Signals) -> None:
    with running(ros, "identifier") as process:
        os.kill(process.pid, ending)
        ended(process)


def test_the_identifier_ends_on_two_interrupts(ros: Graph) -> None:
    with running(ros, "identifier") as process:
        interrupt_twice(process)
        ended(process)


@contextmanager
def diagnosing(ros: Graph, folder: Path) -> Iterator[tuple[subprocess.Popen[str], str, Any]]:
    """An identifier in the middle of a diagnosis that takes many seconds: process, name, future of the result."""
    time = np.arange(60_000) / 300.0
    swing = np.sin(8.0 * time + np.sin(time)) * np.exp(-(time % 3.0))
    table = np.column_stack((time, 10.0 * ((time // 1.5) % 2), 0.01 * swing))
    np.savetxt(folder / "long.csv", table, "%.9g", delimiter=",", header="time_s,force_n,position_m", comments="")
    stages: list[str] = []
    with running(ros, "identifier", bag_folder=folder) as process:
        name = str(process.args).partition("__node:=")[2].partition("'")[0]
        _, answer = ros.goal(Diagnose, f"{name}/diagnose", LONG, lambda feedback: stages.append(feedback.stage))
        until(lambda: stages[-1:] == ["looking at the data"], "the diagnosis to begin", 60.0)
        yield process, name, answer


def test_the_identifier_ends_in_the_middle_of_a_diagnosis_while_many_call(ros: Graph, tmp_path: Path) -> None:
    with diagnosing(ros, tmp_path) as (process, name, _):
        client = ros.node.create_client(Trigger, f"{name}/trigger")
        assert client.wait_for_service(20.0)
        for _ in range(50):
            client.call_async(Trigger.Request())
        interrupt_twice(process)
        for _ in range(50):
            client.call_async(Trigger.Request())
        ended(process)


def test_who_waits_for_a_diagnosis_is_told_that_the_identifier_ends(ros: Graph, tmp_path: Path) -> None:
    """One goal is worked on, one waits; a launch that ends left both clients waiting."""
    with diagnosing(ros, tmp_path) as (process, name, first):
        _, second = ros.goal(Diagnose, f"{name}/diagnose", LONG)
        os.kill(process.pid, signal.SIGINT)
        for future in (first, second):
            until(future.done, "the answer", 20.0)
            result = future.result().result
            assert (result.success, result.message) == (False, "stopped: the identifier ends")
        ended(process)


def test_the_recorder_closes_its_bag(ros: Graph, tmp_path: Path) -> None:
    encoder = ros.node.create_publisher(JointState, "encoder", 2000)
    with running(ros, "recorder", bag_folder=tmp_path, folder="bag", autostart="true") as process:
        until(encoder.get_subscription_count, "the recorder's subscription")
        for index in range(200):
            encoder.publish(joints(START_NS + index, [index * 1e-3]))
        assert encoder.wait_for_all_acked(rclpy.duration.Duration(seconds=20))
        interrupt_twice(process)
        assert "200 messages of 1 topic, none lost" in ended(process)
    bag = open_bag(tmp_path / "bag")
    assert len(list(bag.messages())) == 200 and not bag.notes


def test_the_experimenter_lets_go_and_closes_its_bag(ros: Graph, tmp_path: Path) -> None:
    """Nothing spins its node any more: what was sent last is in the bag all the same."""
    from msd_sim.node.rig_node import RigNode

    ros.spin(RigNode(context=ros.context, parameter_overrides=[Parameter("rate", value=200.0)]))
    profile = Profile((Segment("step", 15.0, force=5.0),), "long")
    goal = RunExperiment.Goal(profile=to_yaml(profile), limits="force: 10\ntravel: 0.03\nduration: 20\n", folder="one")
    moved: list[float] = []
    with running(ros, "experimenter", bag_folder=tmp_path) as process:
        (name,) = (name for name in ros.node.get_node_names() if name.startswith("experimenter_"))
        _, answer = ros.goal(RunExperiment, f"{name}/run", goal, lambda told: moved.append(told.position))
        until(lambda: moved and abs(moved[-1]) > 1e-3, "the motion")
        os.kill(process.pid, signal.SIGTERM)
        until(answer.done, "the answer", 20.0)
        output = ended(process)
    assert not answer.result().result.success and answer.result().result.bag_path == str(tmp_path / "one")
    assert "lack its end" not in output, output
    record = read(tmp_path / "one", SourceOptions())
    assert 5.0 in record.force and record.force[-1] == 0.0 and record.duration < 10.0


def test_the_replayer_ends_in_the_middle_of_a_loop(ros: Graph, tmp_path: Path) -> None:
    heard: list[bytes] = []
    ros.node.create_subscription(JointState, "encoder", heard.append, 1000, raw=True)
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/encoder", JOINTS)
        for at in stamps(100):
            writer.write("/encoder", joints(at, [0.0]), at)
    with running(ros, "replayer", bag=tmp_path / "bag", loop="true") as process:
        until(lambda: heard, "a message")
        interrupt_twice(process)
        ended(process)


@pytest.mark.parametrize(
    ("kind", "arguments", "words"),
    [
        ("replayer", [], "msd: no bag to play; expected the parameter bag"),
        ("recorder", ["-p", "compression:=zip"], "msd: compression is 'zip'; expected one of zstd, none"),
        ("identifier", ["-p", "settle_time:=fast"], "msd: settle_time is 'fast'; expected a number"),
        ("identifier", ["-p", "settle_time"], "msd: ROS cannot start: "),
    ],
)
def test_what_makes_no_sense_ends_with_one_line_and_code_2(
    ros_domain: int, kind: str, arguments: list[str], words: str
) -> None:
    command = [sys.executable, "-m", f"msd_ident.ros.{kind}", "--ros-args", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert done.returncode == 2
    ours = [line for line in done.stderr.splitlines() if "[rcl]" not in line]
    assert len(ours) == 1 and ours[0].startswith(words), done.stderr


def test_a_node_without_its_keys_does_not_start(
    ros_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "enclaves").mkdir()
    for name, value in (("ENABLE", "true"), ("STRATEGY", "Enforce"), ("KEYSTORE", str(tmp_path))):
        monkeypatch.setenv(f"ROS_SECURITY_{name}", value)
    command = [sys.executable, "-m", "msd_ident.ros.identifier", "--ros-args", "--enclave", "/msd/identifier"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert done.stderr.splitlines()[-1].startswith("msd: ROS cannot start: ") and "SECURITY ERROR" in done.stderr


def test_an_empty_bag_ends_with_one_line_and_code_2(ros_domain: int, tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/encoder", JOINTS)
    given = ["-p", f"bag:={tmp_path / 'bag'}", "-p", "wait:=0.0"]
    command = [sys.executable, "-m", "msd_ident.ros.replayer", "--ros-args", *given]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert done.returncode == 2
    assert f"msd: {tmp_path / 'bag'} has no messages to play; expected some\n" in done.stderr
