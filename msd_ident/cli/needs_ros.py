"""Check that ROS 2 and ``msd_interfaces`` are installed, for subcommands that need them."""

from __future__ import annotations

import importlib.util

from msd_ident.errors import SetupError


def require_ros(command: str) -> None:
    """See that ROS 2 and our interfaces can be imported.

    Raises:
        SetupError: one of them cannot.
    """
    if importlib.util.find_spec("rclpy") is None:
        raise SetupError(
            f"ROS 2 is not here, and {command} needs it: run `make setup`, or source your ROS installation "
            "(source /opt/ros/jazzy/setup.bash)"
        )
    if importlib.util.find_spec("msd_interfaces") is None:
        raise SetupError(
            f"msd_interfaces is not here, and {command} needs it: run `make setup`, or build the workspace with colcon "
            "and source it"
        )
