"""Under a launch file Ctrl-C comes from the terminal and from the launcher: a node ends well however often it comes."""

from __future__ import annotations

import signal
import subprocess
import sys
import uuid

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import graph, until  # noqa: E402

NODES = {
    "rig": "msd_sim.node",
    "identifier": "msd_ident.ros.identifier",
    "recorder": "msd_ident.ros.recorder",
}


@pytest.mark.parametrize("kind", NODES)
def test_node_ends_well_under_a_hail_of_interrupts(ros_domain: int, kind: str) -> None:
    name = f"{kind}_{uuid.uuid4().hex}"
    command = [sys.executable, "-m", NODES[kind], "--ros-args", "-r", f"__node:={name}"]
    with (
        graph(ros_domain) as ros,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as node,
    ):
        try:
            until(lambda: name in ros.node.get_node_names() or node.poll() is not None, f"the {kind}", 60.0)
            # Until the very end: the last ones fall into the interpreter's own shutdown.
            until(lambda: node.send_signal(signal.SIGINT) or node.poll() is not None, f"the {kind}'s end", 60.0)
        finally:
            node.kill()
        output = node.communicate()[0]
    assert node.returncode == 0 and "Traceback" not in output, output
