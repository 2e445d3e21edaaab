"""A recording in progress: raw messages through a queue to a writer thread, losses counted. Without ROS."""

from __future__ import annotations

import queue
import threading
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from msd_ident.io import BagWriter, OfferedQos, qos_to_yaml
from msd_ident.io.writer import SPLIT_BYTES, Compression
from msd_ident.quantity import counted
from msd_ident.ros.common.missing_samples import TopicCount

#: Longest time without messages after which the writer sees what it has onto the disk [s].
IDLE = 0.5


@dataclass(frozen=True)
class Summary:
    """What a recording holds."""

    folder: Path
    topics: dict[str, TopicCount]
    refused: int
    error: str

    @property
    def messages(self) -> int:
        """Messages received."""
        return sum(count.received for count in self.topics.values())

    @property
    def lost(self) -> int:
        """Messages that never came, and those that the queue had no room for."""
        return sum(count.lost for count in self.topics.values()) + self.refused

    @property
    def sentence(self) -> str:
        """For people."""
        loss = f", {self.lost} lost" if self.lost else ", none lost"
        held = f"{counted(self.messages, 'message')} of {counted(len(self.topics), 'topic')}"
        text = f"{held}{loss}, in {self.folder}"
        return f"{text}; {self.error}" if self.error else text


@dataclass(frozen=True)
class QueueLimits:
    """When the bag is seen onto the disk [s], and the size [bytes] and length [s] of its files; 0 s for any length.

    The names are those of ``BagWriter``.
    """

    sync_seconds: float = 1.0
    split_bytes: int = SPLIT_BYTES
    split_seconds: float = 0.0


@dataclass(frozen=True)
class Numbered:
    """What tells that messages are missing.

    Attributes:
        sequence: the message's number, where it has one.
        stamp_ns: its own stamp [ns], where it has one.
        alone: whether its topic has one publisher, so that the numbers tell what is lost.
    """

    sequence: int | None = None
    stamp_ns: int | None = None
    alone: bool = True


class Recording:
    """Takes messages from the executor's thread without ever waiting for the disk.

    Args:
        folder: of the bag; must not exist, or be empty (``Place.automatic`` makes it so that nobody else has it).
        compression: ``zstd``, ``lz4`` or ``none``.
        most_bytes: messages that may wait for the disk; what comes beyond is refused and counted.
        limits: when the bag is seen onto the disk and when it goes on in another file.
        custom_data: texts for the bag's metadata.

    Raises:
        UsageError: the folder exists.
        SetupError: the disk does not take it.
    """

    def __init__(
        self,
        folder: Path,
        compression: Compression = "zstd",
        most_bytes: int = 512 * 2**20,
        limits: QueueLimits = QueueLimits(),  # noqa: B008 - frozen
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        self.folder = folder
        self._idle = min(IDLE, max(limits.sync_seconds / 2, 0.01))
        self._writer = BagWriter(folder, compression, custom_data=custom_data, **asdict(limits))
        self._queue: queue.SimpleQueue[tuple[str, bytes, int, int] | None] = queue.SimpleQueue()
        self._counts: dict[str, TopicCount] = {}
        self._most_bytes = most_bytes
        self._put_bytes = self._written_bytes = self._refused = 0
        self._error = ""
        self._thread = threading.Thread(target=self._write, name="bag writer")
        self._thread.start()

    @property
    def summary(self) -> Summary:
        """What was recorded so far."""
        refused = self._refused
        if self._error:
            refused = sum(count.received for count in self._counts.values()) - self._writer.messages
        return Summary(self.folder, self._counts, refused, self._error)

    @property
    def waiting_bytes(self) -> int:
        """Messages that the disk has not taken yet."""
        return self._put_bytes - self._written_bytes

    def add_topic(self, name: str, type_name: str, offered: Sequence[OfferedQos]) -> bool:
        """Make a topic known; whether its definition is in the bag.

        Raises:
            SetupError: the disk does not take it.
        """
        self._counts.setdefault(name, TopicCount())
        return self._writer.add_topic(name, type_name, qos_to_yaml(offered))

    def put(
        self,
        topic: str,
        raw: bytes,
        log_ns: int,
        publish_ns: int,
        origin: Numbered = Numbered(),  # noqa: B008 - frozen
    ) -> None:
        """Hand over one message with its times of receipt and of publication [ns]; never blocks."""
        self._counts[topic].count(origin.sequence, origin.stamp_ns, alone=origin.alone)
        if self._error or self.waiting_bytes + len(raw) > self._most_bytes:
            self._refused += 1
            return
        self._put_bytes += len(raw)
        self._queue.put((topic, raw, log_ns, publish_ns))

    def close(self) -> Summary:
        """Write what waits, finish the bag; what it holds. A second call does no harm."""
        self._queue.put(None)
        self._thread.join()
        return self.summary

    def _write(self) -> None:
        try:
            self._drain()
            self._writer.close()
        except Exception as error:  # whatever happens to the disk, the node lives and says so
            self._error = str(error) or type(error).__name__

    def _drain(self) -> None:
        while True:
            try:
                entry = self._queue.get(timeout=self._idle)
            except queue.Empty:
                self._writer.flush()
                continue
            if entry is None:
                return
            self._writer.write(*entry)
            self._written_bytes += len(entry[1])
