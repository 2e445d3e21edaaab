"""The subscriptions of a recording: to topics as they come, as they are offered, and what was latched before it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription

from msd_ident.errors import DataError, MsdError
from msd_ident.io import OfferedQos
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import is_stamped, message_class, raw_stamp
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.message_batching import Poller, subscribe, waiting
from msd_ident.ros.recorder.recording import Numbered, Recording

#: Least time between two log lines of one kind [s].
QUIET = 5.0


@dataclass(frozen=True)
class Wanted:
    """What to listen to: topics, ``None`` for all that are not hidden, and the queue size of their subscriptions."""

    topics: frozenset[str] | None
    depth: int


class Following:
    """The subscriptions of a recording.

    Args:
        node: to listen with.
        recording: that takes the messages.
        wanted: what to listen to.
        watch: counts what goes wrong.
        poller: of the node.
    """

    def __init__(
        self,
        node: Node,
        recording: Recording,
        wanted: Wanted,
        watch: FaultLog,
        poller: Poller,
    ) -> None:
        self._node, self._recording, self._wanted, self._depth = node, recording, wanted.topics, wanted.depth
        self._watch, self._poller = watch, poller
        self._began_ns = time.time_ns()
        self._refused: set[str] = set()
        self._types: dict[str, str] = {}
        self._latched: list[Subscription] = []
        self._several: dict[str, int] = {}  # topics of several publishers, and their restarts at the last look
        self.subscriptions: dict[str, Subscription] = {}

    def look(self) -> None:
        """Subscribe to wanted topics that have come, and again to those whose publishers offer less than before."""
        for topic, _ in self._node.get_topic_names_and_types():
            chosen = topic in self._wanted if self._wanted is not None else not hidden(topic)
            if not chosen:
                continue
            try:
                self._follow(topic)
                self._refused.discard(topic)
            except MsdError as error:
                if topic not in self._refused:
                    self._refused.add(topic)
                    self._node.get_logger().warning(f"{topic} is not recorded: {error}", throttle_duration_sec=QUIET)
                    self._watch.note("not recorded", f"{topic} is not recorded: {error}")

    def close(self) -> None:
        """Take what has arrived, so that a stop loses nothing, and listen no more."""
        for subscription in (*self._latched, *self.subscriptions.values()):
            _drain(subscription)
            self._node.destroy_subscription(subscription)
        self.subscriptions.clear()
        self._latched.clear()

    def _follow(self, topic: str) -> None:
        """Subscribe as the publishers offer it, whatever type other subscriptions have."""
        publishers = self._node.get_publishers_info_by_topic(topic)
        if not publishers:
            return
        self._judge(topic, len(publishers))
        offered = [publisher.qos_profile for publisher in publishers]
        qos = names.matching_qos(offered, self._depth)
        has = self.subscriptions.get(topic)
        types = sorted({publisher.topic_type for publisher in publishers})
        if has is None:
            if len(types) > 1:
                raise DataError(f"it is published as {len(types)} types ({', '.join(types)}); expected one")
            self._add(topic, types[0], [names.to_offered(profile) for profile in offered])
        elif self._types[topic] not in types:
            words = f"{topic} is of type {types[0]} now and no longer {self._types[topic]}: it is not recorded"
            self._watch.note("another type", words)
            return
        elif not names.asks_for_more(has.qos_profile, qos):
            return
        else:
            _drain(has)
            self._node.destroy_subscription(has)
        take = self._taker(topic, self._types[topic])
        kind = message_class(self._types[topic])
        if self._node.get_parameter("use_sim_time").value:  # then the instant of taking is the log time
            self.subscriptions[topic] = subscribe(self._node, kind, topic, take, qos, raw=True)
        else:
            self.subscriptions[topic] = self._poller.subscribe(kind, topic, take, qos, raw=True)
        if has is None and _mixed(offered):
            self._fetch_latched(topic, kind, take)

    def _fetch_latched(self, topic: str, kind: Any, take: Callable[[bytes, dict[str, Any]], None]) -> None:
        """What publishers keep for those who come late, where the others keep nothing; sent before the recording."""

        def take_old(raw: bytes, info: dict[str, Any]) -> None:
            if info["source_timestamp"] < self._began_ns:
                take(raw, {**info, "publication_sequence_number": None})

        qos = QoSProfile(depth=self._depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._latched.append(subscribe(self._node, kind, topic, take_old, qos, raw=True))

    def _add(self, topic: str, kind: str, offered: Sequence[OfferedQos]) -> None:
        message_class(kind)
        if not self._recording.add_topic(topic, kind, offered):
            words = f"the definition of {kind} is not installed; only tools that know the type can read {topic}"
            self._node.get_logger().warning(words)
        self._types[topic] = kind

    def _taker(self, topic: str, kind: str) -> Callable[[bytes, dict[str, Any]], None]:
        """Callback for one topic: log time is the time of receipt, on the simulated clock if that is used."""
        clock = self._node.get_clock() if self._node.get_parameter("use_sim_time").value else None
        stamped = is_stamped(kind)
        recording, count = self._recording, self._recording.summary.topics[topic]

        def take(raw: bytes, info: dict[str, Any]) -> None:
            """Record a message and count what was lost before it."""
            if clock is None:
                received, sent = info["received_timestamp"], info["source_timestamp"]
            else:
                received = sent = clock.now().nanoseconds
            lost, restarts = count.lost, count.restarts
            stamp = raw_stamp(raw) if stamped else None
            sequence = info.get("publication_sequence_number")
            origin = Numbered(sequence, stamp, not count.jumps(sequence) or self._is_alone(topic))
            recording.put(topic, raw, received, sent or received, origin)
            if count.lost != lost:
                words = f"{topic}: {count.lost - lost} messages are missing according to their sequence numbers"
                self._watch.note("missing", words, count.lost - lost)
            if count.restarts != restarts:
                self._watch.note("publisher restarted", f"{topic}: its publisher restarted, or there are two")

        return take

    def _is_alone(self, topic: str) -> bool:
        """Whether a topic has one publisher: each numbers its own messages, and nothing tells them apart."""
        if self._node.count_publishers(topic) > 1:
            self._several[topic] = -1
        return topic not in self._several

    def _judge(self, topic: str, publishers: int) -> None:
        """Note that a topic has several publishers, until it has one and no number fell from one look to the next."""
        count = self._recording.summary.topics.get(topic)
        restarts = 0 if count is None else count.restarts
        if publishers == 1 and self._several.get(topic) == restarts:
            del self._several[topic]
        elif publishers > 1 or topic in self._several:
            self._several[topic] = restarts if publishers == 1 else -1


def _mixed(offered: Sequence[QoSProfile]) -> bool:
    """Whether some publishers keep messages for those who come late, and others do not."""
    return len({profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for profile in offered}) > 1


def _drain(subscription: Subscription) -> None:
    """Take what has arrived and waits in the subscription's queue."""
    for taken in waiting(subscription):
        subscription.callback(*taken)


def hidden(topic: str) -> bool:
    """Topics that ROS tools hide: a part of the name begins with an underscore."""
    return any(part.startswith("_") for part in topic.split("/"))
