"""Takes the messages that wait in a subscription's queue together.

An executor's way from one message to the next costs several times what it costs to take one: a node that is behind
would fall further behind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

#: Messages that are taken together at most, so that timers and services get their turn.
HANDFUL = 100
#: Time between two looks into the queues of those who can wait [s], and messages taken at a look at most.
PERIOD, MOST_AT_ONCE = 0.02, 1000


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


class Unserved(CallbackGroup):
    """A group of subscriptions that no executor waits for: their owner takes the messages.

    At 1 kHz an executor's way from sample to sample costs several times what it costs to take the sample.
    """

    def can_execute(self, entity: Any) -> bool:
        """Never."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Never."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing began."""


class Poller:
    """Subscriptions that are looked into on a timer, not woken up for by each message.

    An executor of rclpy takes a fifth of a core to be woken a thousand times a second; fifty looks take a tenth of
    that. For messages that carry their own stamps, since what is taken together has waited up to ``PERIOD``.

    Args:
        node: that owns the subscriptions.
    """

    def __init__(self, node: Node) -> None:
        self._node, self._unseen = node, Unserved()
        self._takers: dict[Subscription, Callable[[Any, dict[str, Any]], None]] = {}
        self._timer = node.create_timer(PERIOD, self.look, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._timer.cancel()

    def subscribe(
        self, kind: Any, topic: str, take: Callable[[Any, dict[str, Any]], None], qos: QoSProfile, **options: Any
    ) -> Subscription:
        """As the function of this name; to be destroyed by the node, as any other."""
        made = self._node.create_subscription(kind, topic, take, qos, callback_group=self._unseen, **options)
        self._takers[made] = take
        self._timer.reset()
        return made

    def look(self) -> None:
        """Hand over what has come."""
        for subscription, take in tuple(self._takers.items()):
            try:
                for taken in waiting(subscription, MOST_AT_ONCE):
                    take(*taken)
            except _rclpy.InvalidHandle:  # destroyed meanwhile
                self._takers.pop(subscription, None)
        if not self._takers:
            self._timer.cancel()
