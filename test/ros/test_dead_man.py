"""No force acts for longer than somebody stands behind it; one held on purpose is known to whoever comes later."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.event_handler import PublisherEventCallbacks  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.publisher import Publisher  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from msd_ident.design import Profile, Segment  # noqa: E402
from msd_ident.design.profile_file import to_yaml  # noqa: E402
from msd_ident.io import read  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.node_runner import Spinner  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402
from msd_interfaces.action import RunExperiment  # noqa: E402
from msd_sim.node.rig_node import RigNode  # noqa: E402

#: Force [N], and where the cart of the ECP rig then rests [m].
FORCE, DEFLECTION = 5.0, 5.0 / 694.1


class Lab:
    """A rig, and what an observer hears of its cart and of the force."""

    def __init__(self, domain: int, **parameters: object) -> None:
        self._graph = graph(domain)
        self.ros: Graph = self._graph.__enter__()
        given = [Parameter(name, value=value) for name, value in {"rate": 200.0, **parameters}.items()]
        self.rig = RigNode(context=self.ros.context, parameter_overrides=given)
        self.ros.spin(self.rig)
        self.position = 0.0
        self.forces: list[float] = []
        self.ros.node.create_subscription(JointState, names.ENCODER, self._on_encoder, 1000)
        self.ros.node.create_subscription(WrenchStamped, names.FORCE, self._on_force, 1000)

    def close(self) -> None:
        for spinner in self.ros._spinners:
            spinner.stop()
        self.rig.destroy_node()
        self._graph.__exit__(None, None, None)

    def _on_encoder(self, message: JointState) -> None:
        self.position = message.position[0]

    def _on_force(self, message: WrenchStamped) -> None:
        self.forces.append(message.wrench.force.x)

    def pushed(self, seconds: float = 20.0) -> None:
        until(lambda: self.position > 0.5 * DEFLECTION, "the cart to be pushed", seconds)

    def released(self, seconds: float) -> None:
        """The force is 0, and everybody who listens has been told."""
        until(lambda: not self.rig._rig.pushed, "the force to be 0", seconds)
        until(lambda: self.forces and self.forces[-1] == 0.0, "the force of 0 to be told", 2.0)


@pytest.fixture
def lab(ros_domain: int) -> Iterator[Lab]:
    made = Lab(ros_domain)
    yield made
    made.close()


@pytest.fixture
def holding(ros_domain: int) -> Iterator[Lab]:
    # A cart that has come to rest is read too: with noise its readings still change, as those of any encoder.
    made = Lab(ros_domain, hold_last_command=True, **{"encoder.noise": 1e-5})
    yield made
    made.close()


@contextmanager
def stranger(lab: Lab) -> Iterator[Node]:
    """A node of somebody else: a participant of its own, that can go."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=lab.ros.context.get_domain_id())
    node = Node("stranger", context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


def publish(node: Node, newtons: float, qos: QoSProfile | int = 10) -> Publisher:
    """Command a force once, as ``ros2 topic pub --once`` does."""
    publisher = node.create_publisher(WrenchStamped, names.FORCE, qos)
    until(lambda: publisher.get_subscription_count() >= 2, "the rig to listen")
    message = WrenchStamped()
    message.header.stamp = node.get_clock().now().to_msg()
    message.wrench.force.x = newtons
    publisher.publish(message)
    return publisher


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT])
def test_a_publisher_with_default_qos_moves_the_rig(holding: Lab, reliability: ReliabilityPolicy) -> None:
    with stranger(holding) as node:
        publisher = node.create_publisher(WrenchStamped, names.FORCE, QoSProfile(depth=10, reliability=reliability))
        message = WrenchStamped()
        message.wrench.force.x = FORCE
        node.create_timer(0.05, lambda: None)

        def moved() -> bool:
            publisher.publish(message)
            return holding.position > 0.5 * DEFLECTION

        until(moved, "the cart to be pushed", 20.0)


def test_who_is_silent_lets_go(lab: Lab) -> None:
    with stranger(lab) as node:
        publish(node, FORCE)
        lab.pushed()
        lab.released(3.0)


def test_a_plain_publisher_is_not_warned_of_qos(lab: Lab) -> None:
    """It would read that nothing is sent, while its force acts."""
    with stranger(lab) as node:
        warned: list[object] = []
        until(lambda: lab.rig._commands._latched is None, "the rig to have asked for older commands", 10.0)
        callbacks = PublisherEventCallbacks(incompatible_qos=warned.append)
        publisher = node.create_publisher(WrenchStamped, names.FORCE, 10, event_callbacks=callbacks)
        spinner = Spinner(node)
        message = WrenchStamped()
        message.wrench.force.x = FORCE

        def moved() -> bool:
            publisher.publish(message)
            return lab.position > 0.5 * DEFLECTION

        until(moved, "the cart to be pushed", 20.0)
        assert warned == []
        spinner.stop()


