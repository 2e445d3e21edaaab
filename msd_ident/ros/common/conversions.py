"""Converts messages into samples; ``result_messages`` and ``diagnosis_messages`` convert results into messages."""

from __future__ import annotations

import importlib
import struct
from array import array
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time

from msd_ident.data.record import FloatArray
from msd_ident.data.streams import batch_stamps
from msd_ident.errors import DataError, SetupError
from msd_ident.io.message_fields import joint_names, parse_field
from msd_ident.io.signal_choice import BATCH, FORCE_FIELDS, POSITION_FIELDS
from msd_ident.ros.common.live_buffer import StampArray


def message_class(type_name: str) -> Any:
    """Python class of a message type such as ``sensor_msgs/msg/JointState``.

    Raises:
        SetupError: its package is not installed or not sourced.
    """
    package, _, rest = type_name.partition("/")
    try:
        module = importlib.import_module(f"{package}.{rest.rpartition('/')[0] or 'msg'}")
        return getattr(module, rest.rpartition("/")[2])
    except (ImportError, AttributeError, ValueError):
        raise SetupError(
            f"message type {type_name} is not installed; expected its package: source the workspace that has it"
        ) from None


def is_stamped(type_name: str) -> bool:
    """Whether messages of the type begin with a stamped header."""
    fields = message_class(type_name).get_fields_and_field_types()
    return next(iter(fields.values()), "") == "std_msgs/Header"


def raw_stamp(raw: bytes) -> int | None:
    """Stamp [ns] of a serialised message that begins with a header; ``None`` where there is none."""
    if len(raw) < _STAMPED:
        return None
    sec, nanosec = struct.unpack_from("<iI" if raw[1] & 1 else ">iI", raw, 4)
    return sec * 10**9 + nanosec or None


def nanoseconds(stamp: Time) -> int:
    """A stamp as one whole number [ns]."""
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def time_message(ns: int) -> Time:
    """The stamp of a whole number of nanoseconds."""
    return Time(sec=ns // 10**9, nanosec=ns % 10**9)


#: Fewest bytes of a message with a stamp: what says how it is encoded, seconds, nanoseconds.
_STAMPED = 12
#: Messages in a row with another joint at the place of the one that was, after which it counts as renamed.
_GIVEN_UP = 50
#: Joints that a sentence names.
_MOST_NAMED = 10
#: More entries than any robot has joints.
MOST_ENTRIES = 1000
#: Longer than any batch [ns].
_LONGEST_NS = 10**15


def _index(step: str) -> int | None:
    """Place in an array that a step such as ``[0]`` names."""
    key = step[1:-1]
    return int(key) if step.startswith("[") and key.isdigit() else None


class Signal:
    """Takes the samples of one signal out of messages of one type, as the bag reader does.

    Args:
        what: ``force`` or ``position``.
        type_name: of the messages.
        field: path to the number; empty for the usual one of the type.
        scale: factor to the unit of the record.

    Raises:
        UsageError: the field cannot be read.
        DataError: no field is given, and the type has no usual one.
    """

    def __init__(self, what: str, type_name: str, field: str = "", scale: float = 1.0) -> None:
        usual = FORCE_FIELDS if what == "force" else POSITION_FIELDS
        text = field or usual.get(type_name, "")
        if not text:
            raise DataError(
                f"{what} topic is of type {type_name}; expected to be told which field to use: write TOPIC:FIELD"
            )
        self.field = parse_field(text)
        self.is_batch = type_name == BATCH and text == "positions"
        self.type_name = type_name
        self.frame = ""
        self.without = 0
        self.missing = 0
        self.oversized = self.switches = 0
        self.entry = ""
        self._scale = scale
        self._expected: int | None = None
        self._joints: tuple[str, ...] = ()
        self._index = _index(self.field.steps[-1])
        self._strangers = 0

    @property
    def problem(self) -> str:
        """Why messages gave no sample; empty when all did."""
        joints = f"; the joints are: {', '.join(self._joints)}" if self._joints else ""
        return f"{self.without} messages hold no {self.field.text}{joints}" if self.without else ""

    def sample(self, message: Any, received_ns: int) -> tuple[int, float] | None:
        """Stamp [ns] and value of a message with one sample, ``None`` when the entry is not in it.

        Raises:
            DataError: the type has no such field.
        """
        entries = getattr(message, self.field.steps[0], None)
        if isinstance(entries, array) and len(entries) > MOST_ENTRIES:
            self.oversized = len(entries)
        value = self.field.value(message)
        if value is None or (self._index is not None and not self._same_joint(message)):
            self.without += 1
            self._joints = joint_names(message)[:_MOST_NAMED]
            return None
        return self._stamp(message, received_ns), value * self._scale

    def batch(self, message: Any, received_ns: int) -> tuple[StampArray, FloatArray]:
        """Stamps [ns] and values of a message with many samples.

        Raises:
            DataError: its stamps would not rise, or leave all time.
        """
        count, period = len(message.positions), int(message.period_ns)
        if count and not 0 < period * count < _LONGEST_NS:
            raise DataError(f"a batch of {count} samples has the period {period} ns; expected one above 0")
        sequence = int(message.sequence)
        if self._expected is not None and sequence > self._expected:
            self.missing += sequence - self._expected
        self._expected = sequence + count
        stamps = batch_stamps(self._stamp(message, received_ns), period, count)
        return stamps, np.array(message.positions, dtype=np.float64) * self._scale

    def _same_joint(self, message: Any) -> bool:
        """Whether the entry that is meant by its place is the joint that it was; one that stays away is given up."""
        names = joint_names(message)
        name = names[self._index] if self._index is not None and 0 <= self._index < len(names) else self.entry
        if name == self.entry or not self.entry:
            self.entry, self._strangers = name, 0
            return True
        self._strangers += 1
        if self._strangers < _GIVEN_UP:
            return False
        self.entry, self._strangers = name, 0
        self.switches += 1
        return True

    def _stamp(self, message: Any, received_ns: int) -> int:
        header = getattr(message, "header", None)
        if header is None:
            return received_ns
        self.frame = header.frame_id
        return nanoseconds(header.stamp) or received_ns
