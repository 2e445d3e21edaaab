"""Messages into samples, results into messages."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402

from msd_ident.errors import DataError, SetupError, UsageError  # noqa: E402
from msd_ident.io import qos_from_yaml, qos_to_yaml  # noqa: E402
from msd_ident.quantity import Quantity  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import Signal, message_class, nanoseconds, time_message  # noqa: E402
from msd_ident.ros.common.result_messages import to_parameter  # noqa: E402
from msd_interfaces.msg import EncoderBatch  # noqa: E402


def joints(**fields: object) -> JointState:
    message = JointState(name=["shoulder", "elbow"], position=[0.25, 0.5], effort=[1.0, -2.0], **fields)
    message.header.stamp = time_message(1_500_000_000_000_000_001)
    message.header.frame_id = "arm"
    return message


def test_stamps_are_whole_nanoseconds() -> None:
    assert nanoseconds(time_message(1_700_000_000_123_456_789)) == 1_700_000_000_123_456_789


def test_any_field_of_any_topic_is_a_signal() -> None:
    stamp = 1_500_000_000_000_000_001
    signal = Signal("position", "sensor_msgs/msg/JointState", "position[elbow]", scale=-2.0)
    assert signal.sample(joints(), 7) == (stamp, -1.0)
    assert signal.frame == "arm"
    assert Signal("position", "sensor_msgs/msg/JointState").sample(joints(), 7) == (stamp, 0.25)
    assert Signal("force", "sensor_msgs/msg/JointState", "effort[elbow]").sample(joints(), 7) == (stamp, -2.0)
    assert Signal("force", "std_msgs/msg/Float64").sample(Float64(data=3.5), 7) == (7, 3.5)
    wrench = WrenchStamped()
    wrench.wrench.force.x = 10.425
    assert Signal("force", "geometry_msgs/msg/WrenchStamped").sample(wrench, 7) == (7, 10.425), "no stamp: receipt"


def test_a_joint_that_is_not_there_is_counted_and_named() -> None:
    signal = Signal("position", "sensor_msgs/msg/JointState", "position[wrist]")
    assert signal.sample(joints(), 7) is None
    assert signal.problem == "1 messages hold no position[wrist]; the joints are: shoulder, elbow"


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("angle", "field angle is not in the message: no 'angle' there; the fields are: header, name, position"),
        ("position", "field position holds 2 values; expected one: write position"),
        ("header", "field header is a group of fields"),
    ],
)
def test_a_field_that_is_no_number_is_refused_in_words(field: str, words: str) -> None:
    with pytest.raises(DataError, match=words):
        Signal("position", "sensor_msgs/msg/JointState", field).sample(joints(), 7)


def test_nonsense_is_refused_when_the_signal_is_made() -> None:
    with pytest.raises(DataError, match="force topic is of type std_msgs/msg/String; expected to be told which field"):
        Signal("force", "std_msgs/msg/String")
    with pytest.raises(UsageError, match="cannot be read; expected something like wrench.force.x"):
        Signal("force", "std_msgs/msg/Float64", "a b")
    with pytest.raises(SetupError, match="message type nobody_msgs/msg/Thing is not installed"):
        message_class("nobody_msgs/msg/Thing")
    with pytest.raises(SetupError, match="message type nonsense is not installed"):
        message_class("nonsense")


def test_a_batch_is_unpacked_and_its_losses_are_counted() -> None:
    signal = Signal("position", "msd_interfaces/msg/EncoderBatch", scale=2.0)
    message = EncoderBatch(period_ns=100_000, sequence=10, positions=[1.0, 2.0, 3.0])
    message.header.stamp = time_message(5_000_000_000)
    ns, values = signal.batch(message, 7)
    assert ns.tolist() == [5_000_000_000, 5_000_100_000, 5_000_200_000] and values.tolist() == [2.0, 4.0, 6.0]
    message.sequence = 20
    signal.batch(message, 7)
    assert signal.missing == 7 and signal.problem == ""


def test_an_open_parameter_has_no_interval() -> None:
    known = to_parameter("mass", Quantity(2.0, 0.1, "kg"), {"mass": "m"})
    assert (known.symbol, known.value, known.unit) == ("m", 2.0, "kg")
    assert np.allclose([known.lower, known.upper], [2.0 - 0.196, 2.0 + 0.196], atol=1e-4)
    left_open = to_parameter("friction", Quantity(0.3, math.nan, "1"), {})
    assert (left_open.symbol, left_open.unit) == ("", "")
    assert math.isnan(left_open.std) and math.isnan(left_open.lower) and math.isnan(left_open.upper)


def test_qos_survives_the_way_into_a_bag_and_back() -> None:
    offered = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)
    back = names.from_offered(qos_from_yaml(qos_to_yaml([names.to_offered(offered)])))
    assert (back.reliability, back.durability) == (offered.reliability, offered.durability)
    assert back.depth == names.REPLAY_DEPTH, "a fast replay loses nothing"
    eager = QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)
    assert names.from_offered((names.to_offered(eager),)).reliability == ReliabilityPolicy.BEST_EFFORT
    assert names.from_offered(()).reliability == ReliabilityPolicy.RELIABLE


def test_a_subscription_asks_for_no_more_than_all_publishers_offer() -> None:
    lasting = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    eager = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    one = names.matching_qos([lasting], 2000)
    assert (one.durability, one.reliability, one.depth) == (
        DurabilityPolicy.TRANSIENT_LOCAL,
        ReliabilityPolicy.RELIABLE,
        2000,
    )
    both = names.matching_qos([lasting, eager], 2000)
    assert (both.durability, both.reliability) == (DurabilityPolicy.VOLATILE, ReliabilityPolicy.BEST_EFFORT)