def test_the_rig_does_not_warn_of_its_own_qos(lab: Lab, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lab would read that no message is received from `ros2 topic pub -r 10`, while its force acts."""
    said: list[str] = []
    monkeypatch.setattr(type(lab.rig.get_logger()), "warning", lambda self, text, **given: said.append(text))
    monkeypatch.setattr(type(lab.rig.get_logger()), "warn", lambda self, text, **given: said.append(text))
    with stranger(lab) as node:
        publish(node, FORCE)
        lab.pushed()
        lab.released(3.0)
        publish(node, FORCE, names.command_qos())
        until(lambda: lab.rig._commands._guard is not None, "the rig to listen for signs of life", 5.0)
        lab.released(3.0)
    assert said and not any("incompatible QoS" in text for text in said)


def test_who_is_gone_lets_go(ros_domain: int) -> None:
    lab = Lab(ros_domain, command_timeout=1e6)
    try:
        with stranger(lab) as node:
            publish(node, FORCE)
            lab.pushed()
        lab.released(3.0)
    finally:
        lab.close()


def test_who_shows_no_life_lets_go_and_who_does_holds(ros_domain: int) -> None:
    lab = Lab(ros_domain, command_timeout=1e6)
    try:
        with stranger(lab) as node:
            publisher = publish(node, FORCE, names.command_qos())
            lab.pushed()
            begin = lab.rig.get_clock().now().nanoseconds

            def held() -> bool:
                publisher.assert_liveliness()
                assert lab.rig._rig.pushed
                return lab.rig.get_clock().now().nanoseconds - begin > 2.5e9

            until(held, "two and a half leases")
            lab.released(3.0)
    finally:
        lab.close()


def test_a_killed_experimenter_leaves_no_force(lab: Lab, tmp_path: Path) -> None:
    arguments = ["--ros-args", "-p", f"bag_folder:={tmp_path}"]
    process = subprocess.Popen([sys.executable, "-m", "msd_ident.ros.experimenter", *arguments])
    try:
        profile = to_yaml(Profile((Segment("step", 60.0, force=FORCE),), "long"))
        goal = RunExperiment.Goal(profile=profile, limits="{force: 10, travel: 0.05, duration: 90}")
        lab.ros.goal(RunExperiment, names.RUN, goal)
        lab.pushed(60.0)
        until(lambda: lab.position > 0.9 * DEFLECTION, "the cart to be where the force holds it")
        process.send_signal(signal.SIGKILL)
        process.wait()
        lab.released(3.0)
        until(lambda: abs(lab.position) < 0.1 * DEFLECTION, "the cart to come back", 5.0)
    finally:
        process.kill()


KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.mark.parametrize("stays", [True, False], ids=["sender stays", "sender leaves"])
@pytest.mark.parametrize("qos", [KEPT, QoSProfile(depth=10)], ids=["latched", "default QoS"])
def test_a_bag_knows_the_force_that_acts(holding: Lab, tmp_path: Path, qos: QoSProfile, stays: bool) -> None:
    """The force was sent before the recording began, by somebody who may be gone."""
    ros = holding.ros
    with stranger(holding) as node:
        publish(node, FORCE, qos)
        holding.pushed()
        if stays:
            recorded(ros, tmp_path)
    if not stays:
        until(lambda: holding.rig._commands._announced is not None, "the rig to take the command over")
        recorded(ros, tmp_path)
    record = read(tmp_path / "bag")
    assert set(record.force) == {FORCE}


def recorded(ros: Graph, folder: Path) -> None:
    """Record a second of the graph, with a recorder that comes now."""
    given = [Parameter("bag_folder", value=str(folder)), Parameter("folder", value="bag")]
    recorder = ros.add(Recorder(given, context=ros.context))
    recorder.node.executor.create_task(recorder.start, "bag")
    until(lambda: recorder.summary, "the recording to begin")
    until(
        lambda: recorder.summary.topics.get("/encoder") and recorder.summary.topics["/encoder"].received > 200,
        "samples",
    )
    recorder.node.executor.create_task(recorder.stop)
    until(lambda: recorder._recording is None, "the bag to be closed")
