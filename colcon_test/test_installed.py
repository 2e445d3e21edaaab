"""What `colcon build` installed works: both packages are found, the command reads a bag, a node comes and goes.

`colcon test` runs this with the workspace sourced.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
import rclpy
from ament_index_python.packages import get_package_prefix, get_package_share_directory
from std_srvs.srv import Trigger

from msd_interfaces.action import Diagnose
from msd_interfaces.srv import Identify

BAG = Path(__file__).resolve().parents[1] / "bags" / "paper_step"
NODES = ("rig", "identifier", "recorder", "replayer", "experimenter", "live")


def executable(name: str) -> Path:
    """Where ``ros2 run msd_ident NAME`` looks."""
    return Path(get_package_prefix("msd_ident")) / "lib" / "msd_ident" / name


def test_both_packages_are_in_the_index() -> None:
    for package in ("msd_ident", "msd_interfaces"):
        assert (Path(get_package_share_directory(package)) / "package.xml").is_file()


def test_interfaces_have_what_is_needed_to_send_them() -> None:
    """Messages, services and actions of the installed package, and a client of one."""
    assert Identify.Request().bag_path == "" and list(Diagnose.Goal().bag_paths) == []
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("smoke", context=context)
    node.create_client(Identify, "identify")
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.parametrize("node", NODES)
def test_ros2_run_finds(node: str) -> None:
    assert os.access(executable(node), os.X_OK)


def test_launch_files_and_parameters_are_installed() -> None:
    share = Path(get_package_share_directory("msd_ident"))
    assert {"pipeline.launch.py", "identifier.launch.py"} <= {path.name for path in (share / "launch").iterdir()}
    assert (share / "config" / "identifier.yaml").is_file()


def test_command_reads_a_bag() -> None:
    done = subprocess.run([executable("msd"), "info", BAG, "--json", "-"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["kind"]


def test_recorder_runs_answers_and_ends(tmp_path: Path) -> None:
    """The installed executable, under a namespace: a service call is answered, and a signal ends it."""
    arguments = ["--ros-args", "-r", "__ns:=/smoke", "-p", f"bag_folder:={tmp_path}"]
    process = subprocess.Popen([executable("recorder"), *arguments], stderr=subprocess.PIPE, text=True)
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("smoke_caller", context=context)
    try:
        client = node.create_client(Trigger, "/smoke/recorder/stop")
        assert client.wait_for_service(60.0), "the recorder does not come"
        executor = rclpy.executors.SingleThreadedExecutor(context=context)
        future = client.call_async(Trigger.Request())
        executor.add_node(node)
        executor.spin_until_future_complete(future, timeout_sec=30.0)
        assert "no recording in progress" in future.result().message
        process.send_signal(signal.SIGINT)
        began = time.monotonic()
        assert process.wait(20.0) == 0, process.communicate()[1]
        assert time.monotonic() - began < 20.0
    finally:
        process.kill()
        node.destroy_node()
        context.try_shutdown()
