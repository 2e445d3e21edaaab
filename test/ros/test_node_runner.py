"""A thread that spins: what is destroyed beside it, and what is not there at all."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from itertools import chain, repeat

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import until  # noqa: E402
from rclpy.exceptions import InvalidHandle  # noqa: E402
from rclpy.node import Node  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402

from msd_ident.ros.common.node_runner import Spinner  # noqa: E402


@pytest.fixture
def node(ros_domain: int) -> Iterator[Node]:
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain, args=[])
    made = Node("spun", context=context)
    yield made
    made.destroy_node()
    context.try_shutdown()


def test_publishers_may_come_and_go_in_another_thread(node: Node) -> None:
    spinner = Spinner(node)
    for _ in range(200):
        node.destroy_publisher(node.create_publisher(Float64, "value", 1))
    done = threading.Event()
    spinner.executor.create_task(done.set)
    until(done.is_set, "the executor to go on")
    spinner.stop()
    assert not spinner.failed


@pytest.mark.parametrize(("times", "failed"), [(1, False), (5, False), (1000, True)])
def test_what_is_destroyed_while_it_is_collected_ends_nothing(
    node: Node, times: int, failed: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A node that waits for a thing which is gone for good fails in words."""
    told = threading.Event()
    rounds = chain(repeat(True, times), repeat(False))
    monkeypatch.setattr("msd_ident.ros.common.node_runner.SingleThreadedExecutor", _failing(rounds))
    spinner = Spinner(node, on_failure=told.set)
    done = threading.Event()
    spinner.executor.create_task(done.set)
    until(lambda: done.is_set() or told.is_set(), "the executor to go on, or to fail")
    spinner.stop()
    assert spinner.failed is told.is_set() is failed
    assert ("InvalidHandle" in capsys.readouterr().err) is failed


def _failing(rounds: Iterator[bool]) -> type:
    """An executor of which some rounds meet a thing that is being destroyed."""
    from rclpy.executors import SingleThreadedExecutor

    class Failing(SingleThreadedExecutor):
        def spin_once(self, timeout_sec: float | None = None) -> None:
            if next(rounds):
                raise InvalidHandle("cannot use Destroyable because destruction was requested")
            super().spin_once(timeout_sec)

    return Failing
