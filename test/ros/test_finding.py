"""Where the graph is, when a user names no namespace."""

from __future__ import annotations

import threading

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import graph  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from msd_ident.errors import UsageError  # noqa: E402
from msd_ident.ros.common.graph_discovery import namespace_of  # noqa: E402


def test_a_rig_that_discovery_finds_late_is_found(ros_domain: int) -> None:
    """The first one found was recorded, and nobody was told of the other."""
    with graph(ros_domain) as ros:
        ros.node.create_publisher(JointState, "/one/encoder", 10)
        later = threading.Timer(2.0, lambda: ros.node.create_publisher(JointState, "/two/encoder", 10))
        rclpy.init(domain_id=ros_domain)
        try:
            later.start()
            with pytest.raises(UsageError, match=r"in 2 namespaces \(/one, /two\); expected one"):
                namespace_of(["encoder"], lambda: False, 20.0)
        finally:
            later.join()
            rclpy.shutdown()
