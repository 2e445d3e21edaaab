"""What the servers of all actions share: QoS of their services, their callback group, the end of a goal."""

from __future__ import annotations

from typing import Any

from action_msgs.msg import GoalStatus
from rclpy.action import ActionServer
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from msd_ident.ros.common import names


def serve(node: Node, kind: Any, name: str, execute: Any, **callbacks: Any) -> ActionServer:
    """A server whose goals wait for a worker thread and hold up nothing else.

    Args:
        node: that it belongs to.
        kind: the action.
        name: as in ``names``; the server's is private.
        execute: coroutine that takes the goal's handle and gives the result.
        callbacks: further ones of ``ActionServer``.
    """
    qos = {f"{service}_service_qos_profile": names.service_qos() for service in ("goal", "result", "cancel")}
    return ActionServer(
        node, kind, names.private(name), execute, callback_group=ReentrantCallbackGroup(), **callbacks, **qos
    )


def finish(handle: ServerGoalHandle, success: bool, cancelled: bool = True) -> None:
    """Set the state of a goal that has its result.

    Args:
        handle: of the goal.
        success: whether it reached its aim.
        cancelled: whether a cancellation that was asked for has acted.
    """
    if handle.status == GoalStatus.STATUS_CANCELING and cancelled:
        handle.canceled()
    elif success:
        handle.succeed()
    else:
        handle.abort()
