"""A rig's measurements, sent sample by sample to the real identifier and recorder, all in one process on one domain."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState

from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import time_message
from msd_ident.ros.common.node_runner import Spinner
from msd_ident.ros.identifier.node import Identifier
from msd_ident.ros.recorder.node import Recorder
from msd_interfaces.srv import Identify
from msd_sim import config
from msd_sim.encoder import EncoderReader
from msd_sim.rig import Rig

#: Samples a second, the period [ns], and how many the identifier keeps.
RATE, PERIOD_NS, KEPT = 100, 10_000_000, 300
#: The paper's rig, and a force that goes up and down [N], after so many samples.
TRUTH = {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1, "friction_coefficient": 0.0133}
ENCODER = {"counts_per_metre": 226600.0}
FORCE, HELD = 10.425, 150
#: What a refined parameter may be off, as a part of the truth.
EXACT = 0.01
#: Residual, in noise floors, from which on an estimate doubts itself, and how often it is asked for again.
#: Windows that begin a period of the force apart are one window: so many more samples are sent each time.
DOUBTED, ASKED, FURTHER = 2.0, 3, 70
#: Samples sent before it is waited until they are heard.
TOGETHER = 100

#: Fast DDS hands messages within a process over directly. After some 200 clients were made and destroyed there, its
#: version 2.14.5 gives a participant no answers of a service any more. Nodes of a lab are processes of their own.
BETWEEN_PROCESSES = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <library_settings><intraprocess_delivery>OFF</intraprocess_delivery></library_settings>
</dds>
"""

Change = Callable[[JointState, int], list[JointState]]


class Failed(Exception):
    """A node did not do what it must."""


