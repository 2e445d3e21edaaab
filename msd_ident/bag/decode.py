"""Messages of one topic decoded with the definition that came with them."""

from __future__ import annotations

import struct
from functools import cache

from rosbags.interfaces.typing import Typesdict
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError

from msd_ident.bag.definitions import Definitions, dependencies
from msd_ident.bag.topic import Topic
from msd_ident.errors import DataError

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
        self._topic = topic
        self._type = _full_name(topic.type)
        self._store = get_typestore(Stores.EMPTY)
        try:
            self._store.register(self._definition())
            self._store.get_msgdef(self._type)
        except (TypesysError, KeyError, SyntaxError, ValueError) as error:
            raise DataError(
                f"the definition of {topic.type} (topic {topic.name}) cannot be used: {error}; expected the complete "
                "definition in the bag: record again with ros2 bag or msd record"
            ) from None

    def decode(self, data: bytes) -> object | None:
        """The message, or ``None`` when the bytes are not one."""
        try:
            return self._store.deserialize_cdr(data, self._type)
        except _FAULTS:
            return None

    def _definition(self) -> Typesdict:
        """Types from the bag, completed by the standard ones where the bag does not have them."""
        topic = self._topic
        types: Typesdict = {}
        if topic.definition and topic.definition_format != "ros2idl":
            types.update(get_types_from_msg(topic.definition, self._type))
        elif topic.definition:
            types.update(get_types_from_idl(topic.definition))
        if self._type not in types:
            text = _standard().text(self._type)
            if not text:
                raise DataError(
                    f"type {topic.type or '(none)'} of topic {topic.name} has no definition in the bag and is not "
                    "installed; expected one of the two: source the workspace that has it, or record again"
                )
            types.update(get_types_from_msg(text, self._type))
        for name in [name for _, fields in types.values() for name in dependencies(fields)]:
            if name not in types and _standard().text(name):
                types.update(get_types_from_msg(_standard().text(name), name))
        return types


@cache
def _standard() -> Definitions:
    """Definitions for what a bag lacks; loaded only then, as it takes a while."""
    return Definitions()


def _full_name(type_name: str) -> str:
    """``sensor_msgs/msg/JointState`` also for ``sensor_msgs/JointState``."""
    package, _, rest = type_name.partition("/")
    return type_name if "/" in rest else f"{package}/msg/{rest}"
