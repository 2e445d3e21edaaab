"""The replayer: the same bytes, in order, with the recorded QoS; clock, loop, refusals in words."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import BATCH, JOINTS, START_NS, WRENCH, joints, stamps, wrench  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from msd_ident.errors import DataError, MsdError, SetupError, UsageError  # noqa: E402
from msd_ident.io import BagWriter, OfferedQos, RawMessage, qos_to_yaml  # noqa: E402
from msd_ident.ros.replayer.node import Replayer  # noqa: E402
from msd_ident.ros.replayer.schedule import ReplayRate, Tick, with_ticks  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Half a second of two topics at 200 Hz."""
    ns = stamps(100, 5_000_000)
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/force", WRENCH, qos_to_yaml([OfferedQos(durability="transient_local", depth=1)]))
        writer.add_topic("/encoder", JOINTS, qos_to_yaml([OfferedQos(depth=7)]))
        writer.write("/force", wrench(ns[0], 1.5), ns[0])
        for index, at in enumerate(ns):
            writer.write("/encoder", joints(at, [index * 1e-3]), at)
    return tmp_path / "bag"


def player(ros: Graph, folder: Path, **parameters: object) -> Replayer:
    given = {"bag": str(folder), "wait": 20.0, **parameters}
    return Replayer([Parameter(name, value=value) for name, value in given.items()], context=ros.context)


def test_the_recorded_bytes_come_in_order_with_the_recorded_qos(ros: Graph, folder: Path) -> None:
    heard: list[bytes] = []
    forces: list[bytes] = []
    ros.node.create_subscription(JointState, "encoder", heard.append, 1000, raw=True)
    lasting = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    ros.node.create_subscription(WrenchStamped, "force", forces.append, lasting, raw=True)
    ros.add(player(ros, folder, rate=4.0))
    until(lambda: len(heard) == 100 and len(forces) == 1, "all messages")
    assert heard == [joints(at, [index * 1e-3]) for index, at in enumerate(stamps(100, 5_000_000))]
    assert forces == [wrench(START_NS, 1.5)]


def test_clock_and_loop(ros: Graph, folder: Path) -> None:
    ticks: list[int] = []
    heard: list[bytes] = []
    ros.node.create_subscription(Clock, "/clock", lambda m: ticks.append(m.clock.sec * 10**9 + m.clock.nanosec), 1000)
    ros.node.create_subscription(JointState, "encoder", heard.append, 1000, raw=True)
    node = ros.add(player(ros, folder, rate=20.0, clock=True, loop=True, topics=["encoder"]))
    until(lambda: len(heard) > 250, "the third time through")
    assert set(node._publishers) == {"/encoder"}
    assert heard[100:200] == heard[:100]
    assert min(ticks) >= START_NS and max(ticks) <= START_NS + 500_000_000
    assert sum(later < earlier for earlier, later in zip(ticks, ticks[1:], strict=False)) >= 2, "time starts anew"


def test_the_end_is_told(ros: Graph, folder: Path) -> None:
    ended = threading.Event()
    parameters = [
        Parameter(name, value=value) for name, value in {"bag": str(folder), "rate": 50.0, "wait": 0.0}.items()
    ]
    node = ros.add(Replayer(parameters, on_end=ended.set, context=ros.context))
    until(ended.is_set, "the end")
    assert node.sent == 101 and not node.failure


@pytest.mark.parametrize(
    ("parameters", "kind", "words"),
    [
        ({"bag": ""}, UsageError, "no bag to play; expected the parameter bag"),
        ({"bag": "/nowhere"}, DataError, "/nowhere does not exist"),
        ({"topics": ["odometry"]}, UsageError, "has no topic odometry; there are: /encoder, /force"),
        ({"rate": 0.0}, UsageError, "rate is 0.0; expected 0.01 to 100"),
        ({"rate": float("nan")}, UsageError, "rate is nan; expected 0.01 to 100"),
        ({"rate": "fast"}, UsageError, "rate is 'fast'; expected a number"),
    ],
    ids=["no bag", "nowhere", "topic", "rate", "nan", "word"],
)
def test_what_makes_no_sense_is_refused_in_words(
    ros: Graph, folder: Path, parameters: dict[str, object], kind: type[MsdError], words: str
) -> None:
    with pytest.raises(kind, match=words):
        player(ros, folder, **parameters)


def test_a_bag_whose_types_are_not_here_is_refused_in_words(ros: Graph, tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/x", "nobody_msgs/msg/Thing", definition="float64 x")
        writer.write("/x", b"\x00\x01\x00\x00", 1)
    with pytest.raises(SetupError, match="message type nobody_msgs/msg/Thing is not installed"):
        player(ros, tmp_path / "bag")


def test_an_empty_bag_says_so(ros: Graph, tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/encoder_batch", BATCH)
    node = ros.add(player(ros, tmp_path / "bag", wait=0.0, loop=True))
    until(lambda: node.failure, "the failure")
    assert node.failure.endswith("has no messages to play; expected some")


def test_ticks_lie_between_the_messages() -> None:
    messages = [RawMessage("/x", "t", b"", ns, ns) for ns in (100, 101, 125)]
    order = [(type(entry) is Tick, entry.log_time_ns) for entry in with_ticks(messages, 10)]
    assert order == [(True, 100), (False, 100), (False, 101), (True, 110), (True, 120), (False, 125)]


def test_the_pace_never_runs_ahead_and_stops_at_once() -> None:
    stop = threading.Event()
    pace = ReplayRate(10.0, stop)
    start = time.monotonic()
    for index in range(40):
        assert pace.wait(START_NS + index * 10_000_000)
        assert time.monotonic() - start >= index * 1e-3 - 1e-4
    threading.Timer(0.05, stop.set).start()
    assert not pace.wait(START_NS + 10**13)
