"""Plays a profile on the graph: forces at their instants, limits checked on every reading, everything recorded."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from msd_ident.design import Limits, Profile
from msd_ident.errors import SetupError
from msd_ident.io.reader import FORCE_UNIT
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import nanoseconds, time_message
from msd_ident.ros.common.message_batching import subscribe, waiting
from msd_ident.ros.experimenter.late_forces import Late, LateForces
from msd_ident.ros.experimenter.safety_monitor import SafetyMonitor
from msd_ident.ros.recorder.recording import Recording
from msd_interfaces.msg import EncoderBatch

#: Longest wait for a rig that answers, and for a cart that comes to rest [s].
ANSWER, REST = 5.0, 10.0
#: How long before its instant a force is sent, where nothing else is said [s].
LEAD = 0.05
#: The cart rests when its readings stay within this part of the travel for this long [s].
_STILL, _STILL_SECONDS = 2e-3, 0.3
_RESET = "rig/reset"
#: Why an experiment ended that its caller cancelled.
CANCELLED = "cancelled"
_NAP = 0.0005

_KINDS: tuple[tuple[str, Any], ...] = (
    (names.FORCE, WrenchStamped),
    (names.ENCODER, JointState),
    (names.ENCODER_BATCH, EncoderBatch),
)

Advance = Callable[[float, float, float], None]
Take = Callable[[bytes, object], None]


@dataclass(frozen=True)
class Played:
    """What came of a profile.

    Attributes:
        bag: what was recorded.
        stopped: why it ended early; empty when it did not.
        commands: forces sent.
        worst, mean: delay of a command [s].
        late: forces that the rig had after their instants, as far as it tells.
    """

    bag: Path
    stopped: str
    commands: int
    worst: float
    mean: float
    late: Late = Late()

    @property
    def sentence(self) -> str:
        """For people."""
        what = f"stopped, force 0: {self.stopped}" if self.stopped else "played to its end"
        delays = (
            f"{self.commands} commands, {1e3 * self.mean:.2f} ms late on average and {1e3 * self.worst:.2f} at worst"
        )
        return "; ".join(filter(None, (what, delays, str(self.bag), self.late.sentence)))


@dataclass(frozen=True)
class Experiment:
    """What to play.

    Attributes:
        profile: of the force.
        limits: of the rig.
        bag: folder for what is recorded; it must not exist.
        reset: whether the rig is reset before.
    """

    profile: Profile
    limits: Limits
    bag: Path
    reset: bool = False


class ProfilePlayer:
    """Plays profiles with a node that somebody else spins.

    Args:
        node: to publish and listen with; its names decide which rig.
        silence: longest time without a reading [s].
        lead: how long before its instant a force is sent [s]: a rig that acts by stamps then acts in time, however busy
            the machine; 0 for one that acts when a force comes.
    """

    def __init__(self, node: Node, silence: float = 0.5, lead: float = LEAD) -> None:
        self._node, self._silence, self._lead = node, silence, lead
        self._ahead: deque[int] = deque(maxlen=10_000)
        self._force = node.create_publisher(WrenchStamped, names.FORCE, names.command_qos())
        self._lock = threading.Lock()
        self._guard: SafetyMonitor | None = None
        self._recording: Recording | None = None
        self._latest: tuple[int, float] | None = None
        self._delay = 0.0  # of the latest reading when it came [s]
        self._unheard: WrenchStamped | None = None  # the last command, until it comes back
        self._halted = False
        self._listening: list[tuple[Subscription, Take]] = []
        self._alone = threading.Event()

    def play(self, experiment: Experiment, stop: threading.Event, advance: Advance) -> Played:
        """Play an experiment to its end, or until a limit, silence or ``stop`` ends it with force 0.

        Raises:
            UsageError: the profile is beyond the limits, or the bag exists; nothing has moved.
            SetupError: no rig answers; nothing has moved.
        """
        experiment.limits.check(experiment.profile)
        self._listening = [self._listen(topic, kind) for topic, kind in _KINDS]
        self._late = LateForces(self._node)
        try:
            self._wait_for_rig()
            if experiment.reset:
                self._reset()
            self._wait_for_rest(experiment.limits, stop)
            return self._conduct(experiment, stop, advance)
        finally:
            for subscription, _ in self._listening:
                self._node.destroy_subscription(subscription)
            self._listening = []
            self._late.close()

    def _conduct(self, experiment: Experiment, stop: threading.Event, advance: Advance) -> Played:
        bag = experiment.bag
        recording = self._record(bag, experiment.profile.unit)
        guard = SafetyMonitor(experiment.limits, self._silence)  # before the bag, which may take a while to begin
        with self._lock:
            self._halted, self._guard, self._recording = False, guard, recording
        delays: list[float] = []
        self._late.begin()
        try:
            self._send(experiment.profile, guard, stop, advance, delays)
        finally:
            self._halt()
            with self._lock:
                self._guard = None
            self._catch_up(REST)
            with self._lock:
                self._recording = None
            summary = recording.close()
        if summary.error:
            raise SetupError(f"{bag}: {summary.error}; expected a disk that takes the bag")
        worst, mean = (max(delays), sum(delays) / len(delays)) if delays else (0.0, 0.0)
        return Played(bag, guard.reason, len(delays), worst, mean, self._late.found)

    def close(self) -> None:
        """Leave the rig without force."""
        self._halt()

    def leave(self) -> None:
        """Nobody spins the node any more: what still comes is taken by the thread that plays."""
        self._alone.set()

    def _send(
        self, profile: Profile, guard: SafetyMonitor, stop: threading.Event, advance: Advance, delays: list[float]
    ) -> None:
        clock = self._node.get_clock()
        lead = round(self._lead * 1e9)
        start = clock.now().nanoseconds + lead + 20_000_000
        reported, due, usual = 0.0, start, self._delay
        for at, force in zip(*profile.commands, strict=True):
            due = start + round(float(at) * 1e9)
            while (left := due - lead - clock.now().nanoseconds) > 0:
                if stop.is_set():
                    guard.stop(CANCELLED)
                if self._delay > usual + self._silence:
                    guard.stop(f"the encoder's readings come {self._delay - usual:.2f} s later than before")
                if guard.reason or guard.silent():
                    return
                if time.monotonic() - reported > 0.1:
                    reported = time.monotonic()
                    self._force.assert_liveliness()  # the rig lets go of a force that nobody stands behind
                    played = 1.0 - left / 1e9 / profile.duration
                    advance(min(max(min(float(at) / profile.duration, played), 0.0), 1.0), float(force), guard.position)
                time.sleep(min(left / 1e9, _NAP))
            with self._lock:
                if self._halted:
                    return
                now = clock.now().nanoseconds
                self._push(float(force), max(now, due))
            delays.append(max(now - due, 0) / 1e9)
        while not guard.reason and not guard.silent() and clock.now().nanoseconds < due:
            self._force.assert_liveliness()
            if stop.is_set():
                guard.stop(CANCELLED)
            time.sleep(_NAP)

    def _halt(self) -> None:
        """Force 0, now and from whatever thread, in the place of every force that was sent ahead too."""
        with self._lock:
            self._halted = True
            now = int(self._node.get_clock().now().nanoseconds)
            ahead = [stamp for stamp in self._ahead if stamp > now]
            self._ahead.clear()
            for stamp in (now, *ahead):
                self._push(0.0, stamp)
            self._ahead.clear()

    def _push(self, newtons: float, stamp: int) -> None:
        """Send a force that acts from a stamp [ns] on."""
        message = WrenchStamped()
        message.header.stamp = time_message(stamp)
        message.wrench.force.x = newtons
        self._unheard = message
        self._force.publish(message)
        self._ahead.append(stamp)

    def _listen(self, topic: str, kind: Any) -> tuple[Subscription, Take]:
        name = self._node.resolve_topic_name(topic)
        qos = names.force_qos() if topic == names.FORCE else names.encoder_qos()

        def take(raw: bytes, _info: object) -> None:
            """Record a message, and watch the encoder's."""
            recording = self._recording
            if recording is not None:
                now = self._node.get_clock().now().nanoseconds
                recording.put(name, raw, now, now)
            message, waited = deserialize_message(raw, kind), self._unheard
            if kind is not WrenchStamped:
                self._watch(message)
            elif message == waited:
                with self._lock:
                    if self._unheard is waited:  # no other command was sent meanwhile
                        self._unheard = None

        return subscribe(self._node, kind, topic, take, qos, raw=True), take

    def _watch(self, message: Any) -> None:
        stamp = nanoseconds(message.header.stamp)
        guard = self._guard
        if isinstance(message, JointState):
            readings = [(stamp, float(message.position[0]))]
        else:
            readings = [(stamp + i * message.period_ns, float(x)) for i, x in enumerate(message.positions)]
        for at, position in readings:
            self._latest = (at, position)
            self._delay = self._lag()
            if guard is not None and not guard.reading(at, position) and not self._halted:
                self._halt()

    def _record(self, bag: Path, unit: str) -> Recording:
        """A recording whose bag tells the force's unit, which the messages have no place for."""
        recording = Recording(bag, custom_data={FORCE_UNIT: unit})
        for topic in (names.FORCE, names.ENCODER, names.ENCODER_BATCH):
            name = self._node.resolve_topic_name(topic)
            publishers = self._node.get_publishers_info_by_topic(name)
            if publishers:
                offered = [names.to_offered(one.qos_profile) for one in publishers]
                recording.add_topic(name, names.TYPES[topic], offered)
        return recording

    def _wait_for_rig(self) -> None:
        self._latest, self._unheard = None, None
        name = self._node.resolve_topic_name(names.FORCE)
        _until(
            lambda: self._latest is not None and self._node.count_subscribers(name) > 1,
            ANSWER,
            f"no rig answers: nothing listens to {name}, or no encoder reading came in {ANSWER:g} s; expected a rig "
            "that runs, under the same namespace: start it, or say --namespace",
        )

        self._catch_up(ANSWER)

    def _catch_up(self, most: float) -> None:
        """Wait until the last command and the readings up to this instant have come; at most so long [s].

        Both may still lie in queues. No reading is waited for when the rig has fallen silent, nor where its stamps are
        further away than that: they are of another clock.
        """
        until, own_clock = int(self._node.get_clock().now().nanoseconds), abs(self._lag()) < most
        deadline, before, since = time.monotonic() + most, 0, time.monotonic()
        while time.monotonic() < deadline:
            if self._alone.is_set():
                for subscription, take in self._listening:
                    for taken in waiting(subscription):
                        take(*taken)
            stamp = self._latest[0] if self._latest else 0
            read = not own_clock or stamp >= until or time.monotonic() - since > self._silence
            if read and self._unheard is None:
                return
            if stamp != before:
                before, since = stamp, time.monotonic()
            time.sleep(0.01)
        if self._unheard is not None:
            self._node.get_logger().warning(
                f"the last command did not come back in {most:g} s: the bag may lack its end"
            )

    def _lag(self) -> float:
        """How far the latest reading is behind the clock [s]; of another clock, any constant."""
        latest = self._latest
        return (self._node.get_clock().now().nanoseconds - latest[0]) / 1e9 if latest else 0.0

    def _reset(self) -> None:
        client = self._node.create_client(Trigger, _RESET)
        try:
            if client.wait_for_service(timeout_sec=1.0):
                future = client.call_async(Trigger.Request())
                _until(future.done, ANSWER, f"{_RESET} gave no answer in {ANSWER:g} s; expected one: restart the rig")
        finally:
            self._node.destroy_client(client)

    def _wait_for_rest(self, limits: Limits, stop: threading.Event) -> None:
        """Force 0 until the cart stands still, so that every experiment begins at rest."""
        with self._lock:
            self._push(0.0, int(self._node.get_clock().now().nanoseconds))
        band = _STILL * (limits.travel[1] - limits.travel[0])
        deadline, since, at = time.monotonic() + REST, time.monotonic(), self._latest
        while time.monotonic() - since < _STILL_SECONDS and not stop.is_set():
            latest = self._latest
            if latest is not None and (at is None or abs(latest[1] - at[1]) > band):
                since, at = time.monotonic(), latest
            if time.monotonic() > deadline:
                raise SetupError(
                    f"the cart does not come to rest in {REST:g} s without force; expected it to stand still"
                )
            time.sleep(0.01)


def _until(condition: Callable[[], object], seconds: float, otherwise: str) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise SetupError(otherwise)
        time.sleep(0.01)
