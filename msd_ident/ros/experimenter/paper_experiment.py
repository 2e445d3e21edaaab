"""Plays the paper's experiment on a running graph, with recorder and identifier."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from msd_ident.errors import DataError, SetupError
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import nanoseconds, time_message
from msd_interfaces.msg import EncoderBatch, Estimate
from msd_interfaces.srv import Identify, StartRecording

#: Longest wait for anything that should take a second [s]; a first start compiles for a while.
LONGEST_WAIT = 180.0

Watch = Callable[[], None]
Advance = Callable[[float], None]


@dataclass(frozen=True)
class Plan:
    """Force steps, in seconds of the rig's time.

    Attributes:
        force: of the step [N].
        rest: before the step.
        up: with the force.
        down: without it, at the end.
        lead: how long before the first rest the forces are sent, so that none comes late.
    """

    force: float
    rest: float
    up: float
    down: float
    lead: float

    @property
    def duration(self) -> float:
        """From the first rest to the end."""
        return self.rest + self.up + self.down


class Player:
    """A node that moves the rig, starts and stops the recorder, and asks the identifier.

    Args:
        node: to do it with; somebody else spins it.
        watch: called while waiting; raises when there is nothing to wait for any more.
    """

    def __init__(self, node: Node, watch: Watch) -> None:
        self._node = node
        self._watch = watch
        self._now_ns = 0
        self._health: dict[str, DiagnosticStatus] = {}
        self._force = node.create_publisher(WrenchStamped, names.FORCE, names.command_qos())
        node.create_subscription(JointState, names.ENCODER, self._on_encoder, names.encoder_qos())
        node.create_subscription(EncoderBatch, names.ENCODER_BATCH, self._on_batch, names.encoder_qos())
        node.create_subscription(DiagnosticArray, names.DIAGNOSTICS, self._on_diagnostics, 100)

    def wait_for_all(self) -> None:
        """Until the rig answers, and recorder and identifier are ready."""
        self._until(lambda: self._now_ns, "the rig's encoder")
        self._until(self._rig_listens, "the rig to listen")
        self._push(self._now_ns, 0.0)
        self._until(
            lambda: self._count("identifier", "data", "position samples"), "the identifier to receive the encoder"
        )
        self._until(lambda: self._count("identifier", "data", "force samples"), "the identifier to receive the force")

    def record(self, folder: str) -> str:
        """Start a recording of force and encoder; its path."""
        topics = [names.FORCE, names.ENCODER, names.ENCODER_BATCH, names.ESTIMATE]
        answer = self._call(StartRecording, names.RECORDER_START, StartRecording.Request(folder=folder, topics=topics))
        self._until(lambda: self._recorded(names.FORCE), "the recorder to receive the force")
        encoders = (names.ENCODER, names.ENCODER_BATCH)
        self._until(lambda: any(map(self._recorded, encoders)), "the recorder to receive the encoder")
        return str(answer.path)

    def play(self, plan: Plan, advance: Advance) -> None:
        """Send the forces, stamped ahead, and wait for the end; ``advance`` gets the part that is done (0 to 1)."""
        start = self._now_ns
        begin = start + _ns(plan.rest + plan.lead)
        end = begin + _ns(plan.up + plan.down)
        # Both at once: were this process held up between them, the second would come when its instant has passed.
        self._push(begin, plan.force)
        self._push(begin + _ns(plan.up), 0.0)

        def over() -> bool:
            advance(min((self._now_ns - start) / (end - start), 1.0))
            return self._now_ns > end

        self._until(over, "the end of the experiment", LONGEST_WAIT + plan.duration)

    def stop_recording(self) -> str:
        """Close the bag; what it holds, in a sentence."""
        return str(self._call(Trigger, names.RECORDER_STOP, Trigger.Request()).message)

    def identify(self, bag_path: str = "", start: float = 0.0, end: float = 0.0) -> Estimate:
        """The identifier's estimate from the bag, or from its live buffer."""
        request = Identify.Request(bag_path=bag_path, start=start, end=end)
        return self._call(Identify, names.IDENTIFY, request).estimate

    def _rig_listens(self) -> bool:
        """Whether a node that publishes the encoder listens to the force, and this node knows all who listen.

        Recorder and identifier listen, too; on a busy machine they are found seconds before the rig.
        """
        listening = self._node.get_subscriptions_info_by_topic(self._node.resolve_topic_name(names.FORCE))
        rigs = {
            (publisher.node_namespace, publisher.node_name)
            for topic in (names.ENCODER, names.ENCODER_BATCH)
            for publisher in self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(topic))
        }
        # The rig has another subscription for commands from before it began, which it ends soon.
        lasting = [one for one in listening if one.qos_profile.durability == DurabilityPolicy.VOLATILE]
        return any(
            (one.node_namespace, one.node_name) in rigs for one in lasting
        ) and self._force.get_subscription_count() >= len(listening)

    def _push(self, at_ns: int, newtons: float) -> None:
        message = WrenchStamped()
        message.header.stamp = time_message(at_ns)
        message.wrench.force.x = newtons
        self._force.publish(message)

    def _on_encoder(self, message: JointState) -> None:
        self._now_ns = nanoseconds(message.header.stamp)

    def _on_batch(self, message: EncoderBatch) -> None:
        self._now_ns = nanoseconds(message.header.stamp) + message.period_ns * (len(message.positions) - 1)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self._health.update({status.name: status for status in message.status})

    def _count(self, node: str, what: str, key: str) -> int:
        """A number that a node of the same namespace tells about itself."""
        found = self._health.get(names.status_name(self._node.get_namespace(), node, what))
        return next((int(pair.value) for pair in found.values if pair.key == key), 0) if found else 0

    def _recorded(self, topic: str) -> int:
        return self._count("recorder", "bag", self._node.resolve_topic_name(topic))

    def _call(self, kind: Any, name: str, request: Any) -> Any:
        client = self._node.create_client(kind, name)
        try:
            self._until(client.service_is_ready, f"the service {name}")
            future = client.call_async(request)
            self._until(future.done, f"the answer of {name}")
            answer = future.result()
        finally:
            self._node.destroy_client(client)
        if not answer.success:
            raise DataError(f"{name}: {answer.message}")
        return answer

    def _until(self, condition: Callable[[], object], what: str, seconds: float = LONGEST_WAIT) -> None:
        deadline = time.monotonic() + seconds
        while not condition():
            self._watch()
            self._force.assert_liveliness()
            if time.monotonic() > deadline:
                raise SetupError(
                    f"waited {seconds:.0f} s for {what}; expected it within a few: see the logs beside the bag"
                )
            time.sleep(0.01)


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
