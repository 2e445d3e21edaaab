"""All joints of a bag, each diagnosed separately if its effort can be the force that moves it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from msd_ident.data.joint_effort import judge
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import DataError
from msd_ident.parallel import each
from msd_ident.workflow import pipeline


class Named(Protocol):
    """A joint of a bag."""

    @property
    def name(self) -> str:
        """Of the joint."""

    @property
    def has_effort(self) -> bool:
        """Whether there is one."""


_Joint = TypeVar("_Joint", bound=Named)


@dataclass(frozen=True)
class JointResult:
    """What was found of one joint.

    Attributes:
        name: of the joint.
        usable: whether its effort can be the force.
        sentence: the diagnosis in words, or why there is none.
        diagnosis: where its effort can be the force and the data does; else ``None``.
    """

    name: str
    usable: bool
    sentence: str
    diagnosis: Diagnosis | None = None


def each_joint(
    joints: Sequence[_Joint], read: Callable[[_Joint], Record], options: pipeline.Options
) -> tuple[JointResult, ...]:
    """Every joint, shared between the cores.

    Args:
        joints: to go through.
        read: makes a joint's record; a ``DataError`` is that joint's alone.
        options: of the diagnosis.
    """

    def work(joint: _Joint) -> JointResult:
        """Read one joint, judge whether its effort can be the force, and diagnose it."""
        if not joint.has_effort:
            return JointResult(joint.name, False, "its messages contain no effort, so there is no force")
        try:
            record = read(joint)
            judged = judge(record)
            if not judged.usable:
                return JointResult(joint.name, False, judged.sentence)
            found = pipeline.diagnose([record], options)
        except DataError as error:
            return JointResult(joint.name, False, str(error))
        return JointResult(joint.name, True, found.summary, found)

    return tuple(each(work, list(joints)))
