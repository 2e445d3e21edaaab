"""Forces from the graph, and the dead man's switch: no force acts for longer than somebody stands behind it.

Whoever publishes ``force`` moves the rig, whatever QoS it offers. The force goes back to 0 when who commanded it is
gone from the graph, no longer asserts its liveliness, or is silent for ``command_timeout``; with
``hold_last_command`` the last command stays, as a user decides who sends one and leaves.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

from geometry_msgs.msg import WrenchStamped
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from msd_sim import names
from msd_sim.rig import Rig

NANO = 1_000_000_000
#: How often it is looked who stands behind the force [s].
LOOK = 0.05
#: Least time between two log lines of one kind [s].
QUIET = 5.0
#: Forces that are taken together at most.
HANDFUL = 100
#: How long after the last command a publisher that lost its liveliness may be missed [s]: another may push on.
GRACE = 0.3


class Commands:
    """The rig's ears.

    Args:
        node: the rig's.
        rig: that is pushed.
        values: the node's parameters, which may change.
        take: gets each force message once.
        release: puts the force to 0 from now on and gives the stamp [ns]; forgets the forces ahead.
    """

    def __init__(
        self,
        node: Node,
        rig: Rig,
        values: Callable[[], Mapping[str, Any]],
        take: Callable[[WrenchStamped], None],
        release: Callable[[], int],
    ) -> None:
        self._node, self._rig, self._values, self._take, self._release = node, rig, values, take, release
        self._eager = False
        self._topic = node.resolve_topic_name(names.FORCE)
        self._began_ns = time.time_ns()
        self._heard = self._began = time.monotonic()
        self._looked, self._alive, self._dropped = 0.0, 0, False
        self._latest: WrenchStamped | None = None
        self._announced: WrenchStamped | None = None
        self._own: Publisher | None = None
        # Who latches nothing is no match for it, and is heard by the other subscription: nothing to warn of.
        unmatched = SubscriptionEventCallbacks(incompatible_qos=lambda event: None)
        self._latched: Subscription | None = node.create_subscription(
            WrenchStamped, names.FORCE, self._on_latched, _quality(latched=True), event_callbacks=unmatched
        )
        eager = SubscriptionEventCallbacks(incompatible_qos=self._on_eager)
        self._listen(_quality(), self._on_force, event_callbacks=eager)
        self._guard: Subscription | None = None

    def _listen(self, quality: QoSProfile, take: Callable[[WrenchStamped], None], **options: Any) -> Subscription:
        """Hand over each force with those that wait behind it.

        An executor takes one for each of its rounds: a rig whose rounds are long would fall behind a fast sender.
        """

        def take_all(message: WrenchStamped) -> None:
            """Hand over a force, and those that came meanwhile."""
            take(message)
            with made.handle:
                for _ in range(HANDFUL):
                    if (taken := made.handle.take_message(made.msg_type, made.raw)) is None:
                        return
                    take(taken[0])

        made = self._node.create_subscription(WrenchStamped, names.FORCE, take_all, quality, **options)
        return made

    def _on_force(self, message: WrenchStamped) -> None:
        if message == self._announced:
            return  # what was announced here comes back
        self._take(message)
        self._latest, self._heard, self._dropped = message, time.monotonic(), False

    def _on_latched(self, message: WrenchStamped, info: Mapping[str, Any]) -> None:
        """Commands from before the rig began; later ones come to the other subscription, from all publishers."""
        if info["source_timestamp"] < self._began_ns:
            self._on_force(message)

    def _on_eager(self, _event: Any) -> None:
        """Somebody offers best effort only: listen to that, too. A command that comes twice does no harm."""
        if not self._eager:
            self._eager = True
            quality = _quality()
            quality.reliability = ReliabilityPolicy.BEST_EFFORT
            self._listen(quality, self._on_force)

    def _on_liveliness(self, event: Any) -> None:
        self._dropped = event.alive_count == 0 and (self._dropped or self._alive > 0)
        self._alive = event.alive_count

    def look(self) -> None:
        """Release the force when nobody stands behind it; to be called often."""
        now = time.monotonic()
        if now - self._looked < LOOK:
            return
        self._looked = now
        if self._latched is not None and now - self._began > names.LATECOMER:
            self._node.destroy_subscription(self._latched)  # publishers that latch nothing are warned of it
            self._latched = None
        if not (self._rig.pushed or self._own):
            return
        others = self._others()
        self._watch_life(any(_promises_life(one.qos_profile) for one in others))
        if self._rig.pushed and not self._values()["hold_last_command"]:
            why = self._reason(now, gone=not others)
            if why:
                self._let_go(why)
        unlatched = not others or any(one.qos_profile.durability == DurabilityPolicy.VOLATILE for one in others)
        if self._latest not in (None, self._announced) and (self._own or (self._rig.pushed and unlatched)):
            self._announce(self._latest)

    def _watch_life(self, promised: bool) -> None:
        """Listen for signs of life where somebody promises them, only then: other publishers are warned of it."""
        if promised and self._guard is None:
            watched = SubscriptionEventCallbacks(liveliness=self._on_liveliness, incompatible_qos=lambda event: None)
            quality = _quality()
            quality.liveliness = LivelinessPolicy.MANUAL_BY_TOPIC
            quality.liveliness_lease_duration = Duration(seconds=names.LEASE)
            self._guard = self._listen(quality, lambda _: None, event_callbacks=watched)
        elif not promised and self._guard is not None:
            self._node.destroy_subscription(self._guard)
            self._guard, self._alive = None, 0

    def _reason(self, now: float, gone: bool) -> str:
        """Why the force must not go on; empty when it may."""
        silent, timeout = now - self._heard, float(self._values()["command_timeout"])
        if gone:
            return "who commanded it is gone"
        if self._alive:
            return ""
        if self._dropped and silent > GRACE:
            return "its publisher no longer asserts its liveliness"
        return f"no command for {silent:.1f} s" if 0.0 < timeout < silent else ""

    def _let_go(self, why: str) -> None:
        message = WrenchStamped()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(self._release(), NANO)
        self._announce(message)
        self._latest = message
        self._node.get_logger().warning(
            f"force 0: {why}; expected a publisher that keeps sending (ros2 topic pub -r 10), or hold_last_command",
            throttle_duration_sec=QUIET,
        )

    def _announce(self, message: WrenchStamped) -> None:
        """Publish the command that acts, so that whoever comes later knows it."""
        if self._own is None:
            # The rig's own guard asks for signs of life and gets none from the rig: nothing to warn of.
            unmatched = PublisherEventCallbacks(incompatible_qos=lambda event: None)
            quality = _quality(latched=True, depth=1)
            self._own = self._node.create_publisher(WrenchStamped, names.FORCE, quality, event_callbacks=unmatched)
        self._announced = message
        self._own.publish(message)

    def _others(self) -> list[Any]:
        """Publishers of the force that are not the rig."""
        found = self._node.get_publishers_info_by_topic(self._topic)
        own = (self._node.get_name(), self._node.get_namespace())
        return [one for one in found if (one.node_name, one.node_namespace) != own]


def _promises_life(profile: QoSProfile) -> bool:
    """Whether a publisher promises signs of life that the rig can hold it to."""
    lease = profile.liveliness_lease_duration.nanoseconds
    return profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC and 0 < lease <= names.LEASE * NANO


def _quality(latched: bool = False, depth: int = names.DEPTH) -> QoSProfile:
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
