"""A ``.db3`` file, the storage of rosbag2 before MCAP, read through rosbags."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag2 import Reader, ReaderError

from msd_ident.errors import DataError
from msd_ident.io.compression import unpack_file
from msd_ident.io.qos import OfferedQos
from msd_ident.io.topics import RawMessage, Topic

_FORMATS = {MessageDefinitionFormat.MSG: "ros2msg", MessageDefinitionFormat.IDL: "ros2idl"}


class DatabaseFile:
    """An SQLite file as a bag sees it.

    Raises:
        DataError: the file is no bag, or damaged.
    """

    losses: tuple[str, ...] = ()

    def __init__(self, path: Path, packed: bool) -> None:
        self._name = str(path)
        self._folder = TemporaryDirectory() if packed else None
        if self._folder:
            plain = Path(self._folder.name) / "bag.db3"
            plain.write_bytes(unpack_file(path))
            path = plain
        try:
            self._reader = Reader(path)
            self._reader.open()
        except (ReaderError, sqlite3.Error, FileNotFoundError) as error:
            raise self._unreadable(error) from None

    def topics(self) -> tuple[Topic, ...]:
        """Topics of the file; before Iron their definitions are not in it."""
        return tuple(_topic(connection) for connection in self._reader.connections)

    def raw_messages(self, by_log_time: bool) -> Iterator[RawMessage]:
        """All messages; the database keeps them by log time."""
        try:
            for connection, stamp, data in self._reader.messages():
                yield RawMessage(connection.topic, connection.msgtype, bytes(data), stamp, stamp)
        except (ReaderError, sqlite3.Error) as error:
            raise self._unreadable(error) from None

    def _unreadable(self, error: Exception) -> DataError:
        return DataError(f"{self._name} cannot be read: {error}; expected a .db3 file of rosbag2: record again")


def _topic(connection: Connection) -> Topic:
    ext = connection.ext
    assert isinstance(ext, ConnectionExtRosbag2)
    return Topic(
        name=connection.topic,
        type=connection.msgtype,
        encoding=ext.serialization_format,
        definition=connection.msgdef.data,
        definition_format=_FORMATS.get(connection.msgdef.format, ""),
        offered_qos=tuple(
            OfferedQos(
                reliability=profile.reliability.name.lower(),
                durability=profile.durability.name.lower(),
                history=profile.history.name.lower(),
                depth=profile.depth,
            )
            for profile in ext.offered_qos_profiles
        ),
    )
