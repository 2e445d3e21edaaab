"""Force and position from the graph into the scope, polled once a frame."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Literal

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from rclpy.subscription import Subscription

from msd_ident.data.record import FloatArray
from msd_ident.data.streams import LATEST_SECONDS
from msd_ident.errors import MsdError
from msd_ident.live import Scope
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import Signal, message_class
from msd_ident.ros.common.inputs import Wanted, wanted
from msd_ident.ros.common.message_batching import Unserved, waiting
from msd_ident.ros.common.parameters import Settings

#: Silence of the encoder after which the page says so [s].
SILENCE = 2.0

Stamps = npt.NDArray[np.int64]
Samples = tuple[Stamps, FloatArray]


class Tap:
    """One topic that is drained. Counts nothing: the identifier and the recorder do, and say so on ``/diagnostics``."""

    def __init__(self, node: Node, signal: Wanted, depth: int) -> None:
        self.topic = signal.topic_of(node)
        self.problem = ""
        self.signal: Signal | None = None
        self._node, self._wanted, self._depth = node, signal, depth
        self._subscription: Subscription | None = None

    def look(self) -> None:
        """Subscribe once somebody publishes, as the publishers allow; again when one comes that offers less."""
        publishers = self._node.get_publishers_info_by_topic(self.topic)
        if not publishers:
            return
        qos = names.matching_qos([publisher.qos_profile for publisher in publishers], self._depth)
        old = self._subscription
        if old is not None and not names.asks_for_more(old.qos_profile, qos):
            return
        if old is not None:
            self._node.destroy_subscription(old)
            self._subscription = None
        type_name = publishers[0].topic_type
        try:
            self.signal = Signal(self._wanted.what, type_name, self._wanted.field, self._wanted.scale)
            kind, topic = message_class(type_name), self._wanted.topic
            self._subscription = self._node.create_subscription(kind, topic, _nobody, qos, callback_group=Unserved())
            self.problem = ""
        except MsdError as error:
            self.problem = f"{self.topic}: {error}"

    def drain(self) -> list[Samples]:
        """All that has arrived since the last call."""
        if self._subscription is None or self.signal is None:
            return []
        now_ns = self._node.get_clock().now().nanoseconds
        messages = [message for message, _ in waiting(self._subscription)]
        try:
            if self.signal.is_batch:
                return [self.signal.batch(message, now_ns) for message in messages]
            found = [self.signal.sample(message, now_ns) for message in messages]
        except MsdError as error:
            self.problem = f"{self.topic}: {error}"
            return []
        known = [sample for sample in found if sample is not None]
        if not known:
            return []
        ns, values = zip(*known, strict=True)
        return [(np.array(ns, dtype=np.int64), np.array(values, dtype=np.float64))]


class LiveData:
    """Owns the taps of force and position.

    Args:
        node: they belong to.
        settings: the node's parameters: what force and position are.
        scope: is filled.
    """

    def __init__(self, node: Node, settings: Settings, scope: Scope) -> None:
        def made(what: Literal["force", "position"]) -> list[Tap]:
            signals = wanted(what, settings[what], settings[f"{what}_scale"])
            return [Tap(node, signal, settings["queue_depth"]) for signal in signals]

        self._scope = scope
        self._force, self._position = made("force"), made("position")
        self._count, self._newest_ns, self._last_received = 0, 0, 0.0
        self._last_look = (time.monotonic(), 0)

    @property
    def subscriptions(self) -> int:
        """Subscriptions to the force."""
        return len(self._force)

    def look(self) -> None:
        """Subscribe to what has come."""
        for tap in (*self._force, *self._position):
            tap.look()

    def take(self) -> None:
        """Everything that has arrived since the last call, into the scope: the force first, which acts on the rest."""
        for tap in self._force:
            _each(tap, self._scope.add_forces)
        for tap in self._position:
            _each(tap, self._add_positions)

    def status(self) -> tuple[bool, str]:
        """How the measurements are doing: whether well, and a sentence."""
        (then, before), now = self._last_look, time.monotonic()
        self._last_look = (now, self._count)
        topics = " or ".join(tap.topic for tap in self._position)
        problems = [tap.problem for tap in (*self._position, *self._force) if tap.problem]
        if problems:
            return False, problems[0]
        if not self._count:
            return False, f"waiting for samples on {topics}"
        if now - self._last_received > SILENCE:
            return False, f"no sample for {now - self._last_received:.0f} s on {topics}"
        return True, f"{(self._count - before) / max(now - then, 1e-3):.0f} samples per second"

    def _add_positions(self, ns: Stamps, values: FloatArray) -> None:
        if ns.size:
            self._count += ns.size
            self._last_received = time.monotonic()
            if ns[-1] < self._newest_ns - LATEST_SECONDS * 1e9:
                self._scope.clear()  # the clock was set back, as by a replay in a loop
                self._newest_ns = int(ns[-1])
            self._newest_ns = max(self._newest_ns, int(ns[-1]))
            self._scope.add_positions(ns, values)


def _each(tap: Tap, take: Callable[[Stamps, FloatArray], None]) -> None:
    for ns, values in tap.drain():
        take(ns, values)


def _nobody(message: object) -> None:
    """Never called: the tap takes the messages itself."""
