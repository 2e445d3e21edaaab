"""Which topic and field of a bag is the force, and which the position."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from msd_ident.errors import DataError
from msd_ident.io.message_fields import Field, parse_field
from msd_ident.io.topics import Topic

BATCH = "msd_interfaces/msg/EncoderBatch"

#: Field that is taken when only the topic is given, by type; the batch is unpacked as a whole.
FORCE_FIELDS = {
    "geometry_msgs/msg/WrenchStamped": "wrench.force.x",
    "geometry_msgs/msg/Wrench": "force.x",
    "sensor_msgs/msg/JointState": "effort",
    "std_msgs/msg/Float64": "data",
    "std_msgs/msg/Float32": "data",
}
POSITION_FIELDS = {
    "sensor_msgs/msg/JointState": "position[0]",
    BATCH: "positions",
    "geometry_msgs/msg/PointStamped": "point.x",
    "std_msgs/msg/Float64": "data",
    "std_msgs/msg/Float32": "data",
}
_FORCE_NAMES = ("force",)
_POSITION_NAMES = ("encoder", "encoder_batch")


@dataclass(frozen=True)
class Source:
    """A signal in a bag: a topic and the field in its messages."""

    topic: Topic
    field: Field

    @property
    def label(self) -> str:
        """``TOPIC:FIELD``, as the options take it."""
        return f"{self.topic.name}:{self.field.text}"

    @property
    def is_batch(self) -> bool:
        """Whether a message holds many samples."""
        return self.topic.type.endswith("/EncoderBatch") and self.field.text == "positions"


def choose_position(topics: Mapping[str, Topic], wanted: str, counts: Mapping[str, int], bag: str) -> Source:
    """The position that the user names, or else the only topic called ``encoder`` or ``encoder_batch``.

    Args:
        topics: of the bag, by name.
        wanted: ``TOPIC:FIELD``, a topic, or empty.
        counts: number of messages by topic.
        bag: name of the bag for error messages.

    Raises:
        DataError: there is none, or there are several.
    """
    if wanted:
        return _named(topics, wanted, POSITION_FIELDS, "--position", bag)
    called = _called(topics, _POSITION_NAMES)
    found = _usable(called, POSITION_FIELDS, counts)
    if not found:
        raise DataError(
            f"{bag} has no topic called encoder or encoder_batch to take the position from{_why(called, counts)}; "
            f"{_list(topics)}: say which with --position TOPIC:FIELD"
        )
    found.sort(key=lambda topic: (_namespace(topic.name), topic.type != BATCH))
    spaces = {_namespace(topic.name) for topic in found}
    if len(spaces) > 1:
        names = ", ".join(topic.name for topic in found)
        raise DataError(f"{bag} has {len(found)} topics that may be the position ({names}); say which with --position")
    return Source(found[0], parse_field(POSITION_FIELDS[found[0].type]))


def choose_force(
    topics: Mapping[str, Topic], wanted: str, counts: Mapping[str, int], position: str, bag: str
) -> Source:
    """The force that the user names, or else the topic called ``force``.

    If there are several such topics, the one in the namespace of the position is taken.

    Args:
        topics: of the bag, by name.
        wanted: ``TOPIC:FIELD``, a topic, or empty.
        counts: number of messages by topic.
        position: name of the position's topic.
        bag: name of the bag for error messages.

    Raises:
        DataError: there is none, or there are several.
    """
    if wanted:
        return _named(topics, wanted, FORCE_FIELDS, "--force", bag)
    called = _called(topics, _FORCE_NAMES)
    found = _usable(called, FORCE_FIELDS, counts)
    near = [topic for topic in found if _namespace(topic.name) == _namespace(position)]
    found = near or found
    if not found:
        raise DataError(
            f"{bag} has no force: no topic called force to take it from{_why(called, counts)}; {_list(topics)}: "
            "say which with --force TOPIC:FIELD, or --force none for a free decay"
        )
    if len(found) > 1:
        names = ", ".join(topic.name for topic in found)
        raise DataError(f"{bag} has {len(found)} topics that may be the force ({names}); say which with --force")
    return Source(found[0], parse_field(FORCE_FIELDS[found[0].type]))


def force_beside(topics: Mapping[str, Topic], position: str) -> str:
    """Name of the topic of the force in the namespace of a position; empty where there is none.

    Args:
        topics: of the bag, by name.
        position: name of the position's topic.
    """
    found = [topic.name for topic in _called(topics, _FORCE_NAMES) if topic.type in FORCE_FIELDS]
    return next((name for name in found if _namespace(name) == _namespace(position)), "")


def _named(topics: Mapping[str, Topic], wanted: str, defaults: Mapping[str, str], option: str, bag: str) -> Source:
    name, _, field = wanted.partition(":")
    topic = topics.get(name) or topics.get(f"/{name}") or _only([t for t in topics if t.endswith(f"/{name}")], topics)
    if topic is None:
        raise DataError(f"{bag} has no topic {name}; {_list(topics)}: correct {option}")
    field = field or defaults.get(topic.type, "")
    if not field:
        raise DataError(
            f"topic {topic.name} is of type {topic.type}; expected to be told which field to use: "
            f"write {option} {topic.name}:FIELD"
        )
    return Source(topic, parse_field(field))


def _only(names: Collection[str], topics: Mapping[str, Topic]) -> Topic | None:
    return topics[next(iter(names))] if len(names) == 1 else None


def _called(topics: Mapping[str, Topic], names: Collection[str]) -> list[Topic]:
    return [topic for topic in topics.values() if topic.name.rpartition("/")[2] in names]


def _usable(called: Iterable[Topic], types: Collection[str], counts: Mapping[str, int]) -> list[Topic]:
    return [topic for topic in called if topic.type in types and counts.get(topic.name)]


def _why(called: Sequence[Topic], counts: Mapping[str, int]) -> str:
    """Why none of the topics that have the right name will do."""
    reasons = [
        f"{topic.name} is of type {topic.type}" if counts.get(topic.name) else f"{topic.name} holds no messages"
        for topic in called
    ]
    return f" ({', '.join(reasons)})" if reasons else ""


def _namespace(name: str) -> str:
    return name.rpartition("/")[0]


def _list(topics: Mapping[str, Topic]) -> str:
    """The topics for an error message, not more than a line can hold."""
    names = sorted(topics)
    more = f" and {len(names) - 12} more" if len(names) > 12 else ""
    return f"there are: {', '.join(names[:12])}{more}" if names else "there are none"