class World:
    """Nodes, what they say, and a rig that goes on whatever happens to its messages.

    Attributes:
        tester: node that publishes and asks.
        identifier, recorder: the real nodes.
        offset_ns: of the stamps against the rig's clock.
        bags: folder that requests may name things in.
    """

    def __init__(self, domain: int, folder: Path, **settings: object) -> None:
        self.contexts = (rclpy.Context(), rclpy.Context())  # the tester is a participant of its own, as in life
        for context in self.contexts:
            rclpy.init(context=context, domain_id=domain)
        self.bags, self.domain = folder, domain
        common = {"bag_folder": str(folder), "diagnostics_period": 0.1, "remember": 0.4}
        own = {**common, "buffer_samples": KEPT, "auto_fit": False, **settings}
        self.tester = Node("tester", context=self.contexts[0])
        self.identifier = Identifier(_parameters(own), context=self.contexts[1])
        self.recorder = Recorder(_parameters(common), context=self.contexts[1])
        self.health: dict[str, DiagnosticStatus] = {}
        self.said: list[str] = []
        self.offset_ns = 1_700_000_000 * 10**9
        self.sent = self.pushed = 0
        self.tester.create_subscription(DiagnosticArray, names.DIAGNOSTICS, self._hear, 100)
        self._spinners = [Spinner(node) for node in (self.tester, self.identifier.node, self.recorder.node)]
        rig = config.parse(TRUTH | {"encoder": ENCODER, "rate": float(RATE)})
        self._rig, self._reader = Rig(rig.truth), EncoderReader(rig.encoder)
        self._tick = 0
        ready: list[bool] = []
        self.identifier.worker.submit(lambda: ready.append(True))
        self.until(lambda: ready, "the solver to be compiled", 300.0)
        self.force = self.publish_force()
        self.encoder = self.publish_encoder()

    def publish_force(self) -> Publisher:
        """A publisher of the force that the nodes hear."""
        return self._matched(self.tester.create_publisher(WrenchStamped, names.FORCE, names.force_qos()))

    def publish_encoder(self) -> Publisher:
        """A publisher of the encoder that the nodes hear."""
        return self._matched(self.tester.create_publisher(JointState, names.ENCODER, names.encoder_qos()))

    def release(self, client: ActionClient) -> None:
        """Destroy a client of the tester between two waits of its executor, which would not bear it during one."""
        released = self._spinners[0].executor.create_task(client.destroy)
        self.until(released.done, "an action client to be released")

    @contextmanager
    def stranger(self) -> Iterator[Node]:
        """A node of somebody else: a participant of its own."""
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=self.domain)
        node = Node("stranger", context=context)
        try:
            yield node
        finally:
            node.destroy_node()
            rclpy.shutdown(context=context)

    def feed(self, samples: int, change: Change = lambda message, index: [message], together: int = TOGETHER) -> None:
        """So many samples of the rig, each as ``change`` makes it, and the forces that act meanwhile; all heard."""
        for begin in range(0, samples, together):
            for index in range(begin, min(begin + together, samples)):
                for message in change(self._sample(), index):
                    self.send(message)
            self.until(lambda: self.heard() >= self.sent, "the samples to be heard")
            self.until(lambda: self._forces_heard() >= self.pushed, "the forces to be heard")

    def push(self, stamp_ns: int, newtons: float) -> None:
        """Publish on the force's topic."""
        message = WrenchStamped()
        message.header.stamp = time_message(stamp_ns)
        message.wrench.force.x = newtons
        self.force.publish(message)
        self.pushed += 1

    def send(self, message: JointState) -> None:
        """Publish on the encoder's topic."""
        self.encoder.publish(message)
        self.sent += 1

    def pass_time(self, seconds: float) -> None:
        """The rig goes on for so long and nobody hears of it."""
        for _ in range(round(seconds * RATE)):
            self._sample()

    def heard(self) -> int:
        """Messages that the identifier took from the encoder's topic."""
        return self.identifier.inputs["position"][0].count.received

    def _forces_heard(self) -> int:
        return self.identifier.inputs["force"][0].count.received

    def call(self, kind: Any, name: str, request: Any, count: int = 1, seconds: float = 60.0) -> list[Any]:
        """Answers of a service, called so many times at once."""
        client = self.tester.create_client(kind, name, qos_profile=names.service_qos())
        futures: list[Any] = []
        try:
            self.until(client.service_is_ready, f"service {name}")
            futures = [client.call_async(request) for _ in range(count)]
            self.until(lambda: all(future.done() for future in futures), f"answers of {name}", seconds)
            return [future.result() for future in futures]
        except Failed as error:
            answered = sum(future.done() for future in futures)
            raise Failed(f"{error}; {answered} of {count} answered") from None
        finally:
            self.tester.destroy_client(client)

    def within(self, work: Callable[[], Any]) -> Any:
        """Do something in the thread that spins the tester, and wait for it.

        An action client loses an answer that comes before it has noted the request: it has no lock for that.
        """
        done = self._spinners[0].executor.create_task(work)
        self.until(done.done, "the tester")
        return done.result()

    def expect(self, true: bool, otherwise: str) -> None:
        """What must hold.

        Raises:
            Failed: it does not.
        """
        if not true:
            raise Failed(otherwise)

    def wait_said(self, words: str) -> str:
        """The sentence with these words on ``/diagnostics``; it may have been said since the last ``forget``."""
        self.until(lambda: any(words in sentence for sentence in self.said), f"{words!r} on /diagnostics")
        return next(sentence for sentence in self.said if words in sentence)

    def forget(self) -> None:
        """What was said so far does not count any more."""
        self.said.clear()

    def recover(self) -> None:
        """Good samples until nothing else is left: the data is well again, and the numbers are the truth."""
        self.feed(KEPT + TOGETHER)
        self.until(self._well_while_fed, "the data to be well again")
        for _ in range(ASKED):
            (answer,) = self.call(Identify, names.IDENTIFY, Identify.Request())
            if not answer.success:
                raise Failed(f"no estimate after it: {answer.message}")
            if answer.estimate.see_refined < DOUBTED * answer.estimate.noise_floor:
                break
            self.feed(FURTHER)  # an estimate that says of itself that something is missing: another window
        found = {parameter.name: parameter.value for parameter in answer.estimate.refined}
        for name in ("mass", "stiffness"):
            if abs(found[name] / TRUTH[name] - 1.0) > EXACT:
                raise Failed(f"{name} is {found[name]:.4g} after it; expected {TRUTH[name]:g}")

    def _well_while_fed(self) -> bool:
        """Whether the data is said to be well; samples go on, or a quick machine would soon call them silent."""
        well = self._level("identifier: data") == DiagnosticStatus.OK
        if not well:
            self.feed(TOGETHER)
            time.sleep(0.05)
        return well

    def until(self, condition: Callable[[], object], what: str, seconds: float = 30.0) -> None:
        """Wait for a condition.

        Raises:
            Failed: it does not come true in time, or a node's callback raised.
        """
        deadline = time.monotonic() + seconds
        while not condition():
            if any(spinner.failed for spinner in self._spinners):
                raise Failed("a callback raised: see stderr")
            if time.monotonic() > deadline:
                raise Failed(f"waited {seconds:g} s for {what}; last said: {self.said[-1:]}")
            time.sleep(0.005)

    def close(self) -> None:
        """Take everything down."""
        for spinner in self._spinners:
            spinner.stop()
        self.identifier.close()
        self.recorder.close()
        for node in (self.identifier.node, self.recorder.node, self.tester):
            node.destroy_node()
        for context in self.contexts:
            rclpy.shutdown(context=context)

    def _sample(self) -> JointState:
        """The rig's next sample; the force that begins with it goes out first."""
        at = self._tick * PERIOD_NS
        if self._tick % HELD == 0:
            newtons = FORCE if (self._tick // HELD) % 2 else 0.0
            self._rig.push(at / 1e9, newtons)
            self.push(at + self.offset_ns, newtons)
        position = self._reader.read(self._rig.sample([at / 1e9]).position)
        self._tick += 1
        made = JointState(name=["cart"], position=position.tolist())
        made.header.stamp = time_message(at + self.offset_ns)
        return made

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.health[status.name] = status
            if status.level != DiagnosticStatus.OK:
                self.said.append(f"{status.name}: {status.message}")
        del self.said[:-1000]

    def _level(self, name: str) -> bytes | None:
        status = self.health.get(name)
        return status.level if status else None

    def _matched(self, publisher: Publisher) -> Publisher:
        self.until(publisher.get_subscription_count, "the identifier to listen")
        return publisher


def as_between_processes(folder: Path) -> None:
    """Let this process's nodes talk as processes do. Call it before the first node is made.

    Args:
        folder: for the settings of Fast DDS; exists.
    """
    settings = folder / "between_processes.xml"
    settings.write_text(BETWEEN_PROCESSES, encoding="utf-8")
    os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(settings)


@contextmanager
def world(domain: int, folder: Path, **settings: object) -> Iterator[World]:
    """A world for the block."""
    made = World(domain, folder, **settings)
    try:
        yield made
    finally:
        with suppress(Failed):
            made.close()


def _parameters(values: dict[str, object]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in values.items()]
