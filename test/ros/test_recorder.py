"""The recorder: every byte, start and stop, topics that come late, refusals in words."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import START_NS, joints  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from rclpy.serialization import deserialize_message, serialize_message  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_ident.data import quality  # noqa: E402
from msd_ident.errors import DataError, UsageError  # noqa: E402
from msd_ident.io import SourceOptions, iterate_messages, open_bag, read  # noqa: E402
from msd_ident.ros.common.missing_samples import TopicCount  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402
from msd_ident.ros.recorder.recording import Recording  # noqa: E402
from msd_interfaces.msg import EncoderBatch  # noqa: E402
from msd_interfaces.srv import StartRecording  # noqa: E402

LASTING = DurabilityPolicy.TRANSIENT_LOCAL
START, STOP = "recorder/start", "recorder/stop"
#: Of a rig at rest: a position that never changes is refused.
NOISE = {"encoder.noise": 1e-5}
#: Of the rig while the recorder is held up [Hz], and for how long [s]: more samples than a queue of 1000 keeps.
RATE, HELD = 500.0, 3.2


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def recorder(ros: Graph, root: Path, **parameters: object) -> Recorder:
    given = {"bag_folder": str(root), **parameters}
    made: Recorder = ros.add(
        Recorder([Parameter(name, value=value) for name, value in given.items()], context=ros.context)
    )
    return made


def test_every_message_is_in_the_bag_byte_by_byte(ros: Graph, tmp_path: Path) -> None:
    lasting = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    encoder = ros.node.create_publisher(JointState, "encoder", 2000)
    force = ros.node.create_publisher(Float64, "force", lasting)
    force.publish(Float64(data=10.425))
    node = recorder(ros, tmp_path)
    answer = ros.call(StartRecording, START, StartRecording.Request(folder="one"))
    assert answer.success and answer.path == str(tmp_path / "one"), answer.message
    until(encoder.get_subscription_count, "the recorder's subscription")
    for index in range(1500):
        encoder.publish(joints(START_NS + index, [index * 1e-3]))
    until(lambda: node.summary and node.summary.messages == 1501, "all messages")
    answer = ros.call(Trigger, STOP, Trigger.Request())
    assert answer.success
    assert answer.message == f"1501 messages of 2 topics, none lost, in {tmp_path / 'one'}"
    raw = [message.data for message in iterate_messages(tmp_path / "one", ["/encoder"])]
    assert raw == [joints(START_NS + index, [index * 1e-3]) for index in range(1500)]
    bag = open_bag(tmp_path / "one")
    assert bag.topics["/force"].offered_qos[0].durability == "transient_local"
    assert bag.topics["/encoder"].offered_qos[0].durability == "volatile"
    assert all(topic.definition for topic in bag.topics.values())
    (kept,) = iterate_messages(tmp_path / "one", ["/force"])
    assert deserialize_message(kept.data, Float64).data == 10.425
    assert 0 < kept.publish_time_ns < kept.log_time_ns


def test_a_topic_that_comes_late_is_recorded_from_then_on(ros: Graph, tmp_path: Path) -> None:
    node = recorder(ros, tmp_path)
    answer = ros.call(StartRecording, START, StartRecording.Request(folder="late", topics=["encoder_batch", "/a/b"]))
    assert answer.message.endswith("as soon as they come: /a/b, /encoder_batch")
    late = ros.node.create_publisher(EncoderBatch, "encoder_batch", 10)
    other = ros.node.create_publisher(Float64, "c", 10)
    until(late.get_subscription_count, "the recorder's subscription")
    late.publish(EncoderBatch(period_ns=100_000, positions=[1.0, 2.0]))
    until(lambda: node.summary and node.summary.messages == 1, "the message")
    assert other.get_subscription_count() == 0, "nobody asked for this one"
    assert ros.call(Trigger, STOP, Trigger.Request()).success
    assert [message.topic for message in iterate_messages(tmp_path / "late")] == ["/encoder_batch"]


def test_all_topics_but_hidden_ones(ros: Graph, tmp_path: Path) -> None:
    publishers = {name: ros.node.create_publisher(Float64, name, 10) for name in ("x", "y/z", "_hidden")}
    node = recorder(ros, tmp_path, all_topics=True, autostart=True, folder="all")
    for name in ("x", "y/z"):
        until(publishers[name].get_subscription_count, f"the subscription to {name}")
        publishers[name].publish(Float64(data=1.0))
    until(lambda: node.summary and {"/x", "/y/z"} <= {t for t, c in node.summary.topics.items() if c.received}, "both")
    assert publishers["_hidden"].get_subscription_count() == 0
    assert ros.call(Trigger, STOP, Trigger.Request()).success
    assert {"/x", "/y/z"} <= set(open_bag(tmp_path / "all").topics)


def test_start_and_stop_by_signal(ros: Graph, tmp_path: Path) -> None:
    node = recorder(ros, tmp_path)
    node.on_signal(signal.SIGUSR2)
    assert node.summary is None, "nothing to stop: a warning, no more"
    node.on_signal(signal.SIGUSR1)
    assert node.summary is not None and node.summary.folder.parent == tmp_path
    first = node.summary.folder
    assert first.name.startswith("msd_20")
    node.on_signal(signal.SIGUSR2)
    assert open_bag(first).topics == {}


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (StartRecording.Request(folder="../elsewhere"), "../elsewhere is not below"),
        (StartRecording.Request(folder="/etc/bag"), "/etc/bag is not below"),
        (StartRecording.Request(folder="link/bag"), "link/bag is not below"),
        (StartRecording.Request(folder="."), ". is not below"),
        (StartRecording.Request(folder="old"), "old exists; expected a new name"),
        (StartRecording.Request(folder="file"), "file exists; expected a new name"),
        (StartRecording.Request(folder="a", compression="zip"), "compression is 'zip'; expected one of zstd, none"),
        (StartRecording.Request(folder="a", topics=["a b"]), "topic 'a b': "),
        (StartRecording.Request(folder="a", topics=[""]), "a topic without a name; expected one such as force"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_makes_no_sense_is_refused_in_words(
    ros: Graph, tmp_path: Path, request_: StartRecording.Request, words: str
) -> None:
    (tmp_path / "link").symlink_to("/")
    (tmp_path / "file").write_text("something")
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "metadata.yaml").write_text("something")
    node = recorder(ros, tmp_path)
    answer = ros.call(StartRecording, START, request_)
    assert not answer.success and words in answer.message and "\n" not in answer.message
    assert node.summary is None
    assert (tmp_path / "old" / "metadata.yaml").read_text() == "something"


def test_twice_started_and_twice_stopped_is_refused_in_words(ros: Graph, tmp_path: Path) -> None:
    recorder(ros, tmp_path)
    answer = ros.call(Trigger, STOP, Trigger.Request())
    assert (answer.success, answer.message) == (False, "no recording in progress; expected recorder/start first")
    assert ros.call(StartRecording, START, StartRecording.Request(folder="one")).success
    answer = ros.call(StartRecording, START, StartRecording.Request(folder="two"))
    assert answer.message == f"already recording to {tmp_path / 'one'}; expected recorder/stop first"
    assert not (tmp_path / "two").exists()


def test_parameters_are_refused_in_words(ros_domain: int) -> None:
    with graph(ros_domain) as ros, pytest.raises(UsageError, match="compression is 'gzip'; expected one of zstd, none"):
        Recorder([Parameter("compression", value="gzip")], context=ros.context)


def test_numbers_of_a_publisher_tell_what_was_lost() -> None:
    count = TopicCount()
    for number in (5, 6, 9, 10, 1, 2, None):
        count.count(number)
    assert (count.received, count.lost, count.restarts) == (7, 2, 1), "a number that falls is of one that began anew"


def test_what_the_disk_cannot_take_is_counted_and_never_blocks(tmp_path: Path) -> None:
    recording = Recording(tmp_path / "bag", most_bytes=10)
    recording.add_topic("/x", "std_msgs/msg/Float64", [])
    raw = serialize_message(Float64(data=1.0))
    recording.put("/x", raw, 1, 1)
    recording.put("/x", b"", 2, 2)
    summary = recording.close()
    assert summary.refused == 1 and summary.lost == 1
    assert summary.sentence == f"2 messages of 1 topic, 1 lost, in {tmp_path / 'bag'}"


def test_a_disk_that_fails_ends_the_recording_with_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recording = Recording(tmp_path / "bag")
    recording.add_topic("/x", "std_msgs/msg/Float64", [])
    shutil.rmtree(tmp_path / "bag")  # as when the drive is pulled out
    recording.put("/x", serialize_message(Float64(data=1.0)), 1, 1)
    summary = recording.close()
    assert summary.error.startswith("cannot write ") and summary.sentence.endswith(summary.error)
    assert (summary.messages, summary.lost) == (1, 1)


@contextmanager
def process(module: str, **parameters: object) -> Iterator[subprocess.Popen[str]]:
    """A node that runs by itself, ended with the block."""
    words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    command = [sys.executable, "-m", module, "--ros-args", *words]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as made:
        try:
            yield made
        finally:
            made.kill()


def test_who_listens_for_another_type_keeps_nothing_from_the_bag(ros: Graph, ros_domain: int, tmp_path: Path) -> None:
    """An identifier waits for the usual type of a force; the rig has a type of its own."""
    with graph(ros_domain) as other:
        other.node.create_subscription(WrenchStamped, "force", lambda message: None, 10)
        clash = other.node.create_publisher(WrenchStamped, "force", 10)
        force = ros.node.create_publisher(Float64, "force", QoSProfile(depth=5, durability=LASTING))
        force.publish(Float64(data=10.425))
        until(lambda: ros.node.count_publishers("force") == 2, "both publishers")
        node = recorder(ros, tmp_path, autostart=True, folder="one")
        until(lambda: any("as 2 types" in sentence for sentence in node.watch.recent), "the refusal of two types")
        other.node.destroy_publisher(clash)
        until(lambda: node.summary and node.summary.messages == 1, "the force, once it is clear of what type it is")


def test_no_sample_of_a_rig_at_10_khz_is_lost(ros: Graph, tmp_path: Path) -> None:
    node = recorder(ros, tmp_path, autostart=True, folder="rig", topics=["/encoder_batch"])
    with process("msd_sim.node", rate=10_000.0, **NOISE) as rig:
        until(lambda: node.summary and node.summary.messages >= 200 or rig.poll() is not None, "samples", 60.0)
        stopped = ros.call(Trigger, STOP, Trigger.Request())
    assert "none lost" in stopped.message
    record = read(tmp_path / "rig", SourceOptions(force="none", position="/encoder_batch:positions"))
    assert record.samples >= 19_900 and quality.missing_samples(record) == 0


def test_no_sample_of_a_rig_is_lost_while_the_recorder_is_held_up(ros: Graph, tmp_path: Path) -> None:
    heard: list[bytes] = []
    ros.node.create_subscription(JointState, "encoder", heard.append, 10, raw=True)
    folder, whole = tmp_path / "rig", SourceOptions(force="none", position="/encoder")

    def on_disk() -> int:
        try:
            return read(folder, whole).samples
        except DataError:  # none yet
            return 0

    started = process("msd_ident.ros.recorder", autostart="true", bag_folder=tmp_path, folder="rig")
    with started as node, process("msd_sim.node", rate=RATE, **NOISE):
        until(lambda: ros.node.count_subscribers("/encoder") == 2, "the recorder's subscription", 60.0)
        heard.clear()
        until(lambda: len(heard) >= 100, "samples", 60.0)
        node.send_signal(signal.SIGSTOP)
        time.sleep(HELD)  # by the clock: the rig publishes by the clock, whatever reaches this process
        node.send_signal(signal.SIGCONT)
        missed = round(0.9 * RATE * HELD)
        # On a busy machine the recorder takes a while to catch up; what it has is on the disk within a second.
        until(lambda: on_disk() >= missed + 100, "what it missed on the disk", 60.0)
        node.send_signal(signal.SIGINT)
        assert ", none lost, in " in node.communicate(timeout=30.0)[1]
    record = read(folder, whole)
    assert record.samples >= missed + 100 and quality.missing_samples(record) == 0


@pytest.mark.parametrize("late", [False, True])
def test_numbers_of_two_publishers_tell_of_no_loss(ros: Graph, tmp_path: Path, late: bool) -> None:
    """Each numbers its own messages: 2882 were told as lost where none was."""
    first = ros.node.create_publisher(Float64, "level", 10)
    for _ in range(50):
        first.publish(Float64())
    second = None if late else ros.node.create_publisher(Float64, "level", 10)
    node = recorder(ros, tmp_path, autostart=True, folder="two", topics=["/level"])
    until(lambda: ros.node.count_subscribers("/level") == 1, "the recorder")
    second = second or ros.node.create_publisher(Float64, "level", 10)
    until(lambda: second.get_subscription_count() == 1, "the recorder, for the second one too")
    for turn in range(20):
        (first if turn % 2 else second).publish(Float64(data=float(turn)))
        until(lambda turn=turn: node.summary and node.summary.messages > turn, "the message")
    assert "20 messages of 1 topic, none lost" in ros.call(Trigger, STOP, Trigger.Request()).message
