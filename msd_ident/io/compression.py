"""Compressed files and messages of rosbag2, and chunks of MCAP: zstd, lz4 or none."""

from __future__ import annotations

from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from msd_ident.errors import DataError

#: Endings of a storage file that was compressed as a whole.
PACKED = (".zstd", ".zst")
_STEP = 2**22


class DecodeError(Exception):
    """The bytes are not what they say."""


def plain_name(path: Path) -> str:
    """Name without the ending that says that it is compressed."""
    return path.name.removesuffix(PACKED[0]).removesuffix(PACKED[1])


def decompress(packed: bytes, compression: str, most: int = 2**40) -> bytes:
    """Decompressed bytes; of a stream that is cut off, those before the cut.

    Args:
        packed: compressed bytes.
        compression: ``zstd``, ``lz4``, or empty for none.
        most: largest number of bytes to return.

    Raises:
        DecodeError: the bytes are damaged, or the compression is not known.
    """
    try:
        if compression == "zstd":
            return _read_zstd(packed, most)
        if compression == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, most))
    except (zstandard.ZstdError, RuntimeError, EOFError, MemoryError) as error:
        raise DecodeError(str(error)) from None
    if compression:
        raise DecodeError(f"compression {compression!r} is not known")
    return packed


def _read_zstd(packed: bytes, most: int) -> bytes:
    """In steps: a few damaged bytes may claim terabytes."""
    with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
        parts = []
        while most > 0 and (part := stream.read(min(most, _STEP))):
            parts.append(part)
            most -= len(part)
    return b"".join(parts)


def compress(raw: bytes, compression: str) -> bytes:
    """Compressed bytes.

    Args:
        raw: bytes to compress.
        compression: ``zstd``, ``lz4``, or empty for none.
    """
    if compression == "zstd":
        return zstandard.ZstdCompressor().compress(raw)
    return bytes(lz4.frame.compress(raw)) if compression == "lz4" else raw


def unpack_file(path: Path) -> bytes:
    """Content of a file that was compressed with zstd as a whole.

    Raises:
        DataError: it is not, or it is damaged.
    """
    try:
        return decompress(path.read_bytes(), "zstd")
    except DecodeError:
        raise DataError(f"{path} is damaged or not compressed with zstd; expected a whole bag file") from None
