"""The replayer node: a bag back to the graph, at any rate, with its own QoS, as the bytes that were recorded."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import ReliabilityPolicy
from rosgraph_msgs.msg import Clock as ClockMessage

from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.io import Bag, RawMessage, open_bag
from msd_ident.quantity import counted
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import message_class, time_message
from msd_ident.ros.common.node_runner import NodeOwner
from msd_ident.ros.common.parameters import Settings, declared
from msd_ident.ros.replayer.schedule import CLOCK_PERIOD_NS, ReplayRate, Tick, with_ticks

SETTINGS = declared("replayer")


class Replayer(NodeOwner):
    """Owns the node, its publishers and the thread that plays.

    Args:
        overrides: parameters that go before those of the command line.
        on_end: called when the bag is played.
        node_options: further arguments of ``rclpy.node.Node`` (a context, arguments of a test).

    Raises:
        UsageError: no bag is named, or a topic that it has not.
        DataError: the bag cannot be read.
        SetupError: no type of its topics is installed.
    """

    def __init__(
        self, overrides: list[Parameter] | None = None, on_end: Callable[[], None] = lambda: None, **node_options: Any
    ) -> None:
        self.node = Node("replayer", parameter_overrides=overrides, **node_options)
        self.settings = Settings(self.node, SETTINGS)
        self._log = self.node.get_logger()
        self._on_end = on_end
        self._stop = threading.Event()
        self.sent = 0
        self._failure = ""
        if not self.settings["bag"]:
            raise UsageError("no bag to play; expected the parameter bag, e.g. --ros-args -p bag:=FOLDER")
        self._bag = open_bag(self.settings["bag"])
        self._clock = self.node.create_publisher(ClockMessage, names.CLOCK, 10) if self.settings["clock"] else None
        self._publishers = self._make_publishers(self._bag)
        self._thread = threading.Thread(target=self._play, name="replay")
        self._thread.start()

    @property
    def failure(self) -> str:
        """Why not all was played; empty when it was."""
        return self._failure

    def close(self) -> bool:
        """Stop playing."""
        self._stop.set()
        self._thread.join()
        return True

    def _make_publishers(self, bag: Bag) -> dict[str, Publisher]:
        wanted = [self._in_bag(bag, topic) for topic in self.settings["topics"] if topic]
        publishers, refused = {}, []
        for topic in bag.topics.values():
            if (wanted and topic.name not in wanted) or topic.encoding != "cdr":
                continue
            if self._clock is not None and topic.name == names.CLOCK:
                continue
            try:
                kind = message_class(topic.type)
            except SetupError as error:
                refused.append(str(error))
                self._log.warning(f"{topic.name} is not played: {error}")
                continue
            publishers[topic.name] = self.node.create_publisher(kind, topic.name, names.from_offered(topic.offered_qos))
        if not publishers:
            raise SetupError(refused[0]) if refused else DataError(f"{bag.path} has no topics; expected some to play")
        return publishers

    def _in_bag(self, bag: Bag, topic: str) -> str:
        for name in (topic, f"/{topic}"):
            if name in bag.topics:
                return name
        raise UsageError(f"{bag.path} has no topic {topic}; there are: {', '.join(sorted(bag.topics)) or 'none'}")

    def _play(self) -> None:
        try:
            self._wait_for_subscribers()
            again = True
            while again and not self._stop.is_set():
                self._play_once()
                again = self.settings["loop"]
            self._wait_until_taken()
        except Exception as error:  # reported at the end, as the one line of the program
            self._failure = str(error)
        self._log.info(f"played {counted(self.sent, 'message')} of {counted(len(self._publishers), 'topic')}")
        self._on_end()

    def _play_once(self) -> None:
        pace = ReplayRate(self.settings["rate"], self._stop)
        before = self.sent
        for entry in self._entries():
            if not pace.wait(entry.log_time_ns):
                return
            if isinstance(entry, Tick):
                assert self._clock is not None
                self._clock.publish(ClockMessage(clock=time_message(entry.log_time_ns)))
            else:
                self._publishers[entry.topic].publish(entry.data)
                self.sent += 1
        if self.sent == before:
            raise DataError(f"{self._bag.path} has no messages to play; expected some")

    def _entries(self) -> Iterable[RawMessage | Tick]:
        messages = self._bag.messages(self._publishers.keys())
        return with_ticks(messages, CLOCK_PERIOD_NS) if self._clock is not None else messages

    def _wait_for_subscribers(self) -> None:
        """Discovery takes a while; messages sent before it would reach nobody."""
        deadline = time.monotonic() + self.settings["wait"]
        while time.monotonic() < deadline and not self._stop.wait(0.02):
            if all(publisher.get_subscription_count() for publisher in self._publishers.values()):
                return

    def _wait_until_taken(self) -> None:
        """Let reliable subscriptions have the last messages before the publishers go."""
        for publisher in self._publishers.values():
            if publisher.qos_profile.reliability == ReliabilityPolicy.RELIABLE and not self._stop.is_set():
                publisher.wait_for_all_acked(Duration(seconds=2))
