"""A handful of messages at a time, in their order, and nobody else has to wait for the rest of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import Graph, graph, until  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from std_msgs.msg import Int32  # noqa: E402

from bench.idle import measure  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.message_batching import HANDFUL, Poller, subscribe, waiting  # noqa: E402

SENT = 2 * HANDFUL + 50


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def sent(ros: Graph, listener: Node, take: Any, **options: Any) -> Any:
    """A subscription in whose queue so many messages wait, and the publisher."""
    qos = names.encoder_qos(10 * SENT)
    subscription = subscribe(listener, Int32, "numbers", take, qos, **options)
    publisher = ros.node.create_publisher(Int32, "numbers", qos)
    until(publisher.get_subscription_count, "the listener")
    for number in range(SENT):
        publisher.publish(Int32(data=number))
    assert publisher.wait_for_all_acked()
    return subscription


def test_a_turn_takes_a_handful_in_order_and_others_have_theirs_in_between(ros: Graph) -> None:
    listener = Node("listener", context=ros.context)
    executor = SingleThreadedExecutor(context=ros.context)
    executor.add_node(listener)
    taken: list[int] = []
    numbers: list[int] = []
    turns: list[int] = []

    def take(message: Int32, info: dict[str, Any]) -> None:
        taken.append(message.data)
        numbers.append(info["publication_sequence_number"])

    sent(ros, listener, take)
    listener.create_timer(1e-4, lambda: turns.append(len(taken)))
    while len(taken) < SENT:
        before = len(taken)
        executor.spin_once(timeout_sec=10.0)
        assert len(taken) - before in (0, min(HANDFUL + 1, SENT - before))
    assert taken == list(range(SENT))
    assert numbers == list(range(numbers[0], numbers[0] + SENT))
    assert {HANDFUL + 1, 2 * (HANDFUL + 1)} & set(turns), turns
    executor.shutdown()
    listener.destroy_node()


def test_a_queue_is_emptied_without_an_executor(ros: Graph) -> None:
    listener = Node("listener", context=ros.context)
    subscription = sent(ros, listener, print, raw=True)
    some = list(waiting(subscription, 7))
    rest = list(waiting(subscription))
    assert len(some) == 7 and len(some) + len(rest) == SENT
    assert all(isinstance(raw, bytes) and info["source_timestamp"] for raw, info in some + rest)
    assert not list(waiting(subscription))
    listener.destroy_node()


def test_a_poller_hands_over_everything_in_order_and_lets_go_of_what_is_destroyed(ros: Graph) -> None:
    listener = Node("listener", context=ros.context)
    poller = Poller(listener)
    taken: list[int] = []
    qos = names.encoder_qos(10_000)
    subscription = poller.subscribe(Int32, "numbers", lambda message, info: taken.append(message.data), qos)
    publisher = ros.node.create_publisher(Int32, "numbers", qos)
    until(publisher.get_subscription_count, "the listener")
    spinner = ros.spin(listener)
    for number in range(3000):
        publisher.publish(Int32(data=number))
    until(lambda: len(taken) == 3000, "all messages")
    assert taken == list(range(3000))
    listener.destroy_subscription(subscription)
    until(lambda: poller._timer.is_canceled(), "the poller to rest")
    again = poller.subscribe(Int32, "numbers", lambda message, info: taken.append(-message.data), qos)
    until(publisher.get_subscription_count, "the listener")
    publisher.publish(Int32(data=7))
    until(lambda: taken[-1] == -7, "the message")
    spinner.stop()
    listener.destroy_subscription(again)
    listener.destroy_node()


@pytest.mark.timeout(180)
def test_nobody_wakes_for_each_message() -> None:
    """At 1 kHz. A count, since processor time depends on the machine; ``python -m bench.idle`` measures that."""
    found = measure(5.0, 1000.0)
    wakes = {node: idle.wakes for node, idle in found.items()}
    assert wakes["rig"] > 50, f"the rig hardly publishes: {wakes}"
    assert wakes["identifier"] < 150 and wakes["recorder"] < 50 and wakes["experimenter"] < 50, wakes
