"""Truncates bags at any byte: all messages of complete chunks must be recovered, and no wrong one."""

from __future__ import annotations

import io
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader, breakup_chunk

from msd_ident.data.record import from_samples
from msd_ident.errors import DataError
from msd_ident.io import BagWriter, open_bag, repair
from msd_ident.io.writer import Compression
from msd_sim.api import simulate

#: A message as it is compared: log time [ns] and bytes.
Seen = tuple[int, bytes]


@dataclass(frozen=True)
class Whole:
    """A bag file that is whole.

    Attributes:
        content: its bytes.
        messages: all of them, in the order of the file.
        chunks: where each chunk ends, and how many messages the file has until there.
    """

    content: bytes
    messages: list[Seen]
    chunks: list[tuple[int, int]]


def make(folder: Path, compression: Compression, flush_every: int = 60, samples: int = 500) -> Whole:
    """A short step experiment of the demo's rig; its chunks as the mcap library sees them."""
    found = simulate({"rig": "ecp", "experiment": {"name": "paper", "hold": samples / 2000}, "rate": 1000.0})
    record = from_samples(found.time, found.motion.force, found.position)
    source = folder / "source"
    write(record, source, compression, flush_every)
    content = next(source.glob("*.mcap")).read_bytes()
    chunks, messages = [], []
    stream = io.BytesIO(content)
    for item in StreamReader(stream, emit_chunks=True).records:
        if isinstance(item, Chunk):
            messages += [(m.log_time, m.data) for m in breakup_chunk(item) if isinstance(m, Message)]
            chunks.append((stream.tell(), len(messages)))
    return Whole(content, messages, chunks)


def write(record: object, folder: Path, compression: Compression, flush_every: int) -> None:
    """A record as a bag with a chunk for every so many messages."""
    from msd_ident.io import iterate_messages, write_bag

    plain = folder.with_name(f"{folder.name}_plain")
    write_bag(record, plain)  # type: ignore[arg-type]
    with BagWriter(folder, compression) as bag:
        for i, message in enumerate(iterate_messages(plain)):
            bag.add_topic(message.topic, message.type)
            bag.write(message.topic, message.data, message.log_time_ns)
            if i % flush_every == flush_every - 1:
                bag.flush()


def places(whole: Whole, count: int, seed: int) -> list[int]:
    """Every border of a chunk, one byte before and one behind it, and so many more at random."""
    borders = {end + shift for end, _ in whole.chunks for shift in (-1, 0, 1)}
    chosen = random.Random(seed)
    return [*sorted(borders), *(chosen.randrange(len(whole.content)) for _ in range(count))]


def cut(whole: Whole, at: int, folder: Path) -> int:
    """Cut the file there, read it, repair it, read it again; number of messages that came back.

    Raises:
        AssertionError: a wrong message, one lost that lies in a whole chunk, or a repair that loses one.
    """
    path = folder / "cut.mcap"
    path.write_bytes(whole.content[:at])
    due = max((count for end, count in whole.chunks if end <= at), default=0)
    found = _read(path)
    if found is None:
        if due:
            raise AssertionError(f"refused when cut at {at}, behind {due} messages in whole chunks")
        return 0
    if found != whole.messages[: len(found)]:
        raise AssertionError(f"wrong messages when cut at {at}")
    if len(found) < due:
        raise AssertionError(f"{len(found)} of {due} messages in whole chunks when cut at {at}")
    done = repair(path)
    if done.messages != len(found) or _read(path) != found or repair(path).changed:
        raise AssertionError(f"repaired after a cut at {at}: {done.sentence}")
    for kept in folder.glob("cut.mcap.*"):
        kept.unlink()
    return len(found)


def cuts(whole: Whole, count: int, seed: int, folder: Path) -> Iterator[tuple[int, int]]:
    """Place of each cut, and messages that came back."""
    for at in places(whole, count, seed):
        yield at, cut(whole, at, folder)


def _read(path: Path) -> Sequence[Seen] | None:
    try:
        return [(one.log_time_ns, one.data) for one in open_bag(path).messages(by_log_time=False)]
    except DataError:
        return None
