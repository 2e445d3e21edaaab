"""One MCAP file, read as far as it can be: truncated, cut off by a kill, or with damaged chunks.

The mcap library's readers stop at the first fault. This walks the records itself (their bodies are
parsed by the library), checks every checksum that is there, and counts what was lost. A chunk whose
checksum fails is dropped whole: better no sample than a wrong one.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from mmap import mmap
from typing import Any, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Footer, McapRecord, Schema, Statistics

from msd_ident.bag.compression import DecodeError, decompress
from msd_ident.errors import DataError

MAGIC = b"\x89MCAP0\r\n"
_FRAME = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQII")
_MESSAGE = struct.Struct("<HIQQ")
_FOOTER_BYTES = _FRAME.size + 20 + len(MAGIC)
_LATEST_NS = 2**63
#: More zeros than any message holds: at the end of a file that is cut off they are blocks that never reached the disk.
_UNWRITTEN = b"\0" * 512


class StoredMessage(NamedTuple):
    """One message as the file has it."""

    channel: int
    log_time_ns: int
    publish_time_ns: int
    data: bytes


@dataclass(frozen=True)
class _Segment:
    """A chunk (or a run of messages outside chunks): where its body lies, and the first log time in it [ns]."""

    begin: int
    end: int
    start_ns: int
    chunked: bool
    whole: bool = True


class McapFile:
    """The records of one file.

    Attributes:
        channels: by id; complete after construction.
        schemas: by id.
        losses: what could not be read, one sentence each; complete after a full pass of ``messages``.

    Raises:
        DataError: the file is empty or no MCAP file.
    """

    def __init__(self, data: bytes | mmap, name: str) -> None:
        if not data:
            raise DataError(f"{name} is empty; expected an MCAP file: record again")
        if data[: len(MAGIC)] != MAGIC:
            raise DataError(f"{name} does not begin like an MCAP file; expected a bag: is it another kind of file?")
        self._data = data
        self._name = name
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        self.losses: tuple[str, ...] = ()
        self._segments: list[_Segment] = []
        self._faults: list[str] = []
        self._indexed, self._stated = self._read_summary()
        self._walk()
        if not self._faults and self._data[-len(MAGIC) :] != MAGIC:
            self._faults.append("the file ends without its index")
        if self._stated is None or not self.channels:
            for _ in self.messages():
                pass

    def messages(self, *, by_log_time: bool = False) -> Iterator[StoredMessage]:
        """All messages that can be read, in the order of the file or by log time."""
        damaged, read = 0, 0
        waiting: list[StoredMessage] = []
        segments = sorted(self._segments, key=lambda s: s.start_ns) if by_log_time else self._segments
        for i, segment in enumerate(segments):
            found, complete = self._load(segment)
            damaged += segment.chunked and segment.whole and not complete
            read += len(found)
            if not by_log_time:
                yield from found
                continue
            waiting = sorted([*waiting, *found], key=lambda message: message.log_time_ns)
            limit = segments[i + 1].start_ns if i + 1 < len(segments) else _LATEST_NS
            ready = sum(1 for message in waiting if message.log_time_ns < limit)
            yield from waiting[:ready]
            waiting = waiting[ready:]
        self._state_losses(damaged, read)

    def _state_losses(self, damaged: int, read: int) -> None:
        losses = list(self._faults)
        if damaged:
            losses.append(f"{damaged} of {len(self._segments)} chunks are damaged and were left out")
        if self._stated is not None and read < self._stated:
            losses.append(f"{self._stated - read} of {self._stated} messages are lost")
        elif losses:
            losses.append(f"{read} messages could be read")
        self.losses = (f"{self._name}: " + "; ".join(losses) + ".",) if losses else ()

    def _read_summary(self) -> tuple[list[int], int | None]:
        """Keep channels and schemas of the index; offsets of the chunks and number of messages that it gives."""
        data = self._data
        if len(data) < len(MAGIC) + _FOOTER_BYTES or data[-len(MAGIC) :] != MAGIC:
            return [], None
        footer_at = len(data) - _FOOTER_BYTES
        if data[footer_at] != Opcode.FOOTER:
            return [], None
        footer = Footer.read(ReadDataStream(BytesIO(data[footer_at + _FRAME.size :])))
        summary = data[footer.summary_start : footer_at + _FRAME.size + 16]
        if not footer.summary_start or footer.summary_start >= footer_at:
            return [], None
        if footer.summary_crc and zlib.crc32(summary) != footer.summary_crc:
            self._faults.append("the index at its end is damaged")
            return [], None
        offsets: list[int] = []
        stated: int | None = None
        for opcode, begin, end in _frames(data, footer.summary_start, footer_at):
            record = _parse(opcode, data[begin:end])
            self._keep(record)
            if isinstance(record, Statistics):
                stated = record.message_count
            elif isinstance(record, ChunkIndex):
                offsets.append(record.chunk_start_offset)
        return offsets, stated

    def _keep(self, record: McapRecord | None) -> None:
        if isinstance(record, Channel):
            self.channels.setdefault(record.id, record)
        elif isinstance(record, Schema):
            self.schemas.setdefault(record.id, record)

    def _walk(self) -> None:
        """Find the segments; after a fault go on at the next chunk that the index knows.

        What looks like a message between chunks after a fault is taken for debris.
        """
        position = len(MAGIC)
        while True:
            fault = self._walk_from(position)
            if fault is None:
                return
            if any(segment.chunked for segment in self._segments):
                self._segments = [segment for segment in self._segments if segment.chunked]
            later = [offset for offset in self._indexed if offset > fault]
            if not later:
                cut = "ends without its index" if fault + _FRAME.size > len(self._data) else "is cut off or damaged"
                self._faults.append(f"the file {cut} at byte {fault} of {len(self._data)}")
                return
            self._faults.append(f"damaged at byte {fault}")
            position = min(later)

    def _walk_from(self, position: int) -> int | None:
        """Walk records; the offset where that fails, ``None`` when the data section ends as it should."""
        data, size = self._data, len(self._data)
        while position + _FRAME.size <= size:
            opcode, length = _FRAME.unpack_from(data, position)
            begin, end = position + _FRAME.size, position + _FRAME.size + length
            if opcode == Opcode.DATA_END and end <= size:
                return None
            if opcode == 0 or Opcode.DATA_END < opcode < 0x80:
                return position
            if opcode == Opcode.CHUNK and begin + _CHUNK.size <= size:
                start_ns = _CHUNK.unpack_from(data, begin)[0]
                if end <= size or not any(offset > position for offset in self._indexed):
                    self._segments.append(_Segment(begin, min(end, size), start_ns, True, end <= size))
            if end > size:
                return position
            if opcode == Opcode.MESSAGE:
                self._add_message(begin, end)
            elif opcode != Opcode.CHUNK:
                self._keep(_parse(opcode, data[begin:end]))
            position = end
        return position

    def _add_message(self, begin: int, end: int) -> None:
        if end - begin < _MESSAGE.size:
            return
        log_time = _MESSAGE.unpack_from(self._data, begin)[2]
        self._segments.append(_Segment(begin, end, log_time, chunked=False))

    def _load(self, segment: _Segment) -> tuple[list[StoredMessage], bool]:
        """Messages of a segment, and whether all of it could be read."""
        if not segment.chunked:
            message = _message(self._data[segment.begin : segment.end], 0, segment.end - segment.begin)
            return ([message], True) if message else ([], False)
        raw, complete = _unpack(self._data[segment.begin : segment.end], segment.whole)
        messages = []
        position = 0
        for opcode, begin, end in _frames(raw, 0, len(raw)):
            position = end
            if opcode == Opcode.MESSAGE:
                message = _message(raw, begin, end)
                if message:
                    messages.append(message)
            elif opcode in (Opcode.CHANNEL, Opcode.SCHEMA):
                self._keep(_parse(opcode, raw[begin:end]))
        return messages, complete and position == len(raw)


def _frames(data: bytes | mmap, position: int, stop: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, begin and end of the body of each whole record."""
    while position + _FRAME.size <= stop:
        opcode, length = _FRAME.unpack_from(data, position)
        begin = position + _FRAME.size
        position = begin + length
        if opcode == 0 or position > stop:
            return
        yield opcode, begin, position


