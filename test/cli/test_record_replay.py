"""``msd record`` and ``msd replay``: into a bag and back, refusals in one line."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from badinputs import run

from msd_ident.cli.needs_ros import require_ros
from msd_ident.errors import SetupError

MSD = [sys.executable, "-m", "msd_ident.cli.main"]

needs_ros = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="no ROS 2 here")


@contextmanager
def msd(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen([*MSD, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


@needs_ros
def test_what_is_recorded_is_replayed(ros_domain: int, tmp_path: Path) -> None:
    from bagmaker import START_NS, joints
    from graph import graph, until
    from sensor_msgs.msg import JointState

    from msd_ident.io import iterate_messages

    sent = [joints(START_NS + index, [index * 1e-3]) for index in range(50)]
    with graph(ros_domain) as ros:
        publisher = ros.node.create_publisher(JointState, "joint_states", 100)
        with msd("record", "/joint_states", "--out", str(tmp_path / "bag")) as recording:
            until(lambda: publisher.get_subscription_count() or recording.poll() is not None, "the recorder", 60.0)
            for raw in sent:
                publisher.publish(raw)
            publisher.wait_for_all_acked()
            os.kill(recording.pid, signal.SIGINT)
            output, _ = recording.communicate(timeout=60.0)
        assert recording.returncode == 0
        assert output == f"50 messages of 1 topic, none lost, in {tmp_path / 'bag'}\n"
        assert [message.data for message in iterate_messages(tmp_path / "bag")] == sent
        ros.node.destroy_publisher(publisher)
        heard: list[bytes] = []
        ros.node.create_subscription(JointState, "joint_states", heard.append, 100, raw=True)
        with msd("replay", str(tmp_path / "bag"), "--rate", "10", "--wait", "60") as replaying:
            until(lambda: len(heard) == 50 or replaying.poll(), "all messages", 60.0)
            assert replaying.wait(60.0) == 0
    assert heard == sent


@needs_ros
def test_nothing_recorded_is_no_success(ros_domain: int, tmp_path: Path) -> None:
    with msd("record", "/joint_states", "--out", str(tmp_path / "bag"), "--duration", "0.1") as recording:
        _, said = recording.communicate(timeout=60.0)
    assert recording.returncode == 2
    assert said.splitlines()[-1] == (
        f"msd: nothing was recorded in {tmp_path / 'bag'}: no message came, of no topic; expected some: does the rig "
        "run, under the same namespace and ROS_DOMAIN_ID?"
    )


@needs_ros
def test_nobody_who_publishes_is_told_with_the_topics_that_are_there(ros_domain: int, tmp_path: Path) -> None:
    from graph import graph
    from sensor_msgs.msg import JointState

    with graph(ros_domain) as ros:
        ros.node.create_publisher(JointState, "/arm/joint_states", 1)
        with msd("record", "--out", str(tmp_path / "bag"), "--duration", "0.1") as recording:
            _, said = recording.communicate(timeout=60.0)
    assert recording.returncode == 2 and not (tmp_path / "bag").exists()
    assert "nobody publishes encoder or encoder_batch in any namespace, waited 5 s" in said
    assert "/arm/joint_states" in said


@needs_ros
@pytest.mark.parametrize("spaces", [("msd",), ("one", "two")])
def test_the_namespace_is_found(ros_domain: int, tmp_path: Path, spaces: tuple[str, ...]) -> None:
    """README's pipeline is in /msd, and ``msd record`` is typed beside it."""
    from bagmaker import START_NS, joints
    from graph import graph, until
    from sensor_msgs.msg import JointState

    with graph(ros_domain) as ros:
        publishers = [ros.node.create_publisher(JointState, f"/{space}/encoder", 10) for space in spaces]
        raw = joints(START_NS, [0.001])

        def recorded(*more: str) -> tuple[int, str, str]:
            """Exit code, output, errors of a recorder that is interrupted once it has heard something, or refuses."""
            with msd("record", "--out", str(tmp_path / "bag"), *more) as recording:
                heard = publishers[-1].get_subscription_count
                until(lambda: heard() or recording.poll() is not None, "the recorder", 60.0)
                if recording.poll() is None:
                    publishers[-1].publish(raw)
                    publishers[-1].wait_for_all_acked()
                    os.kill(recording.pid, signal.SIGINT)
                output, said = recording.communicate(timeout=60.0)
            return recording.returncode, output, said

        code, output, said = recorded()
        if len(spaces) == 1:
            assert code == 0, said
            assert output.startswith("1 message of 1 topic, none lost")
            assert "recording in the namespace /msd" in said
            return
        assert code == 2 and "in 2 namespaces (/one, /two); expected one: say --namespace /one" in said
        code, output, said = recorded("--namespace", "two")
        assert code == 0 and output.startswith("1 message of 1 topic, none lost"), said


@pytest.fixture
def kept_signals() -> Iterator[None]:
    """What the command makes of signals is put back: a process of its own would end with it."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2)
    before = {number: signal.getsignal(number) for number in numbers}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@needs_ros
@pytest.mark.usefixtures("ros_domain", "kept_signals")
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["record", "--out", "old"], "old exists; expected a new name: nothing is overwritten"),
        (["record", "--all", "force"], "--all and topics were given; expected one of the two"),
        (["record", "--compression", "zip"], "compression is 'zip'; expected one of zstd, none"),
        (["record", "a b"], "topic 'a b': "),
        (["replay", "nowhere"], "nowhere does not exist; expected a bag folder"),
        (["replay", "old", "--rate", "0"], "rate is 0.0; expected 0.01 to 100"),
    ],
    ids=["exists", "all", "compression", "topic", "nowhere", "rate"],
)
def test_what_makes_no_sense_is_refused_in_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old").mkdir()
    done = run(*arguments)
    assert done.code == 2
    assert done.err.startswith("msd: ") and words in done.err and done.err.count("\n") == 1


@needs_ros
def test_a_refusal_ends_the_process_in_one_line(ros_domain: int, tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()
    done = subprocess.run([*MSD, "replay", "old", "--rate", "0"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("msd: rate is 0.0; expected 0.01 to 100") and done.stderr.count("\n") == 1


@pytest.mark.parametrize("missing", ["rclpy", "msd_interfaces"])
def test_without_ros_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch, missing: str) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == missing else object())
    with pytest.raises(SetupError) as refused:
        require_ros("msd demo")
    assert f"{'ROS 2' if missing == 'rclpy' else missing} is not here, and msd demo needs it" in str(refused.value)
    assert "make setup" in str(refused.value) and "source" in str(refused.value)
