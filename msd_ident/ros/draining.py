"""What waits in a subscription's queue, taken in a handful.

An executor's way from one message to the next costs several times what it costs to take one: a node that is behind
would fall further behind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

#: Messages that are taken together at most, so that timers and services get their turn.
HANDFUL = 100


def waiting(subscription: Subscription, most: int | None = None) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Messages in the queue, oldest first, each with its information; at most so many."""
    with subscription.handle:
        for _ in count() if most is None else range(most):
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                return
            yield taken


def subscribe(
    node: Node,
    kind: Any,
    topic: str,
    take: Callable[[Any, dict[str, Any]], None],
    qos: QoSProfile,
    **options: Any,
) -> Subscription:
    """A subscription that hands over, with each message, the handful that waits behind it.

    Args:
        node: whose executor serves it.
        kind: class of the messages.
        topic: its name.
        take: gets each message and its information.
        qos: of the subscription.
        options: further ones of ``Node.create_subscription``.
    """

    def take_all(message: Any, info: dict[str, Any]) -> None:
        take(message, info)
        for entry in waiting(made, HANDFUL):
            take(*entry)

    made = node.create_subscription(kind, topic, take_all, qos, **options)
    return made
