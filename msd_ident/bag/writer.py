"""BagWriter: raw serialised messages into a rosbag2 folder (``metadata.yaml`` and one ``.mcap``).

What a kill or a power cut may cost is the chunk in progress, about a second: chunks are closed by
time as well as by size, and ``metadata.yaml`` is there from the first moment and kept up to date.
"""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import CompressionType, Writer

from msd_ident.bag import yaml_text
from msd_ident.bag.definitions import Definitions
from msd_ident.bag.qos import qos_from_yaml, qos_to_yaml
from msd_ident.errors import SetupError, UsageError

Compression = Literal["zstd", "lz4", "none"]

_COMPRESSION = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "none": CompressionType.NONE}
#: What rosbag2 writes as the start of a bag without messages [ns].
_NO_START = 2**63 - 1


@dataclass
class _Topic:
    """One channel of the file."""

    name: str
    type: str
    channel: int
    qos: str
    type_hash: str
    defined: bool
    messages: int = 0


class BagWriter:
    """Writes a rosbag2 bag, metadata version 9, as ``ros2 bag record`` of Jazzy does. Safe to use from several threads.

    Args:
        folder: folder of the bag; made, with its parents.
        compression: of the MCAP chunks.
        overwrite: replace the folder when it is a bag or empty.
        flush_seconds: longest time that a message stays in memory while messages come in [s]. When they may
            stop coming, call ``flush`` from a timer.
        definitions: where message definitions come from.
        custom_data: texts that go into the metadata beside rosbag2's own entries.

    Raises:
        UsageError: the folder exists and may not be replaced.
        SetupError: the disk does not take it.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        compression: Compression = "zstd",
        *,
        overwrite: bool = False,
        flush_seconds: float = 1.0,
        definitions: Definitions | None = None,
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        if compression not in _COMPRESSION:
            raise UsageError(f"compression is {compression!r}; expected one of {', '.join(_COMPRESSION)}")
        self.folder = Path(folder)
        self._definitions = definitions or Definitions()
        self._custom_data = dict(custom_data or {}) or None
        self._flush_ns = int(flush_seconds * 1e9)
        self._topics: dict[str, _Topic] = {}
        self._schemas: dict[str, int] = {}
        self._first_ns, self._last_ns, self._messages = _NO_START, 0, 0
        self._lock = threading.Lock()
        self._closed = False
        _make_folder(self.folder, overwrite)
        self.path = self.folder / f"{self.folder.resolve().name}_0.mcap"
        try:
            self._stream = self.path.open("wb")
        except OSError as error:
            raise SetupError(f"cannot write {self.path}: {error.strerror}; expected a writable folder") from None
        self._writer = Writer(self._stream, compression=_COMPRESSION[compression])
        self._writer.start(profile="ros2", library="msd_ident")
        self._flushed, self._flushed_ns = 0, time.monotonic_ns()
        with self._disk():
            self._write_metadata()

    @property
    def messages(self) -> int:
        """Number of messages written."""
        return self._messages

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
            if name in self._topics:
                return self._topics[name].defined
            text = self._definitions.text(type_name) if definition is None else definition
            if type_name not in self._schemas:
                encoding = SchemaEncoding.ROS2 if text else ""
                self._schemas[type_name] = self._writer.register_schema(type_name, encoding, text.encode())
            qos = qos_to_yaml(qos_from_yaml(offered_qos_yaml))
            type_hash = self._definitions.type_hash(type_name) if definition is None else ""
            channel = self._writer.register_channel(
                topic=name,
                message_encoding=MessageEncoding.CDR,
                schema_id=self._schemas[type_name],
                metadata={"offered_qos_profiles": qos, "topic_type_hash": type_hash},
            )
            self._topics[name] = _Topic(name, type_name, channel, qos, type_hash, bool(text))
            return bool(text)

    def write(self, topic: str, raw: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Append one serialised message; ``publish_time_ns`` defaults to ``log_time_ns``.

        Raises:
            UsageError: the topic was not added, or the bag is closed.
            SetupError: the disk is full or gone.
        """
        published = log_time_ns if publish_time_ns is None else publish_time_ns
        with self._disk():
            if self._closed:
                raise UsageError(f"{self.folder} is closed; expected write() before close()")
            entry = self._topics.get(topic)
            if entry is None:
                raise UsageError(f"topic {topic} is not in the bag; expected add_topic() before write()")
            self._writer.add_message(entry.channel, log_time_ns, raw, published, sequence=entry.messages)
            entry.messages += 1
            self._messages += 1
            self._first_ns = min(self._first_ns, log_time_ns)
            self._last_ns = max(self._last_ns, log_time_ns)
            if time.monotonic_ns() - self._flushed_ns > self._flush_ns:
                self._flush()

    def flush(self) -> None:
        """Hand everything written so far to the operating system, with metadata that fits.

        Raises:
            SetupError: the disk is full or gone.
        """
        with self._disk():
            if not self._closed and self._messages > self._flushed:
                self._flush()

    def close(self) -> None:
        """Finish the file with its index and the metadata; a second call does nothing.

        Raises:
            SetupError: the disk is full or gone.
        """
        with self._disk():
            if self._closed:
                return
            self._closed = True
            self._writer.add_metadata("rosbag2", {"serialized_metadata": yaml_text.dump(self._metadata())})
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._stream.close()
            self._write_metadata()

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _flush(self) -> None:
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._write_metadata()
        self._flushed, self._flushed_ns = self._messages, time.monotonic_ns()

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """One thread at a time, and one line for what the disk refuses."""
        with self._lock:
            try:
                yield
            except OSError as error:
                raise SetupError(
                    f"cannot write {self.path}: {error.strerror or error}; {self._messages} messages were taken until "
                    "then: free some space and record again"
                ) from None

    def _metadata(self) -> dict[str, Any]:
        start = {"nanoseconds_since_epoch": self._first_ns}
        duration = {"nanoseconds": max(self._last_ns - self._first_ns, 0)}
        return {
            "version": 9,
            "storage_identifier": "mcap",
            "duration": duration,
            "starting_time": start,
            "message_count": self._messages,
            "topics_with_message_count": [_topic_metadata(topic) for topic in self._topics.values()],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [self.path.name],
            "files": [
                {
                    "path": self.path.name,
                    "starting_time": dict(start),
                    "duration": dict(duration),
                    "message_count": self._messages,
                }
            ],
            "custom_data": self._custom_data,
            "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
        }

    def _write_metadata(self) -> None:
        """Replace metadata.yaml in one step, so that no reader ever meets half of it."""
        target = self.folder / "metadata.yaml"
        draft = self.folder / ".metadata.yaml.part"
        draft.write_text(yaml_text.dump({"rosbag2_bagfile_information": self._metadata()}), encoding="utf-8")
        os.replace(draft, target)


def _topic_metadata(topic: _Topic) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": topic.name,
            "type": topic.type,
            "serialization_format": "cdr",
            "offered_qos_profiles": [profile.to_dict() for profile in qos_from_yaml(topic.qos)],
            "type_description_hash": topic.type_hash,
        },
        "message_count": topic.messages,
    }


def _make_folder(folder: Path, overwrite: bool) -> None:
    """An empty folder for the bag; only a bag or an empty folder is ever removed for it."""
    try:
        if folder.exists() or folder.is_symlink():
            _clear(folder, overwrite)
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SetupError(f"cannot make {folder}: {error.strerror}; expected a place that takes folders") from None


def _clear(folder: Path, overwrite: bool) -> None:
    if not folder.is_dir():
        raise UsageError(f"{folder} is a file; expected a new folder for the bag: give another name")
    content = {path.name for path in folder.iterdir()}
    if not content:
        return
    is_bag = all(name.endswith((".mcap", "metadata.yaml", ".part")) for name in content)
    if not is_bag:
        raise UsageError(f"{folder} exists and is no bag; expected a new folder for the bag: give another name")
    if not overwrite:
        raise UsageError(f"{folder} exists; expected a new name: give another one, or --overwrite to replace it")
    shutil.rmtree(folder)
