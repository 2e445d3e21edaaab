"""The paper's experiment on a running graph: it waits for the rig itself."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.node import Node  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.experimenter.paper_experiment import Player  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def other(ros: Graph, name: str) -> Node:
    node = Node(name, context=ros.context)
    ros.spin(node)
    return node


def test_it_waits_for_a_rig_that_listens_and_not_for_any_listener(ros: Graph) -> None:
    player = Player(ros.node, lambda: None)
    listener, rig = other(ros, "recorder"), other(ros, "rig")
    listener.create_subscription(WrenchStamped, names.FORCE, lambda message: None, names.force_qos())
    rig.create_publisher(JointState, names.ENCODER, names.encoder_qos())
    # Commands from before it began; a rig that has this one only hears nothing that is sent from now on.
    rig.create_subscription(WrenchStamped, names.FORCE, lambda message: None, names.force_qos())
    until(lambda: player._force.get_subscription_count() == 2, "both found")
    assert not player._rig_listens()
    rig.create_subscription(WrenchStamped, names.FORCE, lambda message: None, names.encoder_qos())
    until(player._rig_listens, "the rig to listen")
    assert player._force.get_subscription_count() == 3
