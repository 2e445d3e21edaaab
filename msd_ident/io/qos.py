"""Quality-of-service profiles as rosbag2 writes them, without ROS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from msd_ident.io import yaml_text

#: Longest duration that rmw knows, which means "no limit" [ns].
INFINITE_NS = 9223372036_854775807

# Before metadata version 9 the policies were numbers: those of the rmw_qos_*_policy_t enumerations.
_HISTORY = ("system_default", "keep_last", "keep_all", "unknown")
_RELIABILITY = ("system_default", "reliable", "best_effort", "unknown", "best_available")
_DURABILITY = ("system_default", "transient_local", "volatile", "unknown", "best_available")
_LIVELINESS = ("system_default", "automatic", "manual_by_node", "manual_by_topic", "unknown", "best_available")


@dataclass(frozen=True)
class OfferedQos:
    """What one publisher offered; policy names in lower case as in ``metadata.yaml``, durations in ns."""

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10
    deadline_ns: int = INFINITE_NS
    lifespan_ns: int = INFINITE_NS
    liveliness: str = "automatic"
    liveliness_lease_ns: int = INFINITE_NS
    avoid_ros_namespace_conventions: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Nested mapping in the field order of rosbag2's metadata version 9."""
        return {
            "history": self.history,
            "depth": self.depth,
            "reliability": self.reliability,
            "durability": self.durability,
            "deadline": _duration(self.deadline_ns),
            "lifespan": _duration(self.lifespan_ns),
            "liveliness": self.liveliness,
            "liveliness_lease_duration": _duration(self.liveliness_lease_ns),
            "avoid_ros_namespace_conventions": self.avoid_ros_namespace_conventions,
        }


def qos_to_yaml(profiles: Sequence[OfferedQos]) -> str:
    """YAML text of the profiles, as an MCAP channel keeps it; empty for none."""
    if not profiles:
        return ""
    return yaml_text.dump([profile.to_dict() for profile in profiles]).strip()


def qos_from_yaml(source: str | Sequence[Mapping[str, Any]] | None) -> tuple[OfferedQos, ...]:
    """Profiles from YAML text or from the list in ``metadata.yaml``, numbers or names.

    What cannot be understood is left out: a replay then falls back to default profiles.
    """
    try:
        entries = yaml_text.load(source) if isinstance(source, str) else source
    except yaml_text.YAMLError:
        return ()
    if not isinstance(entries, Sequence) or isinstance(entries, str):
        return ()
    return tuple(_profile(entry) for entry in entries if isinstance(entry, Mapping))


def _profile(entry: Mapping[str, Any]) -> OfferedQos:
    depth = entry.get("depth", 10)
    return OfferedQos(
        reliability=_policy(entry.get("reliability"), _RELIABILITY),
        durability=_policy(entry.get("durability"), _DURABILITY),
        history=_policy(entry.get("history"), _HISTORY),
        depth=depth if isinstance(depth, int) else 10,
        deadline_ns=_nanoseconds(entry.get("deadline")),
        lifespan_ns=_nanoseconds(entry.get("lifespan")),
        liveliness=_policy(entry.get("liveliness"), _LIVELINESS),
        liveliness_lease_ns=_nanoseconds(entry.get("liveliness_lease_duration")),
        avoid_ros_namespace_conventions=bool(entry.get("avoid_ros_namespace_conventions", False)),
    )


def _policy(value: object, names: tuple[str, ...]) -> str:
    if isinstance(value, str) and value.lower() in names:
        return value.lower()
    if isinstance(value, int) and 0 <= value < len(names):
        return names[value]
    return "unknown"


def _duration(ns: int) -> dict[str, int]:
    return {"sec": ns // 10**9, "nsec": ns % 10**9}


def _nanoseconds(value: object) -> int:
    if not isinstance(value, Mapping):
        return INFINITE_NS
    sec, nsec = value.get("sec"), value.get("nsec")
    # Before RMW_DURATION_INFINITE each middleware had a largest number of its own, from 2**31 - 1 s on.
    if not isinstance(sec, int) or not isinstance(nsec, int) or sec >= 2**31 - 1:
        return INFINITE_NS
    return sec * 10**9 + nsec
