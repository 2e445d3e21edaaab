"""Which joints a bag holds: those of its JointState topics, with what is measured of each."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from msd_ident.errors import DataError
from msd_ident.io.bag import open_bag
from msd_ident.io.source_options import SourceOptions

_KIND = "sensor_msgs/msg/JointState"
#: Messages of a topic that are looked at: drivers may send their joints in turn.
_LOOKED_AT = 50


@dataclass(frozen=True)
class Joint:
    """A joint of a JointState topic.

    Attributes:
        topic: that it is on.
        name: of the joint.
        has_effort: whether its messages carry an effort.
    """

    topic: str
    name: str
    has_effort: bool

    @property
    def position(self) -> str:
        """Where its position is, as ``--position`` takes it."""
        return f"{self.topic}:position[{self.name}]"

    @property
    def effort(self) -> str:
        """Where its effort is, as ``--force`` takes it."""
        return f"{self.topic}:effort[{self.name}]"


def source_of(options: SourceOptions, joint: Joint) -> SourceOptions:
    """Options that read one joint, with its effort as force.

    Args:
        options: their units count; N·m and rad if they give none.
        joint: the joint.
    """
    return replace(
        options,
        force=joint.effort,
        position=joint.position,
        force_unit=options.force_unit or "N·m",
        position_unit=options.position_unit or "rad",
    )


def joints(path: str | os.PathLike[str]) -> tuple[Joint, ...]:
    """All joints of a bag that have a position, in the order in which they come.

    Raises:
        DataError: it is no bag, or holds no JointState with a name and a position.
    """
    from msd_ident.io.decode import Decoder  # imported here: a table needs no library for bags

    bag = open_bag(path)
    topics = [name for name, topic in bag.topics.items() if topic.type == _KIND]
    found: dict[tuple[str, str], bool] = {}
    for topic in topics:
        decoder = Decoder(bag.topics[topic])
        for raw in islice(bag.messages([topic]), _LOOKED_AT):
            message: Any = decoder.decode(raw.data)
            if message is None:
                continue
            efforts = len(message.effort)
            for index, name in enumerate(message.name[: len(message.position)]):
                found[topic, name] = found.get((topic, name), False) or index < efforts
    if not found:
        there = ", ".join(sorted({topic.type for topic in bag.topics.values()})) or "none"
        raise DataError(f"{path} holds no joint; expected {_KIND} with names and positions; its types are: {there}")
    return tuple(Joint(topic, name, effort) for (topic, name), effort in found.items())
