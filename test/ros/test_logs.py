"""What goes wrong a thousand times is said a few times; two publishers of the encoder are called that."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rcl_interfaces.msg import Log  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import time_message  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_interfaces.srv import Identify  # noqa: E402
from msd_sim.node.rig_node import RigNode  # noqa: E402


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


@pytest.fixture
def said(ros: Graph) -> list[str]:
    """Everything that nodes log."""
    heard: list[str] = []
    ros.node.create_subscription(Log, "/rosout", lambda log: heard.append(log.msg), 10_000)
    return heard


def test_a_rig_that_gets_nonsense_says_so_once_in_a_while(ros: Graph, said: list[str]) -> None:
    rig = RigNode(context=ros.context, parameter_overrides=[Parameter("rate", value=100.0)])
    spinner = ros.spin(rig)
    taken: list[float] = []
    push = rig._rig.push
    rig._rig.push = lambda at, force: (taken.append(force), push(at, force))[1]
    force = ros.node.create_publisher(WrenchStamped, names.FORCE, names.force_qos())
    until(lambda: force.get_subscription_count() >= 2, "the rig to listen")
    message = WrenchStamped()
    message.wrench.force.x = math.nan
    for _ in range(500):
        force.publish(message)
    until(lambda: len(taken) >= 500, "the rig to take them")
    until(lambda: any("force refused" in line for line in said), "the log")
    assert sum("force refused" in line for line in said) <= 3
    spinner.stop()
    rig.destroy_node()


def test_a_rig_that_runs_away_says_so_once_in_a_while(ros: Graph, said: list[str]) -> None:
    given = {"rate": 500.0, "damping": 0.0, "effects": ["cubic_spring"], "cubic_spring.cubic_stiffness": -1e9}
    rig = RigNode(
        context=ros.context, parameter_overrides=[Parameter(name, value=value) for name, value in given.items()]
    )
    spinner = ros.spin(rig)
    resets: list[int] = []
    reset = rig._reset
    rig._reset = lambda: (resets.append(1), reset())[1]
    force = ros.node.create_publisher(WrenchStamped, names.FORCE, names.force_qos())
    until(lambda: force.get_subscription_count() >= 2, "the rig to listen")
    message = WrenchStamped()
    message.wrench.force.x = 1e6

    def often() -> bool:
        force.publish(message)
        return len(resets) > 20

    until(often, "the rig to run away many times")
    assert 1 <= sum("is put back to zero" in line for line in said) <= 1 + len(resets) // 20 + 3
    spinner.stop()
    rig.destroy_node()


def test_two_publishers_of_the_encoder_are_called_that(ros: Graph) -> None:
    """Their stamps run backwards; nobody looped a recording."""
    node = ros.add(Identifier([Parameter("auto_fit", value=False)], context=ros.context))
    pair = [ros.node.create_publisher(JointState, names.ENCODER, names.encoder_qos()) for _ in range(2)]
    until(lambda: all(one.get_subscription_count() for one in pair), "somebody who listens")
    until(lambda: node.inputs["position"][0].publishers == 2, "both to be seen")
    for index in range(400):
        for which, publisher in enumerate(pair):
            at = 1_700_000_000_000_000_000 + index * 10_000_000 - which * 300_000_000
            message = JointState(name=["cart"], position=[0.01 * float(np.sin(0.1 * index)) + which])
            message.header.stamp = time_message(at)
            publisher.publish(message)
    until(lambda: node.buffer.counts.positions == 800, "the samples")
    answer = ros.call(Identify, names.IDENTIFY, Identify.Request())
    words = answer.message + " ".join(answer.estimate.warnings)
    assert "/encoder: 2 publishers; expected one" in words and "looped" not in words
