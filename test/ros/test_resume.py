"""A recorder that was killed while it recorded comes back and goes on in a new bag."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import START_NS, joints  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_ident.io import open_bag, repair  # noqa: E402
from msd_interfaces.srv import StartRecording  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


@contextmanager
def recorder(folder: Path, *more: str) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, "-m", "msd_ident.ros.recorder", "--ros-args", "-p", f"bag_folder:={folder}", *more]
    with subprocess.Popen(command) as process:
        try:
            yield process
        finally:
            process.kill()


def bags(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_dir())


def test_a_killed_recorder_goes_on_in_a_new_bag(ros: Graph, tmp_path: Path) -> None:
    encoder = ros.node.create_publisher(JointState, "/arm/joints", 2000)
    sent = iter(range(10**6))
    ros.within(lambda: ros.node.create_timer(0.005, lambda: encoder.publish(joints(START_NS + next(sent), [0.0]))))
    with recorder(tmp_path, "-p", "resume:=true") as process:
        answer = ros.call(StartRecording, "recorder/start", StartRecording.Request(topics=["/arm/joints"]))
        assert answer.success, answer.message
        until(lambda: encoder.get_subscription_count() == 1, "the recorder's subscription")
        first = next(sent)
        until(lambda: next(sent) > first + 100, "some messages")
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    with recorder(tmp_path, "-p", "resume:=true") as process:
        # What was killed counts for as long as its lease, 20 s, lasts.
        until(lambda: len(bags(tmp_path)) == 2 and encoder.get_subscription_count() == 2, "the new bag")
        first = next(sent)
        until(lambda: next(sent) > first + 100, "some messages")
        stopped = ros.call(Trigger, "recorder/stop", Trigger.Request())
        assert stopped.success and " messages of 1 topic, none lost" in stopped.message
        process.send_signal(signal.SIGINT)
        assert process.wait(20.0) == 0
    for bag in bags(tmp_path):
        repair(bag)
        assert list(open_bag(bag).topics) == ["/arm/joints"]
    assert not list(tmp_path.glob(".recording*")), "a recording that was stopped is not taken up again"


@pytest.mark.parametrize("note", ["", "{", "[]", json.dumps({"topics": 3})])
def test_a_note_that_makes_no_sense_is_none(tmp_path: Path, note: str) -> None:
    from msd_ident.ros.recorder.resuming import Interrupted, Notebook

    book = Notebook(tmp_path, "/msd/recorder")
    (tmp_path / ".recording.msd.recorder.json").write_text(note)
    assert book.left() is None
    book.begin(Interrupted(("/a",), False, "zstd"))
    assert book.left() == Interrupted(("/a",), False, "zstd")
    book.end()
    assert book.left() is None
