"""Subscriptions to the force and the position, on any topic and field, also on topics that come later."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from msd_ident.bag.fields import parse_field
from msd_ident.bag.options import NO_FORCE
from msd_ident.errors import MsdError
from msd_ident.record import FloatArray, Origin
from msd_ident.ros import names
from msd_ident.ros.buffer import LiveBuffer, StampArray
from msd_ident.ros.conversions import Signal, message_class
from msd_ident.ros.steps import StepWatcher


@dataclass(frozen=True)
class Wanted:
    """A signal that is wanted.

    Attributes:
        what: ``force`` or ``position``.
        topic: as the user names it.
        field: in its messages; empty for the usual one.
        scale: factor to the unit of the record.
    """

    what: Literal["force", "position"]
    topic: str
    field: str
    scale: float


def wanted(what: Literal["force", "position"], text: str, scale: float) -> tuple[Wanted, ...]:
    """The signals that a parameter ``TOPIC:FIELD`` means; empty for the usual topics, a force of ``none`` is none.

    Raises:
        UsageError: the field cannot be read.
    """
    if what == "force" and text == NO_FORCE:
        return ()
    if text:
        topic, _, field = text.partition(":")
        return (Wanted(what, topic, parse_field(field).text if field else "", scale),)
    topics = (names.FORCE,) if what == "force" else (names.ENCODER, names.ENCODER_BATCH)
    return tuple(Wanted(what, topic, "", scale) for topic in topics)


class Input:
    """One subscription that fills the live buffer.

    A topic whose type is known is subscribed to at once, any other when ``look`` finds a publisher. The subscription
    never asks for more than the publishers offer: it is made anew when one comes that offers less.
    """

    def __init__(self, node: Node, signal: Wanted, sink: Sink, depth: int, group: CallbackGroup) -> None:
        self.wanted = signal
        self.topic = node.resolve_topic_name(signal.topic)
        self.problem = ""
        self.signal: Signal | None = None
        self.heard = 0.0
        self._subscription: Subscription | None = None
        self._node, self._sink, self._depth, self._group = node, sink, depth, group
        known = "" if signal.field else names.TYPES.get(signal.topic, "")
        if known:
            self._subscribe(known, names.force_qos(depth) if signal.what == "force" else names.encoder_qos(depth))

    @property
    def origin(self) -> Origin:
        """Topic, and what its publisher numbered and never came."""
        return Origin(self.wanted.what, self.topic, self.signal.missing if self.signal else 0)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of results must know about the samples."""
        return (self.signal.problem,) if self.signal and self.signal.missing else ()

    def look(self) -> None:
        """Subscribe when somebody publishes the topic, as the publishers allow."""
        publishers = [] if self.problem else self._node.get_publishers_info_by_topic(self.topic)
        if not publishers:
            return
        qos = names.matching_qos([publisher.qos_profile for publisher in publishers], self._depth)
        if self._subscription is None or names.asks_for_more(self._subscription.qos_profile, qos):
            self._subscribe(publishers[0].topic_type, qos)

    def _subscribe(self, type_name: str, qos: QoSProfile) -> None:
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
        try:
            self.signal = self.signal or Signal(self.wanted.what, type_name, self.wanted.field, self.wanted.scale)
            kind, topic = message_class(type_name), self.wanted.topic
            self._subscription = self._node.create_subscription(
                kind, topic, self._take, qos, callback_group=self._group
            )
        except MsdError as error:
            self._complain(error)

    def _take(self, message: object) -> None:
        if self.problem or self.signal is None:
            return
        self.heard = time.monotonic()
        received_ns = self._node.get_clock().now().nanoseconds
        try:
            if self.signal.is_batch:
                self._sink.positions(*self.signal.batch(message, received_ns))
            elif (sample := self.signal.sample(message, received_ns)) is not None:
                self._sink.sample(self.wanted.what, *sample)
        except MsdError as error:
            self._complain(error)

    def _complain(self, error: MsdError) -> None:
        self.problem = f"{self.topic}: {error}"
        self._node.get_logger().error(self.problem)


class Sink:
    """Where samples go: the buffer, and the watcher of force steps.

    Where the position comes single and in batches, the batches count, as in a bag.
    """

    def __init__(self, buffer: LiveBuffer, watcher: StepWatcher) -> None:
        self.buffer = buffer
        self.watcher = watcher
        self._batches = False

    def sample(self, what: str, ns: int, value: float) -> None:
        """Take one sample of either signal."""
        if what == "force":
            self.watcher.force(ns, value)
            self.buffer.add_force(ns, value)
        elif not self._batches:
            self._follow_clock(lambda: self.buffer.add_position(ns, value))

    def positions(self, ns: StampArray, values: FloatArray) -> None:
        """Take the samples of a batch."""
        if not self._batches:
            self._batches = True
            self.buffer.position.clear()
        self._follow_clock(lambda: self.buffer.add_positions(ns, values))

    def _follow_clock(self, add: Callable[[], None]) -> None:
        restarts = self.buffer.counts.restarts
        add()
        if self.buffer.counts.restarts != restarts:
            self.watcher.forget()


def listed(inputs: Sequence[Input]) -> str:
    """Their topics, for a sentence."""
    return " or ".join(entry.topic for entry in inputs)
