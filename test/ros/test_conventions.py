"""ROS's conventions: names that follow their node, two rigs that stay two, NaN and codes of failures, 2 for 2.0."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.action import get_action_names_and_types  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.parameters import overrides  # noqa: E402
from msd_ident.ros.experimenter.node import Experimenter  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402
from msd_interfaces.action import Diagnose, RunExperiment  # noqa: E402
from msd_interfaces.msg import EncoderBatch, ResultCode  # noqa: E402
from msd_interfaces.srv import Identify, StartRecording  # noqa: E402
from msd_sim.node.rig_node import RigNode  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def renamed(name: str, namespace: str) -> dict[str, Any]:
    """Options of a node under another name in a namespace."""
    return {"cli_args": ["--ros-args", "-r", f"__node:={name}", "-r", f"__ns:=/{namespace}"]}


def test_services_and_actions_follow_the_node(ros: Graph, tmp_path: Path) -> None:
    given = overrides({"bag_folder": str(tmp_path)})
    for kind, name in ((Identifier, "one"), (Recorder, "two"), (Experimenter, "three")):
        ros.add(kind(given, context=ros.context, **renamed(name, "lab")))
    rig = RigNode(context=ros.context, **renamed("four", "lab"))
    wanted = {"/lab/one/identify", "/lab/one/trigger", "/lab/one/clear", "/lab/two/start", "/lab/two/stop"}
    wanted |= {"/lab/four/reset"}
    until(lambda: wanted <= {name for name, _ in ros.node.get_service_names_and_types()}, "the services")
    actions = {"/lab/one/diagnose", "/lab/three/run"}
    until(lambda: actions <= {name for name, _ in get_action_names_and_types(ros.node)}, "the actions")
    until(
        lambda: ros.node.count_publishers("/lab/one/estimate") and ros.node.count_publishers("/lab/one/diagnosis"),
        "topics",
    )
    rig.destroy_node()


def test_two_rigs_stay_two_on_diagnostics(ros: Graph, tmp_path: Path) -> None:
    given = {"bag_folder": str(tmp_path), "diagnostics_period": 0.1}
    found: dict[str, DiagnosticStatus] = {}
    ros.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda array: found.update({one.name: one for one in array.status}), 100
    )
    for place, more in (("left", {}), ("right", {"hardware_id": "ECP 210 no. 7"})):
        for kind in (Identifier, Recorder):
            ros.add(kind(overrides({**given, **more}), context=ros.context, namespace=place))
    tasks = ("identifier: data", "identifier: estimate", "identifier: model", "recorder: bag")
    wanted = {f"{place}/{task}" for place in ("left", "right") for task in tasks}
    until(lambda: wanted <= set(found), "all statuses")
    assert set(found) == wanted
    assert {one.hardware_id for name, one in found.items() if name.startswith("left/")} == {"left"}
    assert {one.hardware_id for name, one in found.items() if name.startswith("right/")} == {"ECP 210 no. 7"}


def test_rates_stand_on_diagnostics(ros: Graph) -> None:
    ros.add(Identifier(overrides({"diagnostics_period": 0.1}), context=ros.context))
    found: dict[str, str] = {}

    def heard(array: DiagnosticArray) -> None:
        for status in array.status:
            found.update({pair.key: pair.value for pair in status.values})

    ros.node.create_subscription(DiagnosticArray, "/diagnostics", heard, 100)
    encoder = ros.node.create_publisher(JointState, names.ENCODER, names.encoder_qos())
    message = JointState(name=["cart"], position=[0.0])

    def send() -> None:
        message.header.stamp = ros.node.get_clock().now().to_msg()
        encoder.publish(message)

    ros.within(lambda: ros.node.create_timer(0.01, send))
    until(lambda: 50.0 < float(found.get("/encoder: rate [Hz]", 0.0)) < 200.0, "a rate of about 100 Hz")


def test_a_failure_has_a_code_and_no_number(ros: Graph, tmp_path: Path) -> None:
    given = overrides({"bag_folder": str(tmp_path)})
    for kind in (Identifier, Recorder, Experimenter):
        ros.add(kind(given, context=ros.context))
    (tmp_path / "bad.csv").write_text("time_s,force_n,position_m\n0,1,2\n")
    for request, code in (
        (Identify.Request(), 2),
        (Identify.Request(bag_path="../x"), 1),
        (Identify.Request(bag_path="bad.csv"), 2),
    ):
        answer = ros.call(Identify, names.IDENTIFY, request)
        assert not answer.success and answer.code == code
        assert math.isnan(answer.estimate.mass.value) and math.isnan(answer.estimate.see_refined)
        assert math.isnan(answer.estimate.natural_frequency.std)
    assert (
        ros.call(StartRecording, names.RECORDER_START, StartRecording.Request(folder="..")).code
        == ResultCode.BAD_REQUEST
    )
    started = ros.call(StartRecording, names.RECORDER_START, StartRecording.Request())
    assert started.success and started.code == ResultCode.DONE
    _, future = ros.goal(Diagnose, names.DIAGNOSE, Diagnose.Goal(bag_paths=["bad.csv"]))
    until(future.done, "the diagnosis")
    result = future.result().result
    assert result.code == ResultCode.BAD_DATA and math.isnan(result.diagnoses[0].base_see)
    _, future = ros.goal(RunExperiment, names.RUN, RunExperiment.Goal(profile="x", limits="y"))
    until(future.done, "the experiment")
    assert future.result().result.code == ResultCode.BAD_REQUEST


@pytest.mark.parametrize("rate", [100.0, 4000.0])
def test_the_encoder_has_the_frame_of_the_parameter(ros: Graph, rate: float) -> None:
    given = {"rate": rate, "frame_id": "rail"}
    rig = RigNode(context=ros.context, parameter_overrides=[Parameter(name, value=v) for name, v in given.items()])
    spinner = ros.spin(rig)
    frames: set[str] = set()
    kind, topic = (JointState, names.ENCODER) if rate < 2000.0 else (EncoderBatch, names.ENCODER_BATCH)
    ros.node.create_subscription(kind, topic, lambda message: frames.add(message.header.frame_id), 1000)
    until(lambda: frames, "a message")
    assert frames == {"rail"}
    spinner.stop()
    rig.destroy_node()


def test_a_whole_number_is_as_good_as_one_with_a_point(ros: Graph) -> None:
    node = ros.add(Identifier(overrides({"settle_time": 2}), context=ros.context))
    assert node.settings["settle_time"] == 2.0 and isinstance(node.settings["settle_time"], float)
    (done,) = node.node.set_parameters([Parameter("settle_time", value=3)])
    assert done.successful and node.settings["settle_time"] == 3.0
    for value, words in ((0, "settle_time is 0; expected 0.05 to 60"), ("x", "settle_time is 'x'; expected a number")):
        (done,) = node.node.set_parameters([Parameter("settle_time", value=value)])
        assert not done.successful and done.reason == words


def test_the_live_buffer_can_be_cleared(ros: Graph) -> None:
    node = ros.add(Identifier(overrides({"auto_fit": False}), context=ros.context))
    encoder = ros.node.create_publisher(JointState, names.ENCODER, names.encoder_qos())
    until(encoder.get_subscription_count, "somebody who listens")
    for index in range(10):
        message = JointState(name=["cart"], position=[0.001 * index])
        message.header.stamp.sec = 1_700_000_000
        message.header.stamp.nanosec = index * 10_000_000
        encoder.publish(message)
    until(lambda: node.buffer.position.size == 10, "the samples")
    answer = ros.call(Trigger, names.CLEAR, Trigger.Request())
    assert answer.success and answer.message == "10 position samples deleted; the live buffer is empty"
    assert node.buffer.position.size == node.buffer.force.size == 0
