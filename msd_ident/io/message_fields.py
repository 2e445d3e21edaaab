"""One number out of a message: ``wrench.force.x``, ``position[0]``, ``effort[elbow]``, ``data``."""

from __future__ import annotations

import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_ident.errors import DataError, UsageError

#: What an array field may be: decoded by rosbags, or by rclpy.
_ARRAYS = (np.ndarray, list, array)
_STEP = re.compile(r"\.?([A-Za-z_]\w*)|\[([^\[\]]+)\]")
#: Fields that name the entries of the arrays beside them.
_NAMES = ("name", "joint_names", "names")


@dataclass(frozen=True)
class Field:
    """A path into a message.

    Attributes:
        text: as the user wrote it.
        steps: names of fields, and keys in brackets (``[0]``, ``[elbow]``) with the bracket.
    """

    text: str
    steps: tuple[str, ...]

    def value(self, message: object) -> float | None:
        """The number, or ``None`` when this message has no such entry (an empty array, a joint that is not in it).

        Raises:
            DataError: the type of message has no such field, or it is not one number.
        """
        here: Any = message
        owners: list[Any] = []
        for step in self.steps:
            if step.startswith("["):
                self._check_once(step[1:-1], owners)
                index = _index(step[1:-1], here, owners)
                if index is None:
                    return None
                here = here[index]
            else:
                owners.append(here)
                here = getattr(here, step, None)
                if here is None:
                    raise self._missing(step, owners[-1])
        return self._number(here)

    def _check_once(self, name: str, owners: Sequence[Any]) -> None:
        names = _names(owners)
        if names.count(name) > 1 and not _is_place(name):
            field = self.text.rpartition("[")[0]
            places = " or ".join(f"{field}[{index}]" for index, other in enumerate(names) if other == name)
            raise DataError(
                f"joint {name} stands {names.count(name)} times in a message; expected once: take one by its place, "
                f"{places}"
            )

    def _number(self, found: Any) -> float | None:
        if isinstance(found, (float, int, np.number)):
            return float(found)
        if isinstance(found, _ARRAYS):
            if len(found) == 0:
                return None
            if len(found) == 1 and isinstance(found[0], (float, int, np.number)):
                return float(found[0])
            raise DataError(
                f"field {self.text} holds {len(found)} values; expected one: write {self.text}[0], or a joint's name"
            )
        inner = ", ".join(_field_names(found))
        what = f"a group of fields ({inner})" if inner else f"a {type(found).__name__}"
        raise DataError(f"field {self.text} is {what}; expected a number: name a field with one")

    def _missing(self, step: str, owner: object) -> DataError:
        there = ", ".join(_field_names(owner)) or "none"
        return DataError(f"field {self.text} is not in the message: no {step!r} there; the fields are: {there}")


def parse_field(text: str) -> Field:
    """Read a path.

    Raises:
        UsageError: it is not written like one.
    """
    steps = []
    position = 0
    for match in _STEP.finditer(text):
        if match.start() != position:
            break
        steps.append(match.group(1) or f"[{match.group(2).strip()}]")
        position = match.end()
    if position != len(text) or not steps or steps[0].startswith("["):
        raise UsageError(f"field {text!r} cannot be read; expected something like wrench.force.x or effort[elbow]")
    return Field(text, tuple(steps))


def joint_names(message: object) -> tuple[str, ...]:
    """Names that the message gives to the entries of its arrays."""
    return tuple(_names([message]))


def _index(key: str, values: Any, owners: Sequence[Any]) -> int | None:
    """Place of a key in an array, ``None`` when it is not in this message."""
    if not isinstance(values, _ARRAYS):
        return None
    if _is_place(key):
        index = int(key)
    else:
        names = _names(owners)
        if key not in names:
            return None
        index = list(names).index(key)
    return index if -len(values) <= index < len(values) else None


def _is_place(key: str) -> bool:
    return key.lstrip("-").isdigit()


def _names(owners: Sequence[Any]) -> Sequence[str]:
    """The list of names that lies nearest to the array."""
    for owner in reversed(owners):
        for field in _NAMES:
            names = getattr(owner, field, None)
            if isinstance(names, list):
                return names
    return ()


def _field_names(message: object) -> list[str]:
    """Fields of a message as rosbags makes it, or as rclpy does."""
    fields = getattr(message, "__dataclass_fields__", None)
    if fields is None and hasattr(message, "get_fields_and_field_types"):
        fields = message.get_fields_and_field_types()
    return [name for name in fields or () if not name.startswith("__")]
