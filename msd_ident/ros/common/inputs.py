"""Subscriptions to the force and the position, on any topic and field, also on topics that come later."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from msd_ident.data.record import LARGEST, FloatArray, Origin
from msd_ident.errors import DataError, MsdError, SetupError
from msd_ident.io.message_fields import parse_field
from msd_ident.io.source_options import NO_FORCE
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import Signal, is_stamped, message_class
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.live_buffer import LiveBuffer, StampArray
from msd_ident.ros.common.message_batching import Poller, subscribe
from msd_ident.ros.common.missing_samples import Holes, TopicCount
from msd_ident.ros.common.parameters import topic_name
from msd_ident.ros.identifier.step_detection import StepWatcher

#: Pause after which a publisher that restarted may have another zero [ns].
_RESTART_NS = 100_000_000
#: Least time between two log lines of one kind [s].
QUIET = 5.0


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

    def topic_of(self, node: Node) -> str:
        """Whole name of the topic for a node.

        Raises:
            UsageError: no topic can have this name.
        """
        given = f"{self.what} is {':'.join(filter(None, (self.topic, self.field)))!r}"
        return topic_name(node, self.topic, given, "TOPIC:FIELD such as /joint_states:position[elbow]")


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
    never asks for more than the publishers offer: it is made anew when one comes that offers less, or another type.

    Attributes:
        problem: why nothing can be taken from the topic; empty when something can.
        publishers: how many there are.
        count: messages that came and that did not.
    """

    def __init__(self, node: Node, signal: Wanted, sink: Sink, depth: int, poller: Poller) -> None:
        self.wanted = signal
        self.topic = signal.topic_of(node)
        self.problem = ""
        self.signal: Signal | None = None
        self.publishers = 0
        self.count = TopicCount()
        self._holes = Holes()
        self._last_ns = 0
        self._tried = ""
        self._subscription: Subscription | None = None
        self._node, self._sink, self._depth, self._poller = node, sink, depth, poller
        known = "" if signal.field else names.TYPES.get(signal.topic, "")
        if known:
            self._subscribe(known, names.force_qos(depth) if signal.what == "force" else names.encoder_qos(depth))

    @property
    def missing(self) -> int:
        """What its publisher numbered and never came: samples of batches, else messages."""
        return self.signal.missing if self.signal and self.signal.is_batch else self.count.lost

    def origin(self, since_ns: int) -> Origin:
        """Topic, and what its publisher numbered and never came after a stamp [ns]."""
        return Origin(self.wanted.what, self.topic, self._holes.since(since_ns))

    def look(self) -> None:
        """Subscribe when somebody publishes the topic, as the publishers allow."""
        publishers = self._node.get_publishers_info_by_topic(self.topic)
        self.publishers = len(publishers)
        types = {publisher.topic_type for publisher in publishers}
        if not publishers or (self.problem and types == {self._tried}):
            return
        qos = names.matching_qos([publisher.qos_profile for publisher in publishers], self._depth)
        new = self._tried not in types
        if self._subscription is None or new or names.asks_for_more(self._subscription.qos_profile, qos):
            self._subscribe(publishers[0].topic_type, qos)

    def _subscribe(self, type_name: str, qos: QoSProfile) -> None:
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
        self.problem, self._tried = "", type_name
        try:
            if self.signal is None or type_name != self.signal.type_name:
                self.signal = Signal(self.wanted.what, type_name, self.wanted.field, self.wanted.scale)
            kind, topic = message_class(type_name), self.wanted.topic
            if is_stamped(type_name):
                self._subscription = self._poller.subscribe(kind, topic, self._take, qos)
            else:  # the instant of receipt is its stamp
                self._subscription = subscribe(self._node, kind, topic, self._take, qos)
        except MsdError as error:
            self._complain(error)
        except _rclpy.RCLError as error:  # another type of this topic stands in this very process
            self._complain(SetupError(f"{str(error).splitlines()[0]}; expected one type on this topic"))

    def _take(self, message: Any, info: Mapping[str, Any]) -> None:
        if self.problem or self.signal is None:
            return
        received_ns = self._node.get_clock().now().nanoseconds
        try:
            if self.signal.is_batch:
                self._take_batch(message, received_ns, info["publication_sequence_number"])
            else:
                self._take_sample(message, received_ns, info["publication_sequence_number"])
        except MsdError as error:
            self._complain(error)

    def _take_sample(self, message: Any, received_ns: int, number: int | None) -> None:
        assert self.signal is not None
        switches, joint = self.signal.switches, self.signal.entry
        found = self.signal.sample(message, received_ns)
        if self.signal.switches != switches:
            self._sink.begin_anew(self.wanted.what)
            sentence = f"joint {joint} is gone and {self.signal.entry} is in its place: a new recording starts"
            self._note("joint renamed", sentence)
        if self.signal.oversized:
            self._note("oversized", f"a message of {self.signal.oversized} entries")
            self.signal.oversized = 0
        if found is None:
            self._counted(number, None)
            self._note("no sample", self.signal.problem)
            return
        ns, value = found
        self._counted(number, ns)
        if abs(value) <= LARGEST:
            self._sink.sample(self.wanted.what, ns, value)
        else:
            self._note("not finite", f"a {self.wanted.what} of {value:.3g} is left out")

    def _take_batch(self, message: Any, received_ns: int, number: int | None) -> None:
        assert self.signal is not None
        before = self.signal.missing
        try:
            ns, values = self.signal.batch(message, received_ns)
        except DataError as error:
            self._counted(number, None)
            self._note("no sample", str(error))
            return
        if not ns.size:
            self._note("no sample", "a batch holds no samples")
            return
        self._counted(number, int(ns[0]))
        lost = self.signal.missing - before
        self._holes.add(int(ns[0]), lost)
        if lost:
            self._note("missing", f"{lost} samples are missing according to the sequence numbers of the batches", lost)
        good = np.abs(values) <= LARGEST
        if not good.all():
            self._note("not finite", f"{np.count_nonzero(~good)} samples of a batch are not finite and are left out")
        self._sink.positions(ns[good], values[good])

    def _counted(self, number: int | None, ns: int | None) -> None:
        """Count a message; a publisher that restarts after a pause begins a new recording: its zero may be another."""
        assert self.signal is not None
        alone = self.publishers <= 1
        restarts, last = self.count.restarts, self._last_ns
        lost = self.count.count(number, None if self.signal.is_batch else ns, alone=alone)
        self._last_ns = ns or last
        if lost and not self.signal.is_batch:
            self._holes.add(self._last_ns, lost)
            self._note("missing", f"{lost} messages are missing according to their sequence numbers", lost)
        if self.count.restarts == restarts:
            return
        if ns and last and ns - last > _RESTART_NS and self.wanted.what == "position":
            self._sink.begin_anew("position")
            self._note("publisher restarted", "its publisher restarted; a new recording starts")
        elif alone:
            self._note("publisher restarted", "its publisher began anew")

    def _note(self, kind: str, sentence: str, count: int = 1) -> None:
        self._sink.watch.note(kind, f"{self.topic}: {sentence}", count)

    def _complain(self, error: MsdError) -> None:
        self.problem = f"{self.topic}: {error}"
        self._node.get_logger().error(self.problem, throttle_duration_sec=QUIET)


class Sink:
    """Where samples go: the buffer, and the watcher of force steps.

    Where the position comes single and in batches, the batches count, as in a bag.
    """

    def __init__(self, buffer: LiveBuffer, watcher: StepWatcher, watch: FaultLog) -> None:
        self.buffer = buffer
        self.watcher = watcher
        self.watch = watch
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

    def begin_anew(self, what: str) -> None:
        """What follows is no continuation of what was."""
        if what == "position":
            self.buffer.begin_anew()
            self.watcher.forget()

    def _follow_clock(self, add: Callable[[], None]) -> None:
        restarts = self.buffer.counts.restarts
        add()
        if self.buffer.counts.restarts != restarts:
            self.watcher.forget()


def listed(inputs: Sequence[Input]) -> str:
    """Their topics, for a sentence."""
    return " or ".join(entry.topic for entry in inputs)


def crowds(position: Sequence[Input]) -> Iterator[str]:
    """Several publishers of one encoder, in words. Of the force anybody may be one."""
    for entry in position:
        if entry.publishers > 1:
            yield f"{entry.topic}: {entry.publishers} publishers; expected one"
