"""BagWriter: raw serialised messages into a rosbag2 folder (``metadata.yaml`` and ``.mcap`` files).

At every instant the folder as it lies on the disk is a whole bag that any reader opens. What a kill, a power cut or
a full disk costs is what came after the last flush, one ``sync_seconds`` at most.
"""

from __future__ import annotations

import copy
import os
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal

from mcap.well_known import MessageEncoding, SchemaEncoding

from msd_ident.errors import SetupError, UsageError
from msd_ident.io import yaml_text
from msd_ident.io.mcap_writer import McapWriter
from msd_ident.io.message_definitions import Definitions
from msd_ident.io.metadata import LOST, UNFINISHED, BagEntry, FileEntry, TopicEntry
from msd_ident.io.new_folder import check_limits, make_folder, next_file
from msd_ident.io.qos import qos_from_yaml, qos_to_yaml
from msd_ident.writing import writing_to

Compression = Literal["zstd", "lz4", "none"]

_COMPRESSION = {"zstd": "zstd", "lz4": "lz4", "none": ""}
#: A file ends here and the next begins unless another limit is given: so much again is needed while it is written.
SPLIT_BYTES = 256 * 2**20
#: A file of so many chunks ends too: its index is written with each of them.
MOST_CHUNKS = 4000
#: Part of ``sync_seconds`` after which a flush begins, so that a busy machine has ended it when they are over.
_EARLY = 0.5


@dataclass
class _Topic:
    """A topic of the bag: its entry in the metadata, what describes it in each file, and its channel in the present."""

    entry: TopicEntry
    definition: str
    channel: int = 0


