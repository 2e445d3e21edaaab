"""A handful of messages at a time, in their order, and nobody else has to wait for the rest of them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import Graph, graph, until  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Header, Int32  # noqa: E402

from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import time_message  # noqa: E402
from msd_ident.ros.common.message_batching import HANDFUL, PERIOD, Poller, subscribe, waiting  # noqa: E402
from msd_ident.ros.common.node_runner import Spinner  # noqa: E402
from msd_ident.ros.experimenter.node import Experimenter  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402

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


def rounds(spinner: Spinner) -> list[float]:
    """Gets an instant for each round of an executor."""
    found: list[float] = []
    once = spinner.executor.spin_once

    def counted(**options: Any) -> None:
        once(**options)
        found.append(time.monotonic())

    spinner.executor.spin_once = counted  # type: ignore[method-assign]
    return found


def test_nobody_wakes_for_each_message(ros: Graph, tmp_path: Path) -> None:
    """Messages at 1 kHz. Rounds of the executors: how often a thread waits depends on the machine's load too."""
    folder = [Parameter("bag_folder", value=str(tmp_path))]
    identifier = ros.add(Identifier(context=ros.context))
    ros.add(Recorder(folder, context=ros.context))
    ros.add(Experimenter(folder, context=ros.context))
    encoder = ros.node.create_publisher(JointState, names.ENCODER, names.encoder_qos(5000))
    until(encoder.get_subscription_count, "the identifier's subscription")
    counted = [rounds(spinner) for spinner in ros._spinners[1:]]
    begin = time.monotonic()
    for number in range(3000):
        time.sleep(max(begin + 1e-3 * number - time.monotonic(), 0.0))
        stamp = time_message(10**18 + number * 10**6)
        encoder.publish(JointState(header=Header(stamp=stamp), name=["cart"], position=[1e-3 * number]))
    until(lambda: identifier.buffer.position.newest_ns == 10**18 + 2999 * 10**6, "the last message")
    assert identifier.buffer.position.size > 1000, "a busy machine may lose some"
    seconds = time.monotonic() - begin
    a_second = [len(found) / seconds for found in counted]
    assert a_second[0] < 1.5 / PERIOD and max(a_second[1:]) < 25, a_second
