"""Records of an MCAP file, one by one, from bytes that may be anything."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from mmap import mmap
from typing import Any, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, McapRecord, Schema, Statistics

from msd_ident.io.compression import DecodeError, decompress

FRAME = struct.Struct("<BQ")
CHUNK = struct.Struct("<QQQII")
MESSAGE = struct.Struct("<HIQQ")
LATEST_NS = 2**63
#: No chunk is larger [bytes]; a damaged one may claim anything.
LARGEST_CHUNK = 2**29
#: More zeros than any message holds: at the end of a file that is cut off they are blocks that never reached the disk.
_UNWRITTEN = b"\0" * 512


class StoredMessage(NamedTuple):
    """One message as the file has it."""

    channel: int
    log_time_ns: int
    publish_time_ns: int
    data: bytes


def frames(data: bytes | mmap, position: int, stop: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, and begin and end of the body, of each whole record.

    Args:
        data: bytes of records.
        position: offset of the first record.
        stop: offset at which the records end.
    """
    while position + FRAME.size <= stop:
        opcode, length = FRAME.unpack_from(data, position)
        begin = position + FRAME.size
        position = begin + length
        if opcode == 0 or position > stop:
            return
        yield opcode, begin, position


def stored_message(data: bytes, begin: int, end: int) -> StoredMessage | None:
    """Message from the body of a record.

    Args:
        data: bytes that contain the body.
        begin, end: offsets of the body.

    Returns:
        None if the body is too short or its log time is impossibly late.
    """
    if end - begin < MESSAGE.size:
        return None
    channel, _, log_time, publish_time = MESSAGE.unpack_from(data, begin)
    if log_time >= LATEST_NS:
        return None
    return StoredMessage(channel, log_time, publish_time, data[begin + MESSAGE.size : end])


def parse(opcode: int, body: bytes) -> McapRecord | None:
    """Channel, schema, statistics or chunk index from the body of a record.

    Args:
        opcode: kind of the record.
        body: bytes of the body.

    Returns:
        None for other kinds and for bytes that cannot be parsed.
    """
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


def unpack(body: bytes, whole: bool) -> tuple[bytes, bool]:
    """Uncompressed records of a chunk.

    Args:
        body: of the chunk's record.
        whole: whether the chunk is complete; of one that is cut off, the records before the cut are returned.

    Returns:
        The records, and whether they are complete. No records if the checksum is wrong.
    """
    if len(body) < CHUNK.size:
        return b"", False
    *_, size, crc, name_length = CHUNK.unpack_from(body)
    data_at = CHUNK.size + name_length + 8
    compression = body[CHUNK.size : CHUNK.size + name_length].decode(errors="replace")
    packed = body[data_at : data_at + _length(body, data_at - 8)]
    if size > LARGEST_CHUNK:
        return b"", False
    if not whole:
        unwritten = packed.find(_UNWRITTEN)
        packed = packed if unwritten < 0 else packed[:unwritten]
    try:
        raw = decompress(packed, compression, size + 1)
    except DecodeError:
        return b"", False
    if not whole:
        return raw, False
    if len(raw) != size or (crc and zlib.crc32(raw) != crc):
        return b"", False
    return raw, True


def _length(body: bytes, position: int) -> int:
    return int.from_bytes(body[position : position + 8], "little")
