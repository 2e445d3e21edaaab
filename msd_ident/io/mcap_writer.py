"""McapWriter: messages as chunks of an MCAP file that is complete, with its index, after every flush.

The mcap library's own writer writes the index once, at the end. This one writes it at every flush; the records are made
by the library.
"""

from __future__ import annotations

import struct
import zlib
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from msd_ident.io.bag_folder import MAGIC
from msd_ident.io.compression import compress
from msd_ident.io.crash_safe_file import CrashSafeFile

_CHUNK_BYTES = 2**20
_MESSAGE = struct.Struct("<BQHIQQ")
_MESSAGE_FIELDS = 22  # bytes of a message record before its data
_FOOTER = struct.Struct("<BQQQ")


class McapWriter:
    """One MCAP file of the profile ``ros2``; nothing of a call is on the disk before ``flush``.

    Args:
        path: name of the file; must not exist.
        compression: ``zstd``, ``lz4``, or empty for none.

    Raises:
        OSError: here and in every method: the disk does not take it.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self._compression = compression
        self._chunk = bytearray()
        self._index: defaultdict[int, list[tuple[int, int]]] = defaultdict(list)
        self._begin = self._end = 0
        self._summary: dict[Opcode, bytearray] = {}
        self._statistics = Statistics(
            attachment_count=0, channel_count=0, channel_message_counts=defaultdict(int), chunk_count=0,
            message_count=0, message_start_time=0, message_end_time=0, metadata_count=0, schema_count=0,
        )  # fmt: skip
        self._file = CrashSafeFile(path)
        try:
            self._file.append(MAGIC + _bytes(Header(profile="ros2", library="msd_ident")))
            self.flush()
        except BaseException:
            self._file.close()
            raise

    @property
    def size(self) -> int:
        """Bytes of the file so far, its index left out and what waits for its chunk counted as it is."""
        return self._file.size + len(self._chunk)

    @property
    def chunks(self) -> int:
        """Number of chunks so far."""
        return self._statistics.chunk_count

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Add a schema and return its id.

        Args:
            name: of the message type, such as ``sensor_msgs/msg/JointState``.
            encoding: of the definition, such as ``ros2msg``.
            data: the definition.
        """
        self._statistics.schema_count += 1
        record = Schema(id=self._statistics.schema_count, name=name, encoding=encoding, data=data)
        self._describe(Opcode.SCHEMA, record)
        return record.id

    def add_channel(self, topic: str, encoding: str, schema: int, metadata: Mapping[str, str]) -> int:
        """Add a channel and return its id.

        Args:
            topic: name of the topic.
            encoding: of its messages, such as ``cdr``.
            schema: id of the schema.
            metadata: texts of the channel, such as the offered QoS.
        """
        self._statistics.channel_count += 1
        record = Channel(
            id=self._statistics.channel_count,
            topic=topic,
            message_encoding=encoding,
            schema_id=schema,
            metadata=dict(metadata),
        )
        self._describe(Opcode.CHANNEL, record)
        return record.id

    def add_message(self, channel: int, sequence: int, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Append a message.

        Args:
            channel: id of the channel.
            sequence: number of the message on its channel.
            log_time_ns, publish_time_ns: when it was received and sent [ns].
            data: serialised message.
        """
        counts = self._statistics
        self._begin = min(self._begin, log_time_ns) if self._index else log_time_ns
        self._end = max(self._end, log_time_ns) if self._index else log_time_ns
        first = counts.message_count == 0
        counts.message_start_time = log_time_ns if first else min(counts.message_start_time, log_time_ns)
        counts.message_end_time = log_time_ns if first else max(counts.message_end_time, log_time_ns)
        counts.message_count += 1
        counts.channel_message_counts[channel] += 1
        self._index[channel].append((log_time_ns, len(self._chunk)))
        length = _MESSAGE_FIELDS + len(data)
        self._chunk += _MESSAGE.pack(
            Opcode.MESSAGE, length, channel, sequence & 0xFFFFFFFF, log_time_ns, publish_time_ns
        )
        self._chunk += data
        if len(self._chunk) >= _CHUNK_BYTES:
            self.finish_chunk()

    def finish_chunk(self) -> None:
        """Close the chunk in progress; without a message it goes on."""
        if not self._index:
            return
        raw = bytes(self._chunk)
        packed = compress(raw, self._compression)
        chunk = _bytes(
            Chunk(
                compression=self._compression, data=packed, message_start_time=self._begin,
                message_end_time=self._end, uncompressed_crc=zlib.crc32(raw), uncompressed_size=len(raw),
            )
        )  # fmt: skip
        begin = self._file.size
        indexes, offsets = bytearray(), {}
        for channel, entries in self._index.items():
            offsets[channel] = begin + len(chunk) + len(indexes)
            indexes += _bytes(MessageIndex(channel_id=channel, records=entries))
        self._file.append(chunk + indexes)
        self._statistics.chunk_count += 1
        index = ChunkIndex(
            chunk_length=len(chunk), chunk_start_offset=begin, compression=self._compression,
            compressed_size=len(packed), message_end_time=self._end, message_index_length=len(indexes),
            message_index_offsets=offsets, message_start_time=self._begin, uncompressed_size=len(raw),
        )  # fmt: skip
        self._add_to_summary(Opcode.CHUNK_INDEX, index)
        self._chunk.clear()
        self._index.clear()

    def flush(self) -> None:
        """Write everything so far to the disk, as a complete file."""
        self.finish_chunk()
        self._file.show(self._tail())

    def close(self, metadata: Mapping[str, str] | None = None) -> None:
        """Finish the file, with rosbag2's metadata in it if given."""
        self.finish_chunk()
        if metadata:
            record = _bytes(Metadata(name="rosbag2", metadata=dict(metadata)))
            index = MetadataIndex(offset=self._file.size, length=len(record), name="rosbag2")
            self._file.append(record)
            self._statistics.metadata_count += 1
            self._add_to_summary(Opcode.METADATA_INDEX, index)
        self._file.show(self._tail())
        self._file.close()

    def abandon(self) -> None:
        """Stop writing and leave the file as it was at the last flush."""
        self._file.close()

    def _describe(self, opcode: Opcode, record: McapRecord) -> None:
        """Schemas and channels stand in the chunk in progress, before the messages that need them, and in the index."""
        self._chunk += _bytes(record)
        self._add_to_summary(opcode, record)

    def _add_to_summary(self, opcode: Opcode, record: McapRecord) -> None:
        self._summary.setdefault(opcode, bytearray()).extend(_bytes(record))

    def _tail(self) -> bytes:
        """End of the data section, index and footer, for a file that ends here."""
        end = _bytes(DataEnd(data_section_crc=0))
        start = self._file.size + len(end)
        kinds = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS, Opcode.CHUNK_INDEX, Opcode.METADATA_INDEX)
        groups: dict[Opcode, bytes | bytearray] = {**self._summary, Opcode.STATISTICS: _bytes(self._statistics)}
        summary, offsets = bytearray(), bytearray()
        for kind in kinds:
            group = groups.get(kind)
            if group:
                place = SummaryOffset(group_opcode=kind, group_start=start + len(summary), group_length=len(group))
                offsets += _bytes(place)
                summary += group
        offset_start = start + len(summary)
        summary += offsets
        crc = zlib.crc32(_FOOTER.pack(Opcode.FOOTER, 20, start, offset_start), zlib.crc32(summary))
        footer = _bytes(Footer(summary_start=start, summary_offset_start=offset_start, summary_crc=crc))
        return bytes(end + summary + footer + MAGIC)


def _bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]
