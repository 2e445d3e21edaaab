"""Messages of one topic decoded with the definition that came with them."""

from __future__ import annotations

import struct
from functools import cache, lru_cache

from rosbags.interfaces.typing import Typesdict
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError
from rosbags.typesys.store import Typestore

from msd_ident.errors import DataError
from msd_ident.io.message_definitions import Definitions, dependencies
from msd_ident.io.topics import Topic

_FAULTS = (SerdeError, struct.error, ValueError, IndexError, AssertionError, OverflowError, MemoryError)


class Decoder:
    """Turns serialised messages of a topic into objects with the message's fields.

    Raises:
        DataError: the encoding is not CDR, or there is no definition of the type anywhere.
    """

    def __init__(self, topic: Topic) -> None:
        if topic.encoding != "cdr":
            raise DataError(
                f"topic {topic.name} is encoded as {topic.encoding!r}; expected 'cdr', the encoding of ROS 2: "
                "choose another topic"
            )
        self._type = _full_name(topic.type)
        try:
            self._store = _store(self._type, topic.definition, topic.definition_format)
        except _Undefined:
            raise DataError(
                f"type {topic.type or '(none)'} of topic {topic.name} has no definition in the bag and is not "
                "installed; expected one of the two: source the workspace that has it, or record again"
            ) from None
        except (TypesysError, KeyError, SyntaxError, ValueError) as error:
            raise DataError(
                f"the definition of {topic.type} (topic {topic.name}) cannot be used: {_one_line(error)}; expected the "
                "complete definition in the bag: record again with ros2 bag or msd record"
            ) from None

    def decode(self, data: bytes) -> object | None:
        """The message, or ``None`` when the bytes are not one."""
        try:
            return self._store.deserialize_cdr(data, self._type)
        except _FAULTS:
            return None


class _Undefined(Exception):
    """There is no definition of the type."""


@lru_cache(maxsize=128)
def _store(type_name: str, definition: str, definition_format: str) -> Typestore:
    """Types from the bag, completed by the standard ones where the bag does not have them, ready to decode with.

    Kept between bags: rosbags makes code of every definition, which takes longer than to read a short bag.
    """
    types: Typesdict = {}
    if definition and definition_format != "ros2idl":
        types.update(get_types_from_msg(definition, type_name))
    elif definition:
        types.update(get_types_from_idl(definition))
    if type_name not in types:
        text = _standard().text(type_name)
        if not text:
            raise _Undefined
        types.update(get_types_from_msg(text, type_name))
    for name in [name for _, fields in types.values() for name in dependencies(fields)]:
        if name not in types and _standard().text(name):
            types.update(get_types_from_msg(_standard().text(name), name))
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    store.get_msgdef(type_name)
    return store


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


@cache
def _standard() -> Definitions:
    """Definitions for what a bag lacks; loaded only then, as it takes a while."""
    return Definitions()


def _full_name(type_name: str) -> str:
    """``sensor_msgs/msg/JointState`` also for ``sensor_msgs/JointState``."""
    package, _, rest = type_name.partition("/")
    return type_name if "/" in rest else f"{package}/msg/{rest}"
