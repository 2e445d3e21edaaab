"""ROS nodes inside a test: a context of its own, a thread that spins, waiting on conditions and never on time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node

from msd_ident.ros.common.node_runner import Spinner


class Graph:
    """Nodes of one test, spun together, taken down in order."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self._spinners: list[Spinner] = []
        self._owners: list[Any] = []
        self._clients: list[ActionClient] = []
        self.node = Node("tester", context=self.context)
        self.spin(self.node)

    def spin(self, node: Node) -> Spinner:
        """Spin a node in a thread."""
        self._spinners.append(Spinner(node))
        return self._spinners[-1]

    def add(self, owner: Any) -> Any:
        """Spin the node of an owner, and close both at the end."""
        self._owners.append(owner)
        self.spin(owner.node)
        return owner

    def call(self, kind: Any, name: str, request: Any, seconds: float = 60.0) -> Any:
        """Call a service and wait for the answer."""
        client = self.node.create_client(kind, name)
        try:
            assert client.wait_for_service(seconds), f"no service {name}"
            future = client.call_async(request)
            until(future.done, f"answer of {name}", seconds)
            return future.result()
        finally:
            self.node.destroy_client(client)

    def goal(
        self, kind: Any, name: str, request: Any, heard: Callable[[Any], None] = lambda feedback: None
    ) -> tuple[Any, Any]:
        """Send a goal; its handle, and the future of its result. ``heard`` is told the feedback."""
        client = ActionClient(self.node, kind, name)
        self._clients.append(client)
        assert client.wait_for_server(30.0), f"no action {name}"
        handle = self.sent(client, request, lambda message: heard(message.feedback))
        assert handle.accepted
        return handle, self.within(handle.get_result_async)

    def sent(self, client: ActionClient, request: Any, heard: Callable[[Any], None]) -> Any:
        """Send a goal; its handle, accepted or not."""
        future = self.within(lambda: client.send_goal_async(request, feedback_callback=heard))
        until(future.done, "the answer to the goal")
        return future.result()

    def within(self, work: Callable[[], Any]) -> Any:
        """Do something in the thread that spins the tester, and wait for it.

        An action client loses an answer that comes before it has noted the request: it has no lock for that.
        """
        done = self._spinners[0].executor.create_task(work)
        until(done.done, "the tester")
        return done.result()

    def close(self) -> None:
        """Take everything down."""
        for spinner in reversed(self._spinners):
            spinner.stop()
        for client in self._clients:
            client.destroy()
        for owner in reversed(self._owners):
            owner.close()
            owner.node.destroy_node()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)


@contextmanager
def graph(domain: int) -> Iterator[Graph]:
    """A graph for the block."""
    made = Graph(domain)
    try:
        yield made
        assert not any(spinner.failed for spinner in made._spinners), "a callback raised, see stderr"
    finally:
        made.close()


def until(condition: Callable[[], Any], what: str, seconds: float = 60.0) -> None:
    """Wait until a condition holds; fail, naming it, when it does not in time."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"waited {seconds:g} s for {what}"
        time.sleep(0.005)
