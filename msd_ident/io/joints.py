"""Which joints a bag holds: those of its JointState topics, with what is measured of each."""

from __future__ import annotations

import math
import os
import shlex
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.record import MINIMUM_SAMPLES, from_samples
from msd_ident.errors import DataError
from msd_ident.io.bag import Bag, open_bag
from msd_ident.io.signal_choice import force_beside
from msd_ident.io.source_options import SourceOptions

_KIND = "sensor_msgs/msg/JointState"
#: Messages of a topic that are looked at: drivers may send their joints in turn, and one may begin late.
_LOOKED_AT = 1000


@dataclass(frozen=True)
class Joint:
    """A joint of a JointState topic.

    Attributes:
        topic: that it is on.
        name: of the joint.
        has_effort: whether its messages carry an effort.
        place: in its messages, where another joint has the same name; its name here then ends with it.
        force: topic of a force in the namespace of its topic, where no other joint of that topic moves; empty without.
    """

    topic: str
    name: str
    has_effort: bool
    place: str = ""
    force: str = ""

    @property
    def position(self) -> str:
        """Where its position is, as ``--position`` takes it."""
        return f"{self.topic}:position[{self.place or self.name}]"

    @property
    def effort(self) -> str:
        """Where its effort is, as ``--force`` takes it."""
        return f"{self.topic}:effort[{self.place or self.name}]"

    @property
    def options(self) -> str:
        """Options to paste: its position, and its effort or the force beside it; a free decay where there is none."""
        given = self.effort if self.has_effort else self.force
        force = f"--force {shlex.quote(given)} --force-unit N·m" if given else "--force none"
        return f"{force} --position {shlex.quote(self.position)} --position-unit rad"


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
    bag = open_bag(path)
    found: dict[Joint, bool] = {}
    for joint, reading in _readings(bag, _LOOKED_AT):
        found[joint] = found.get(joint, False) or reading.has_effort
    if not found:
        there = ", ".join(sorted({topic.type for topic in bag.topics.values()})) or "none"
        raise DataError(f"{path} holds no joint; expected {_KIND} with names and positions; its types are: {there}")
    return tuple(replace(joint, has_effort=effort) for joint, effort in found.items())


def moving_joints(bag: Bag) -> dict[Joint, bool]:
    """All joints of an open bag that have a position, and whether each of them moves.

    Args:
        bag: may hold no joint.
    """
    found: dict[Joint, list[_Reading]] = {}
    for joint, reading in _readings(bag, None):
        found.setdefault(joint, []).append(reading)
    moving = {joint: _moves([one.position for one in readings]) for joint, readings in found.items()}
    many = Counter(joint.topic for joint in moving if moving[joint])  # which of several a force moves, nothing says
    return {
        replace(
            joint,
            has_effort=any(one.has_effort for one in readings),
            force=force_beside(bag.topics, joint.topic) if many[joint.topic] <= 1 else "",
        ): moving[joint]
        for joint, readings in found.items()
    }


class _Reading(NamedTuple):
    """What a message says of a joint."""

    position: float
    has_effort: bool


def _readings(bag: Bag, most: int | None) -> Iterator[tuple[Joint, _Reading]]:
    """Joints and what the first messages of each topic, all for ``None``, say of them."""
    from msd_ident.io.decode import Decoder  # imported here: a table needs no library for bags

    for topic in [name for name, topic in bag.topics.items() if topic.type == _KIND]:
        decoder = Decoder(bag.topics[topic])
        for raw in islice(bag.messages([topic]), most):
            message: Any = decoder.decode(raw.data)
            if message is None:
                continue
            efforts = [not math.isnan(effort) for effort in message.effort]  # NaN: the driver has none
            for index, name in enumerate(message.name[: len(message.position)]):
                if math.isnan(message.position[index]):
                    continue
                twice = message.name.count(name) > 1
                joint = Joint(topic, f"{name} [{index}]", False, str(index)) if twice else Joint(topic, name, False)
                yield joint, _Reading(float(message.position[index]), any(efforts[index : index + 1]))


def _moves(position: Sequence[float]) -> bool:
    """Whether positions move more than noise and rounding do; those that come at even times will do."""
    values = np.array([value for value in position if math.isfinite(value)])
    if values.size < MINIMUM_SAMPLES or not np.ptp(values):
        return bool(values.size and np.ptp(values))
    time = np.arange(float(values.size))
    return not observe(from_samples(time, np.zeros(values.size), values)).still
