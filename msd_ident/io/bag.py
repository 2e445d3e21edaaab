"""Bag: a rosbag2 folder, a single ``.mcap`` or a ``.db3`` file, opened for reading raw messages."""

from __future__ import annotations

import heapq
import mmap
import os
import shlex
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from msd_ident.errors import DataError
from msd_ident.io.bag_folder import MAGIC, STORAGE, look_into, unreadable
from msd_ident.io.compression import PACKED, DecodeError, decompress, plain_name, unpack_file
from msd_ident.io.metadata import LOST, UNFINISHED
from msd_ident.io.topics import RawMessage, StorageFile, Topic
from msd_ident.paths import check_plain


class Bag:
    """A bag that is open for reading.

    Attributes:
        path: as given.
        kind: ``rosbag2 folder``, ``MCAP file`` or ``SQLite file``, for people.
        topics: by name.
        custom_data: texts that the recorder put into metadata.yaml.
    """

    def __init__(self, path: Path, kind: str, files: list[StorageFile], information: Mapping[str, Any]) -> None:
        self.path = path
        self.kind = kind
        self._files = files
        self._packed = str(information.get("compression_mode") or "").lower() == "message"
        self._notes = tuple(information.get("notes", ()))
        self.custom_data = _texts(information.get("custom_data"))
        self._notes += tuple(_ended(self.custom_data.pop(UNFINISHED, ""), self.custom_data.pop(LOST, "")))
        self.topics: dict[str, Topic] = {}
        for file in files:
            for topic in file.topics():
                self.topics.setdefault(topic.name, topic)
        _check_encodings(path, self.topics)

    @property
    def notes(self) -> tuple[str, ...]:
        """What had to be done or was lost; complete after all messages were read."""
        return self._notes + tuple(loss for file in self._files for loss in file.losses)

    def messages(self, topics: Collection[str] | None = None, *, by_log_time: bool = True) -> Iterator[RawMessage]:
        """Messages of the bag.

        Args:
            topics: names of topics to read; None for all.
            by_log_time: sort by log time; False for the order in which they were stored.
        """
        streams = [file.raw_messages(by_log_time) for file in self._files]
        merged: Iterator[RawMessage]
        if by_log_time and len(streams) > 1:
            merged = heapq.merge(*streams, key=lambda message: message.log_time_ns)
        else:
            merged = (message for stream in streams for message in stream)
        for message in merged:
            if topics is None or message.topic in topics:
                yield message._replace(data=_unpack(message.data)) if self._packed else message


def is_bag(path: str | os.PathLike[str]) -> bool:
    """Whether the path is for ``open_bag``; anything else that is there is taken for a table.

    Raises:
        DataError: nothing is there, or a bag of ROS 1, or neither file nor folder.
    """
    return _is_bag(Path(path), "a bag folder, an .mcap or a .csv file")


def _is_bag(where: Path, expected: str) -> bool:
    if not _exists(where):
        raise DataError(f"{where} does not exist; expected {expected}: check the path")
    check_plain(where, expected)
    if where.is_dir() or plain_name(where).endswith(STORAGE) or where.name == "metadata.yaml":
        return True
    begin = _begin(where)
    if begin.startswith(b"#ROSBAG"):
        folder = where.with_suffix("") if where.suffix and not where.with_suffix("").exists() else f"{where}_ros2"
        command = f"rosbags-convert --src {shlex.quote(str(where))} --dst {shlex.quote(str(folder))}"
        raise DataError(f"{where} is a bag of ROS 1; expected one of ROS 2: convert it with {command}")
    return begin.startswith(MAGIC)


def open_bag(path: str | os.PathLike[str]) -> Bag:
    """Open a bag.

    Raises:
        DataError: nothing there, not a bag, or no topic in an encoding that can be read.
    """
    where = Path(path)
    if not _is_bag(where, "a bag folder, an .mcap or a .db3 file"):
        raise DataError(f"{where} is not a bag; expected a rosbag2 folder, an .mcap or a .db3 file")
    if where.is_dir():
        return _open_folder(where)
    if where.name == "metadata.yaml":
        return _open_folder(where.parent)
    kind = "SQLite file" if plain_name(where).endswith(".db3") else "MCAP file"
    return Bag(where, kind, [_open_storage(where)], {})


def iterate_messages(path: str | os.PathLike[str], topics: Collection[str] | None = None) -> Iterator[RawMessage]:
    """Messages of a bag by log time; see ``open_bag`` for topics with their QoS and definitions.

    Args:
        path: bag folder or file.
        topics: names of topics to read; None for all.

    Raises:
        DataError: not a bag, or one of the topics is not in it.
    """
    bag = open_bag(path)
    missing = sorted(set(topics or ()) - set(bag.topics))
    if missing:
        raise DataError(
            f"{bag.path} has no topic {', '.join(missing)}; there are: {', '.join(sorted(bag.topics)) or 'none'}"
        )
    return bag.messages(topics)


def _open_folder(folder: Path) -> Bag:
    found = look_into(folder)
    files = [_open_storage(path) for path in found.paths]
    return Bag(folder, "rosbag2 folder", files, {**found.information, "notes": found.notes})


def _texts(entries: object) -> dict[str, str]:
    """Texts by name; what is neither text nor number is left out."""
    found = entries.items() if isinstance(entries, Mapping) else ()
    return {str(key): str(value) for key, value in found if isinstance(key, str) and isinstance(value, str | int)}


def _ended(unfinished: str, lost: str) -> Iterator[str]:
    """What the recorder left in the metadata about a recording that did not end as it should."""
    if unfinished:
        yield (
            f"the recording was not finished: what came in its last {unfinished[:20]} s may be missing; msd repair "
            "finishes the bag."
        )
    if lost:
        yield f"the recording was cut off: {lost[:80]}."


def _open_storage(path: Path) -> StorageFile:
    from msd_ident.io.database import DatabaseFile  # imported here: a table needs no library for bags
    from msd_ident.io.mcap_file import McapFile

    packed = path.name.endswith(PACKED)
    try:
        if plain_name(path).endswith(".db3"):
            return DatabaseFile(path, packed)
        if packed:
            return McapFile(unpack_file(path), path.name)
        with path.open("rb") as file:
            empty = os.fstat(file.fileno()).st_size == 0
            data = b"" if empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
            return McapFile(data, path.name)
    except OSError as error:
        raise unreadable(path, error) from None


def _unpack(data: bytes) -> bytes:
    """Message of a bag that was compressed message by message; empty, and so counted as unreadable, when damaged."""
    try:
        return decompress(data, "zstd")
    except DecodeError:
        return b""


def _exists(path: Path) -> bool:
    try:
        path.stat()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise unreadable(path, error) from None
    return True


def _begin(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(16)
    except OSError as error:
        raise unreadable(path, error) from None


def _check_encodings(path: Path, topics: Mapping[str, Topic]) -> None:
    strange = sorted({topic.encoding for topic in topics.values()} - {"cdr"})
    if strange and all(topic.encoding != "cdr" for topic in topics.values()):
        raise DataError(
            f"{path}: messages are encoded as {', '.join(repr(name) for name in strange)}; expected 'cdr', "
            "the encoding of ROS 2: record or convert the bag with ROS 2"
        )
