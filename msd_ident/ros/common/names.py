"""Topics, services, types and QoS of the graph, written once. Relative names: a namespace or a remap moves them."""

from __future__ import annotations

from typing import Final

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from msd_ident.io import OfferedQos
from msd_ident.io.qos import INFINITE_NS

FORCE: Final = "force"
ENCODER: Final = "encoder"
ENCODER_BATCH: Final = "encoder_batch"
ESTIMATE: Final = "identifier/estimate"
IDENTIFY: Final = "identifier/identify"
TRIGGER: Final = "identifier/trigger"
DIAGNOSE: Final = "identifier/diagnose"
DIAGNOSIS: Final = "identifier/diagnosis"
RECORDER_START: Final = "recorder/start"
RECORDER_STOP: Final = "recorder/stop"
RUN: Final = "experimenter/run"
CLEAR: Final = "identifier/clear"
DIAGNOSTICS: Final = "/diagnostics"
CLOCK: Final = "/clock"

#: Types of the topics that everybody knows; of others the graph tells.
TYPES: Final = {
    FORCE: "geometry_msgs/msg/WrenchStamped",
    ENCODER: "sensor_msgs/msg/JointState",
    ENCODER_BATCH: "msd_interfaces/msg/EncoderBatch",
}

#: Fewest messages a subscription to measurements holds back: a finite queue loses silently, even RELIABLE.
LEAST_DEPTH: Final = 1000


#: Messages that a replay keeps for a subscriber that stalls.
REPLAY_DEPTH: Final = 10_000


def force_qos(depth: int = LEAST_DEPTH) -> QoSProfile:
    """Late joiners know the present force."""
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


#: Longest time between two signs of life of who commands a force [s].
LEASE: Final = 1.0


def private(name: str) -> str:
    """A name as its node gives it: private, so that another name of the node, or another namespace, carries it."""
    return f"~/{name.partition('/')[2]}"


def status_name(namespace: str, node: str, what: str) -> str:
    """Name of a status on ``/diagnostics``: the node with its namespace, then what it tells about."""
    return f"{namespace.strip('/')}/{node}: {what}".lstrip("/")


def command_qos() -> QoSProfile:
    """Of who commands a force: late joiners know it, and the rig lets go when its sender shows no life."""
    profile = force_qos()
    profile.liveliness = LivelinessPolicy.MANUAL_BY_TOPIC
    profile.liveliness_lease_duration = Duration(seconds=LEASE)
    return profile


def encoder_qos(depth: int = LEAST_DEPTH) -> QoSProfile:
    """Every sample counts; the depth bridges a stall of the subscriber."""
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)


def latest_qos() -> QoSProfile:
    """The last result, also for those who come later."""
    return QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def service_qos() -> QoSProfile:
    """Many may ask at once: a queue of ten, the usual one, loses the others without a word."""
    return QoSProfile(depth=LEAST_DEPTH, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)


def matching_qos(offered: list[QoSProfile], depth: int) -> QoSProfile:
    """Profile of a subscription that gets everything from all these publishers: their strongest common promise."""
    reliable = all(profile.reliability == ReliabilityPolicy.RELIABLE for profile in offered)
    kept = all(profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for profile in offered)
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable and offered else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if kept and offered else DurabilityPolicy.VOLATILE,
    )


def asks_for_more(has: QoSProfile, may: QoSProfile) -> bool:
    """Whether a subscription with one profile asks for more than the other does."""
    lasting = has.durability == DurabilityPolicy.TRANSIENT_LOCAL and may.durability == DurabilityPolicy.VOLATILE
    reliable = has.reliability == ReliabilityPolicy.RELIABLE and may.reliability == ReliabilityPolicy.BEST_EFFORT
    return lasting or reliable


def to_offered(profile: QoSProfile) -> OfferedQos:
    """A profile as a bag keeps it."""
    return OfferedQos(
        reliability=profile.reliability.name.lower(),
        durability=profile.durability.name.lower(),
        history=profile.history.name.lower(),
        depth=profile.depth,
        deadline_ns=_nanoseconds(profile.deadline),
        lifespan_ns=_nanoseconds(profile.lifespan),
        liveliness=profile.liveliness.name.lower(),
        liveliness_lease_ns=_nanoseconds(profile.liveliness_lease_duration),
        avoid_ros_namespace_conventions=profile.avoid_ros_namespace_conventions,
    )


def from_offered(profiles: tuple[OfferedQos, ...], least_depth: int = REPLAY_DEPTH) -> QoSProfile:
    """Profile of a publisher that replays what these offered.

    The depth, which no subscriber sees, is at least ``least_depth``, so that a fast replay loses nothing. Of
    several publishers the replay offers the strongest promise, which fits every subscription that fitted before.
    """
    if not profiles:
        return QoSProfile(depth=least_depth)
    lasting = any(profile.durability == "transient_local" for profile in profiles)
    eager = all(profile.reliability == "best_effort" for profile in profiles)
    first = profiles[0]
    by_topic = first.liveliness == "manual_by_topic"
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=max(least_depth, *(profile.depth for profile in profiles)),
        reliability=ReliabilityPolicy.BEST_EFFORT if eager else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
        deadline=_duration(first.deadline_ns),
        lifespan=_duration(first.lifespan_ns),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if by_topic else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=_duration(first.liveliness_lease_ns),
        avoid_ros_namespace_conventions=first.avoid_ros_namespace_conventions,
    )


def _nanoseconds(duration: Duration) -> int:
    ns = int(duration.nanoseconds)
    return INFINITE_NS if ns <= 0 else min(ns, INFINITE_NS)


def _duration(ns: int) -> Duration:
    """No limit is written as 0 here: rmw's default."""
    return Duration(nanoseconds=0 if ns >= INFINITE_NS else ns)
