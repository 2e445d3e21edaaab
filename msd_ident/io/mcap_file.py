"""One MCAP file, read as far as possible: truncated, not finished because of a kill, or with damaged chunks.

The mcap library's readers stop at the first fault. This module walks through the records itself (the library parses
their bodies), checks every checksum that is there, and counts what was lost. A chunk with a wrong checksum is dropped
as a whole: no sample is better than a wrong one.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from mmap import mmap

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Footer, McapRecord, Schema, Statistics

from msd_ident.errors import DataError
from msd_ident.io.bag_folder import MAGIC
from msd_ident.io.mcap_records import (
    CHUNK,
    FRAME,
    LARGEST_CHUNK,
    LATEST_NS,
    MESSAGE,
    StoredMessage,
    frames,
    parse,
    stored_message,
    unpack,
)
from msd_ident.io.qos import qos_from_yaml
from msd_ident.io.topics import RawMessage, Topic

_FOOTER_BYTES = FRAME.size + 20 + len(MAGIC)


@dataclass(frozen=True)
class _Segment:
    """A chunk (or a run of messages outside chunks): where its body lies, and the first log time in it [ns]."""

    begin: int
    end: int
    start_ns: int
    chunked: bool
    whole: bool = True


@dataclass
class Loss:
    """What of a file cannot be read.

    Attributes:
        messages: number of them.
        seconds: log time that they covered.
        exact: whether the file states how many messages it held; else the number is estimated from the sizes.
    """

    messages: int = 0
    seconds: float = 0.0
    exact: bool = True


class McapFile:
    """The records of one file.

    Attributes:
        channels: by id; complete after construction.
        schemas: by id.
        losses: what could not be read, one sentence each; complete after a full pass of ``messages``.
        loss: the same in numbers.

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
        self.loss = Loss()
        self._segments: list[_Segment] = []
        self._faults: list[str] = []
        self._indexed, self._stated = self._read_summary()
        self._walk()
        if not self._faults and self._data[-len(MAGIC) :] != MAGIC:
            self._faults.append("the file ends without its index")
        if self._stated is None or not self.channels:
            for _ in self.messages():
                pass

    def topics(self) -> tuple[Topic, ...]:
        """Topics of the file, one for each channel."""
        return tuple(self._topic(channel) for channel in self.channels.values())

    def _topic(self, channel: Channel) -> Topic:
        schema = self.schemas.get(channel.schema_id)
        return Topic(
            name=channel.topic,
            type=schema.name if schema else "",
            encoding=channel.message_encoding,
            definition=schema.data.decode(errors="replace") if schema else "",
            definition_format=schema.encoding if schema else "",
            offered_qos=qos_from_yaml(channel.metadata.get("offered_qos_profiles")),
        )

    def raw_messages(self, by_log_time: bool) -> Iterator[RawMessage]:
        """All messages that can be read and have a channel, by log time or in stored order."""
        topics = {key: self._topic(channel) for key, channel in self.channels.items()}
        for message in self.messages(by_log_time=by_log_time):
            if topic := topics.get(message.channel):
                yield RawMessage(topic.name, topic.type, message.data, message.log_time_ns, message.publish_time_ns)

    def messages(self, *, by_log_time: bool = False) -> Iterator[StoredMessage]:
        """All messages that can be read, in the order of the file or by log time."""
        damaged, read, size, loss = 0, 0, 0, Loss(exact=self._stated is not None)
        waiting: list[StoredMessage] = []
        segments = sorted(self._segments, key=lambda s: s.start_ns) if by_log_time else self._segments
        for i, segment in enumerate(segments):
            found, complete = self._load(segment)
            damaged += segment.chunked and segment.whole and not complete
            read += len(found)
            size += sum(len(message.data) for message in found)
            if segment.chunked and not complete:
                self._count_loss(loss, segment, found, size / max(read, 1))
            if not by_log_time:
                yield from found
                continue
            waiting = sorted([*waiting, *found], key=lambda message: message.log_time_ns)
            limit = segments[i + 1].start_ns if i + 1 < len(segments) else LATEST_NS
            ready = sum(1 for message in waiting if message.log_time_ns < limit)
            yield from waiting[:ready]
            waiting = waiting[ready:]
        loss.messages = loss.messages if self._stated is None else max(self._stated - read, 0)
        self.loss = loss
        self._state_losses(damaged, read)

    def _count_loss(self, loss: Loss, segment: _Segment, found: list[StoredMessage], usual: float) -> None:
        """Add what a chunk says it held and did not give; its messages are taken for as long as usual."""
        if segment.begin + CHUNK.size > len(self._data):
            return
        begin, end, size, *_ = CHUNK.unpack_from(self._data, segment.begin)
        begin = found[-1].log_time_ns if found else begin
        if begin <= end < LATEST_NS:
            loss.seconds += (end - begin) / 1e9
        frame = FRAME.size + MESSAGE.size
        left = size - sum(len(message.data) + frame for message in found)
        if usual and 0 < left < LARGEST_CHUNK:
            loss.messages += round(left / (usual + frame))

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
        footer = Footer.read(ReadDataStream(BytesIO(data[footer_at + FRAME.size :])))
        summary = data[footer.summary_start : footer_at + FRAME.size + 16]
        if not footer.summary_start or footer.summary_start >= footer_at:
            return [], None
        if footer.summary_crc and zlib.crc32(summary) != footer.summary_crc:
            self._faults.append("the index at its end is damaged")
            return [], None
        offsets: list[int] = []
        stated: int | None = None
        for opcode, begin, end in frames(data, footer.summary_start, footer_at):
            record = parse(opcode, data[begin:end])
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
        """Find the segments; after a fault go on at the next chunk that the index knows."""
        position = len(MAGIC)
        while True:
            fault = self._walk_from(position)
            if fault is None:
                self._leave_debris()
                return
            later = [offset for offset in self._indexed if offset > fault]
            if not later:
                cut = "ends without its index" if fault + FRAME.size > len(self._data) else "is cut off or damaged"
                self._faults.append(f"the file {cut} at byte {fault} of {len(self._data)}")
                self._leave_debris()
                return
            self._faults.append(f"damaged at byte {fault}")
            position = min(later)

    def _leave_debris(self) -> None:
        """No recorder writes messages between chunks: what looks like one has no checksum and is a damaged record."""
        chunks = [segment for segment in self._segments if segment.chunked]
        if chunks and len(chunks) < len(self._segments):
            self._faults.append(f"{len(self._segments) - len(chunks)} records between chunks are damaged")
            self._segments = chunks

    def _walk_from(self, position: int) -> int | None:
        """Walk records; the offset where that fails, ``None`` when the data section ends as it should."""
        data, size = self._data, len(self._data)
        while position + FRAME.size <= size:
            opcode, length = FRAME.unpack_from(data, position)
            begin, end = position + FRAME.size, position + FRAME.size + length
            if opcode == Opcode.DATA_END and end <= size:
                return None
            if opcode == 0 or Opcode.DATA_END < opcode < 0x80:
                return position
            if opcode == Opcode.CHUNK and begin + CHUNK.size <= size:
                start_ns = CHUNK.unpack_from(data, begin)[0]
                if end <= size or not any(offset > position for offset in self._indexed):
                    self._segments.append(_Segment(begin, min(end, size), start_ns, True, end <= size))
            if end > size:
                return position
            if opcode == Opcode.MESSAGE:
                self._add_message(begin, end)
            elif opcode != Opcode.CHUNK:
                self._keep(parse(opcode, data[begin:end]))
            position = end
        return position

    def _add_message(self, begin: int, end: int) -> None:
        if end - begin < MESSAGE.size:
            return
        log_time = MESSAGE.unpack_from(self._data, begin)[2]
        self._segments.append(_Segment(begin, end, log_time, chunked=False))

    def _load(self, segment: _Segment) -> tuple[list[StoredMessage], bool]:
        """Messages of a segment, and whether all of it could be read."""
        if not segment.chunked:
            message = stored_message(self._data[segment.begin : segment.end], 0, segment.end - segment.begin)
            return ([message], True) if message else ([], False)
        raw, complete = unpack(self._data[segment.begin : segment.end], segment.whole)
        messages = []
        position = 0
        for opcode, begin, end in frames(raw, 0, len(raw)):
            position = end
            if opcode == Opcode.MESSAGE:
                message = stored_message(raw, begin, end)
                if message:
                    messages.append(message)
            elif opcode in (Opcode.CHANNEL, Opcode.SCHEMA):
                self._keep(parse(opcode, raw[begin:end]))
        return messages, complete and position == len(raw)