def _message(data: bytes, begin: int, end: int) -> StoredMessage | None:
    """Message from the body of a record, ``None`` for one that is too short or later than any clock says."""
    if end - begin < _MESSAGE.size:
        return None
    channel, _, log_time, publish_time = _MESSAGE.unpack_from(data, begin)
    if log_time >= _LATEST_NS:
        return None
    return StoredMessage(channel, log_time, publish_time, data[begin + _MESSAGE.size : end])


def _parse(opcode: int, body: bytes) -> McapRecord | None:
    """Record of one of the kinds that matter here; ``None`` for others and for nonsense."""
    kinds: dict[int, Any] = {
        Opcode.CHANNEL: Channel,
        Opcode.SCHEMA: Schema,
        Opcode.STATISTICS: Statistics,
        Opcode.CHUNK_INDEX: ChunkIndex,
    }
    kind = kinds.get(opcode)
    if kind is None:
        return None
    try:
        record: McapRecord = kind.read(ReadDataStream(BytesIO(body)))
    except (struct.error, ValueError, McapError):
        return None
    return record


def _unpack(body: bytes, whole: bool) -> tuple[bytes, bool]:
    """Uncompressed records of a chunk, and whether they are complete; a prefix of them for a chunk that is cut off."""
    if len(body) < _CHUNK.size:
        return b"", False
    *_, size, crc, name_length = _CHUNK.unpack_from(body)
    data_at = _CHUNK.size + name_length + 8
    compression = body[_CHUNK.size : _CHUNK.size + name_length].decode(errors="replace")
    packed = body[data_at : data_at + _length(body, data_at - 8)]
    if not whole:
        unwritten = packed.find(_UNWRITTEN)
        packed = packed if unwritten < 0 else packed[:unwritten]
    try:
        raw = decompress(packed, compression)
    except DecodeError:
        return b"", False
    if not whole:
        return raw, False
    if len(raw) != size or (crc and zlib.crc32(raw) != crc):
        return b"", False
    return raw, True


def _length(body: bytes, position: int) -> int:
    return int.from_bytes(body[position : position + 8], "little")
