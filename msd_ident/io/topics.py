"""Topics and raw messages, as every kind of bag file gives them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from msd_ident.io.qos import OfferedQos


@dataclass(frozen=True)
class Topic:
    """One topic as the bag describes it.

    Attributes:
        name: with its namespace.
        type: ``sensor_msgs/msg/JointState``.
        encoding: of the messages; only ``cdr`` can be decoded.
        definition: text of the message definition, empty when the bag has none.
        definition_format: ``ros2msg``, ``ros2idl`` or empty.
        offered_qos: one profile for each publisher that was seen.
    """

    name: str
    type: str
    encoding: str = "cdr"
    definition: str = ""
    definition_format: str = ""
    offered_qos: tuple[OfferedQos, ...] = ()


class RawMessage(NamedTuple):
    """One serialised message and the times [ns] at which it was received and sent."""

    topic: str
    type: str
    data: bytes
    log_time_ns: int
    publish_time_ns: int


class StorageFile(Protocol):
    """What a bag asks of one of its files."""

    @property
    def losses(self) -> tuple[str, ...]:
        """What could not be read, known after a full pass."""

    def topics(self) -> tuple[Topic, ...]:
        """Topics of the file."""

    def raw_messages(self, by_log_time: bool) -> Iterator[RawMessage]:
        """All messages, by log time or in stored order."""
