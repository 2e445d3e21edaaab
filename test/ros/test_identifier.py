"""The identifier node: fits by itself and when asked, any topic, health, refusals in words."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import START_NS  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rcl_interfaces.msg import Log  # noqa: E402
from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.publisher import Publisher  # noqa: E402
from rclpy.qos import QoSProfile, ReliabilityPolicy  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

import msd_sim.api  # noqa: E402
from msd_ident.errors import UsageError  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import time_message  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_interfaces.msg import Estimate  # noqa: E402
from msd_interfaces.srv import Identify  # noqa: E402

RATE = 200.0


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def identifier(ros: Graph, **parameters: object) -> Identifier:
    made: Identifier = ros.add(
        Identifier([Parameter(name, value=value) for name, value in parameters.items()], context=ros.context)
    )
    return made


class Robot:
    """Publishes what a rig with a force step of 10.425 N up and down gives, on any topics."""

    def __init__(self, ros: Graph, topic: str = "encoder", joint: str = "cart", qos: QoSProfile | None = None) -> None:
        made = msd_sim.api.simulate({"rig": "ecp", "experiment": "paper", "rate": RATE})
        self.time, self.position = made.time, made.position
        self.steps = list(zip(made.force_time, made.force, strict=True))
        self.joint = joint
        self.force: Publisher = ros.node.create_publisher(WrenchStamped, "force", names.force_qos())
        self.encoder: Publisher = ros.node.create_publisher(JointState, topic, qos or names.encoder_qos())

    def match(self) -> None:
        until(self.force.get_subscription_count, "somebody who listens to the force")
        until(self.encoder.get_subscription_count, "somebody who listens to the encoder")

    def push(self, seconds: float, newtons: float) -> None:
        message = WrenchStamped()
        message.header.stamp = time_message(START_NS + round(seconds * 1e9))
        message.wrench.force.x = newtons
        self.force.publish(message)

    def send(self, first: int = 0, last: int | None = None) -> None:
        for at, value in zip(self.time[first:last].tolist(), self.position[first:last].tolist(), strict=True):
            message = JointState(name=["other", self.joint], position=[7.0, value])
            if self.joint == "cart":
                message = JointState(name=["cart"], position=[value])
            message.header.stamp = time_message(START_NS + round(at * 1e9))
            self.encoder.publish(message)

    def play(self) -> None:
        """A force at rest first, then the experiment."""
        self.match()
        self.push(-0.1, 0.0)
        for at, value in self.steps:
            self.push(at, value)
        self.send()


def test_a_settled_step_is_fitted_by_itself_and_late_comers_get_the_estimate(ros: Graph) -> None:
    node = identifier(ros, settle_time=0.2)
    robot = Robot(ros)
    robot.play()
    estimates: list[Estimate] = []
    until(lambda: node.buffer.counts.positions == robot.time.size, "all samples")
    until(lambda: node._last.estimate, "the fit")
    ros.node.create_subscription(Estimate, "identifier/estimate", estimates.append, names.latest_qos())
    until(lambda: estimates, "the estimate")
    refined = {parameter.name: parameter for parameter in estimates[-1].refined}
    for name, truth in (("mass", 0.9407), ("damping", 3.927), ("stiffness", 694.1)):
        assert refined[name].lower < refined[name].value < refined[name].upper
        assert abs(refined[name].value / truth - 1) < 0.01
    assert refined["mass"].unit == "kg" and refined["coulomb_force"].symbol == "Fc"
    assert estimates[-1].source == "live" and estimates[-1].missing_samples == 0


def test_trigger_does_the_same_as_identify_for_clients_without_our_types(ros: Graph) -> None:
    node = identifier(ros, auto_fit=False)
    robot = Robot(ros)
    robot.play()
    until(lambda: node.buffer.counts.positions == robot.time.size, "all samples")
    asked = ros.call(Identify, "identifier/identify", Identify.Request())
    triggered = ros.call(Trigger, "identifier/trigger", Trigger.Request())
    assert asked.success and triggered.success
    assert triggered.message == asked.message
    assert triggered.message.startswith("m = 0.9407 kg, b = 3.9") and "SEE" in triggered.message
    assert triggered.message.endswith(f"from {robot.time.size} samples of live")


def test_any_joint_of_a_robot_with_eager_qos(ros: Graph) -> None:
    node = identifier(ros, auto_fit=False, position="/joint_states:position[elbow]", position_scale=-1.0)
    robot = Robot(ros, "/joint_states", "elbow", QoSProfile(depth=2000, reliability=ReliabilityPolicy.BEST_EFFORT))
    robot.match()
    robot.push(0.0, 1.0)
    robot.send(0, 100)
    until(lambda: node.buffer.counts.positions == 100, "the samples")
    record = node.buffer.record()
    assert np.array_equal(record.position, -robot.position[:100])


def test_a_joint_that_is_not_there_is_said_on_diagnostics(ros: Graph) -> None:
    heard: list[DiagnosticStatus] = []
    ros.node.create_subscription(DiagnosticArray, "/diagnostics", lambda m: heard.extend(m.status), 10)
    identifier(ros, position="encoder:position[wrist]", diagnostics_period=0.05)
    until(lambda: heard, "diagnostics")
    assert heard[0].level == DiagnosticStatus.ERROR
    assert heard[0].message == "no position samples; expected some on /encoder"
    robot = Robot(ros)
    robot.match()
    robot.send(0, 3)
    words = "3 messages hold no position[wrist]; the joints are: cart"
    until(lambda: any(status.message == words for status in heard), "the words")


def test_a_field_that_the_type_has_not_is_said_on_diagnostics_and_the_node_lives(ros: Graph) -> None:
    heard: list[DiagnosticStatus] = []
    ros.node.create_subscription(DiagnosticArray, "/diagnostics", lambda m: heard.extend(m.status), 10)
    identifier(ros, position="encoder:angle", diagnostics_period=0.05)
    robot = Robot(ros)
    robot.match()
    robot.send(0, 3)
    words = "/encoder: field angle is not in the message: no 'angle' there; the fields are: header, name"
    until(lambda: any(words in status.message for status in heard), "the words")
    answer = ros.call(Trigger, "identifier/trigger", Trigger.Request())
    assert not answer.success and answer.message.startswith("no position samples; expected at least one")


def test_diagnostics_turn_from_error_over_warning_to_ok(ros: Graph) -> None:
    data: list[DiagnosticStatus] = []
    ros.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda m: data.extend(s for s in m.status if "data" in s.name), 10
    )
    identifier(ros, diagnostics_period=0.1, auto_fit=False)
    until(lambda: data and data[-1].level == DiagnosticStatus.ERROR, "an error without an encoder")
    robot = Robot(ros)
    robot.match()
    # The encoder goes on in real time, few samples a second, for as long as it takes.
    robot.position = np.pad(robot.position[:1], (0, 20_000), mode="edge")
    robot.time = np.arange(robot.position.size) / 50.0
    began, sent = time.monotonic(), 0

    def goes_on(level: bytes) -> bool:
        nonlocal sent
        due = int((time.monotonic() - began) * 50.0)
        robot.send(sent, due)
        sent = due
        return data[-1].level == level

    def pushed() -> bool:
        if goes_on(DiagnosticStatus.OK):
            return True
        if robot.time[sent] > due[-1] + 1.0:  # one that was held up for seconds is a warning of its own, told for 10 s
            due.append(float(robot.time[sent]))
            robot.push(due[-1], 1.0)
        return False

    due = [-math.inf]
    until(lambda: goes_on(DiagnosticStatus.WARN), "a warning without a force", 60.0)
    assert "no force samples yet" in data[-1].message
    assert DiagnosticStatus.OK not in [status.level for status in data]
    until(pushed, "all well", 60.0)
    assert data[-1].message.endswith("force samples")


def test_a_fit_never_blocks_the_subscription(ros: Graph) -> None:
    node = identifier(ros, auto_fit=False)
    robot = Robot(ros)
    robot.match()
    robot.push(0.0, 1.0)
    fitting, go_on = threading.Event(), threading.Event()
    node.worker.submit(lambda: (fitting.set(), go_on.wait(60.0)))
    try:
        until(fitting.is_set, "the work to begin", 60.0)
        client = ros.node.create_client(Trigger, "identifier/trigger")
        assert client.wait_for_service(20.0)
        answer = client.call_async(Trigger.Request())
        robot.send()
        until(lambda: node.buffer.counts.positions == robot.time.size, "all samples while the fit lasts")
        assert not answer.done(), "the service waits for the work before it"
    finally:
        go_on.set()
    until(answer.done, "the answer")


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (Identify.Request(bag_path="/nowhere"), "/nowhere is not below"),
        (Identify.Request(bag_path="nowhere"), "nowhere does not exist; expected a bag folder"),
        (Identify.Request(start=3.0, end=2.0), "the window from 3 s to 2 s is empty; expected start before end"),
        (Identify.Request(model="magic"), "model is 'magic'; expected one of auto, spring, no_spring"),
        (Identify.Request(), "no position samples; expected at least one"),
    ],
    ids=["elsewhere", "nowhere", "window", "model", "empty"],
)
def test_what_cannot_be_done_is_answered_in_words(ros: Graph, request_: Identify.Request, words: str) -> None:
    identifier(ros)
    answer = ros.call(Identify, "identifier/identify", request_)
    assert not answer.success and words in answer.message and "\n" not in answer.message


def test_a_directory_that_is_no_bag_is_answered_in_words(ros: Graph, tmp_path: Path) -> None:
    folder = tmp_path / "empty"
    folder.mkdir()
    identifier(ros, bag_folder=str(tmp_path))
    answer = ros.call(Identify, "identifier/identify", Identify.Request(bag_path=str(folder)))
    assert answer.message == f"{folder} holds no .mcap or .db3 file; expected a rosbag2 folder: check the path"


def test_a_force_in_another_unit_is_converted_as_on_the_command_line(ros: Graph) -> None:
    node = identifier(ros, force_unit="kN", position_scale=0.5)
    robot = Robot(ros)
    robot.match()
    robot.push(0.0, 0.010425)
    robot.send(0, 60)
    until(lambda: node.buffer.force.size and node.buffer.position.size == 60, "the samples")
    record = node.buffer.record()
    assert record.force.tolist() == [pytest.approx(10.425)] and record.force_unit == "N"
    np.testing.assert_array_equal(record.position, 0.5 * robot.position[:60])


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"force_unit": "kN", "force_scale": 1000.0}, "both convert kN to N; expected one of them"),
        ({"hold": "cubic"}, "hold is 'cubic'; expected one of zero, linear"),
        ({"model": "x"}, "model is 'x'; expected one of auto, spring, no_spring"),
        ({"position_unit": "km"}, "position_unit is 'km'; expected one of m, rad, count"),
        ({"force_scale": 0.0}, "force scale is 0.0; expected a finite number other than 0"),
        ({"settle_time": -1.0}, "settle_time is -1.0; expected 0.05 to 60"),
        ({"settle_time": float("nan")}, "settle_time is nan; expected 0.05 to 60"),
        ({"buffer_samples": 3}, "buffer_samples is 3; expected 100 to 1e"),
        ({"queue_depth": 10}, "queue_depth is 10; expected 1000 to 1e"),
        ({"auto_fit": "perhaps"}, "auto_fit is 'perhaps'; expected true or false"),
        (
            {"force": "/x y:z"},
            "force is '/x y:z': topic name must not contain characters other than alphanumerics, '_', '~', '{', or "
            "'}'; expected TOPIC:FIELD such as /joint_states:position[elbow]",
        ),
        ({"position": "/x//y"}, "position is '/x//y': topic name must not contain repeated '/'; expected TOPIC:FIELD"),
        ({"position": "{x}"}, "position is '{x}': "),
        (
            {"temperature": "a b", "history_file": "kept.json"},
            "temperature is 'a b': topic name must not contain characters other than alphanumerics, '_', '~', '{', or "
            "'}'; expected a topic's name such as /motor/temperature",
        ),
        ({"force": "force:a b"}, "field 'a b' cannot be read; expected something like wrench.force.x"),
    ],
    ids=lambda value: "" if isinstance(value, str) else next(iter(value)),
)
def test_nonsense_at_the_start_is_refused_in_words(
    ros: Graph, parameters: dict[str, object], words: str, tmp_path: Path
) -> None:
    with pytest.raises(UsageError) as refused:
        identifier(ros, **{"bag_folder": str(tmp_path), **parameters})
    assert words in str(refused.value)


def test_a_parameter_that_the_node_has_not_is_named(ros: Graph) -> None:
    said: list[str] = []
    ros.node.create_subscription(Log, "/rosout", lambda log: said.append(log.msg), 10_000)
    identifier(ros, settle_tme=1.0, use_sim_time=False)
    until(lambda: bool(said), "the warning")
    assert said[0] == (
        "there is no parameter settle_tme; expected one of this node's, such as settle_time: check the spelling, or "
        "list them with: ros2 param list /identifier"
    )
    assert not any("use_sim_time" in line for line in said)


def test_nonsense_later_is_refused_in_words_and_sense_is_taken(ros: Graph) -> None:
    node = identifier(ros)

    def set_one(name: str, value: object) -> tuple[bool, str]:
        request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        result = ros.call(SetParameters, "identifier/set_parameters", request).results[0]
        return result.successful, result.reason

    assert set_one("model", "magic") == (False, "model is 'magic'; expected one of auto, spring, no_spring")
    assert not set_one("settle_band", 2.0)[0]
    assert not set_one("hold", "linear")[0], "read only"
    assert set_one("auto_fit", False) == (True, "")
    assert node.settings["auto_fit"] is False and node.settings["model"] == "auto"