class BagWriter:
    """Writes a rosbag2 bag, metadata version 9, as ``ros2 bag record`` of Jazzy does. Safe to use from several threads.

    Args:
        folder: folder of the bag; made, with its parents.
        compression: of the MCAP chunks.
        overwrite: replace the folder when it is a bag or empty.
        sync_seconds: longest time for which a message is not on the disk while messages come in [s]. When they may
            stop coming, call ``flush`` from a timer.
        split_bytes: size at which a file ends and the next one begins.
        split_seconds: time by the messages' log times after which it does [s]; 0 for never.
        definitions: where message definitions come from.
        custom_data: texts that go into the metadata beside rosbag2's own entries.

    Raises:
        UsageError: the folder exists and may not be replaced, or a limit that makes no sense.
        SetupError: the disk does not take it.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        compression: Compression = "zstd",
        *,
        overwrite: bool = False,
        sync_seconds: float = 1.0,
        split_bytes: int = SPLIT_BYTES,
        split_seconds: float = 0.0,
        definitions: Definitions | None = None,
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        if compression not in _COMPRESSION:
            raise UsageError(f"compression is {compression!r}; expected one of {', '.join(_COMPRESSION)}")
        check_limits(sync_seconds, split_bytes, split_seconds)
        self.folder = Path(folder)
        self._compression = _COMPRESSION[compression]
        self._definitions = definitions or Definitions()
        self._sync_ns, self._split_bytes = int(_EARLY * sync_seconds * 1e9), split_bytes
        self._split_ns = int(split_seconds * 1e9)
        self._topics: dict[str, _Topic] = {}
        self._schemas: dict[str, int] = {}
        self._lock = threading.Lock()
        self._closed = self._dirty = False
        self._entry = BagEntry(custom=dict(custom_data or {}) | {UNFINISHED: f"{sync_seconds:g}"})
        make_folder(self.folder, overwrite)
        with writing_to(self.folder, "a writable folder"):
            self._begin_file()
            self._flush()

    @property
    def messages(self) -> int:
        """Number of messages taken; of those that are in the bag once it is closed, by itself or by the disk."""
        return self._entry.messages

    @property
    def path(self) -> Path:
        """The file that messages go to."""
        return self._writer.path

    def add_topic(
        self, name: str, type_name: str, offered_qos_yaml: str = "", *, definition: str | None = None
    ) -> bool:
        """Make a topic known before its first message; a topic that is known already is left as it is.

        Args:
            name: topic with its namespace, ``/msd/encoder``.
            type_name: ``sensor_msgs/msg/JointState``.
            offered_qos_yaml: profiles as YAML (see ``qos.qos_to_yaml``), numbers or names.
            definition: text of the message definition; ``None`` looks it up.

        Returns:
            Whether the definition is in the bag. Without it only programs that know the type can read the topic.

        Raises:
            SetupError: the disk is full or gone.
        """
        with self._disk():
            if name not in self._topics and not self._closed:
                text = self._definitions.text(type_name) if definition is None else definition
                type_hash = self._definitions.type_hash(type_name) if definition is None else ""
                qos = qos_to_yaml(qos_from_yaml(offered_qos_yaml))
                entry = self._entry.topics.setdefault(name, TopicEntry(name, type_name, qos, type_hash))
                self._topics[name] = _Topic(entry, text)
                self._register(self._topics[name])
                self._flush()  # readers that go by the metadata know the topic before its first message is there
            return name in self._topics and bool(self._topics[name].definition)

    def write(self, topic: str, raw: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Append one serialised message.

        Args:
            topic: name of a topic that was added.
            raw: serialised message (CDR).
            log_time_ns: when it was received [ns].
            publish_time_ns: when it was sent [ns]; ``log_time_ns`` if None.

        Raises:
            UsageError: the topic was not added, or the bag is closed.
            SetupError: the disk is full or gone; the bag is closed and keeps what it had.
        """
        published = log_time_ns if publish_time_ns is None else publish_time_ns
        with self._disk():
            if self._closed:
                raise UsageError(f"{self.folder} is closed; expected write() before close()")
            known = self._topics.get(topic)
            if known is None:
                raise UsageError(f"topic {topic} is not in the bag; expected add_topic() before write()")
            if self._is_over(log_time_ns):
                self._next_file()
            if not self._dirty:
                self._dirty, self._oldest_ns = True, time.monotonic_ns()
            self._writer.add_message(known.channel, known.entry.messages, log_time_ns, published, raw)
            known.entry.messages += 1
            self._file.count(log_time_ns)
            if time.monotonic_ns() - self._oldest_ns >= self._sync_ns:
                self._flush()

    def flush(self) -> None:
        """See everything written so far onto the disk, as a whole bag.

        Raises:
            SetupError: the disk is full or gone; the bag is closed and keeps what it had.
        """
        with self._disk():
            if not self._closed and self._dirty:
                self._flush()

    def close(self) -> None:
        """Finish the bag; a second call does nothing.

        Raises:
            SetupError: the disk is full or gone; the bag keeps what it had.
        """
        with self._disk():
            if self._closed:
                return
            self._entry.custom.pop(UNFINISHED, None)
            self._writer.close({"serialized_metadata": yaml_text.dump(self._entry.information())})
            self._entry.write(self.folder)
            self._closed = True

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _register(self, topic: _Topic) -> None:
        """Schema and channel in the present file."""
        kind = topic.entry.type
        if kind not in self._schemas:
            encoding = SchemaEncoding.ROS2 if topic.definition else ""
            self._schemas[kind] = self._writer.add_schema(kind, encoding, topic.definition.encode())
        about = {"offered_qos_profiles": topic.entry.qos, "topic_type_hash": topic.entry.type_hash}
        topic.channel = self._writer.add_channel(topic.entry.name, MessageEncoding.CDR, self._schemas[kind], about)

    def _is_over(self, log_time_ns: int) -> bool:
        """Whether the message belongs to the next file."""
        if not self._file.messages:
            return False
        if self._split_ns and log_time_ns - self._file.first_ns >= self._split_ns:
            return True
        if self._writer.chunks >= MOST_CHUNKS:
            return True
        if self._writer.size < self._split_bytes:
            return False
        self._writer.finish_chunk()
        return self._writer.size >= self._split_bytes

    def _begin_file(self) -> None:
        self._file = FileEntry(next_file(self._entry, self.folder))
        self._writer = McapWriter(self.folder / self._file.name, self._compression)
        self._entry.files.append(self._file)
        self._schemas.clear()
        for topic in self._topics.values():
            self._register(topic)

    def _next_file(self) -> None:
        self._writer.close()
        self._shown = copy.deepcopy(self._entry)
        self._begin_file()
        self._flush()

    def _flush(self) -> None:
        self._writer.flush()
        self._shown = copy.deepcopy(self._entry)
        self._entry.write(self.folder)
        self._dirty = False

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """One thread at a time; one line for what the disk refuses, after which the bag is left as it was shown."""
        with self._lock:
            try:
                yield
            except OSError as error:
                lost = self._give_up()
                raise SetupError(
                    f"cannot write {self.folder}: {error.strerror or error}; the bag keeps {self._entry.messages} of "
                    f"{self._entry.messages + lost} messages: free some space and record again"
                ) from None

    def _give_up(self) -> int:
        """Close the bag as it was at its last flush, whatever the disk says; number of messages that it loses."""
        if self._closed:
            return 0
        self._closed = True
        self._writer.abandon()
        lost = self._entry.messages - self._shown.messages
        if self._file.name not in [file.name for file in self._shown.files]:
            self._writer.path.unlink(missing_ok=True)
        self._shown.custom.pop(UNFINISHED, None)
        self._shown.custom[LOST] = f"{lost} messages are lost"
        with suppress(OSError):
            self._shown.write(self.folder)
        self._entry = self._shown
        return lost
