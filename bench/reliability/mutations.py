"""Damages bags, metadata, tables and configuration: reading must give a result or an error of one line."""

from __future__ import annotations

import multiprocessing
import os
import random
import resource
import shutil
import signal
import struct
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.writer import CompressionType, Writer

from bench.reliability.cuts import make
from msd_ident.errors import MsdError
from msd_ident.io import SourceOptions, describe, open_bag, read, repair
from msd_sim import config
from msd_sim.errors import RigError

#: What reading a damaged file may take: processor time, and memory.
SECONDS, BYTES = 10, 2**30

Damage = Callable[[bytearray, random.Random], None]


@dataclass(frozen=True)
class Kind:
    """A kind of file: how one is made, what is done to it, and how it is read.

    Attributes:
        name: in words.
        make: writes a sound one below a folder; gives its path.
        try_it: reads a file; gives a word for what came of it.
    """

    name: str
    make: Callable[[Path], Path]
    try_it: Callable[[Path], str]


# What may happen to bytes.


def flip_bits(data: bytearray, chosen: random.Random) -> None:
    """Some bits turned."""
    for _ in range(chosen.randint(1, 8)):
        data[chosen.randrange(len(data))] ^= 1 << chosen.randrange(8)


def change_numbers(data: bytearray, chosen: random.Random) -> None:
    """Numbers of 1, 2, 4 or 8 bytes replaced by extreme ones: lengths, opcodes, stamps."""
    for _ in range(chosen.randint(1, 3)):
        size = chosen.choice([1, 2, 4, 8])
        value = chosen.choice([0, 1, 2**31 - 1, 2**63, 2**64 - 1, 2**32 - 1, chosen.getrandbits(64), len(data)])
        at = chosen.randrange(max(len(data) - size, 1))
        data[at : at + size] = struct.pack("<Q", value)[:size]


def change_records(data: bytearray, chosen: random.Random) -> None:
    """The opcode or the length of a record, found by walking from the front as a reader does."""
    places, at = [], 8
    while at + 9 <= len(data):
        places.append(at)
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
    at = chosen.choice(places or [0])
    if chosen.random() < 0.3:
        data[at] = chosen.randrange(256)
    else:
        length = chosen.choice([0, 1, 9, 2**16, 2**31, 2**63, 2**64 - 1, chosen.getrandbits(20)])
        data[at + 1 : at + 9] = struct.pack("<Q", length)


def change_text(data: bytearray, chosen: random.Random) -> None:
    """Letters, digits and signs of a schema, a name or a table replaced by others of their kind or by odd ones."""
    letters = [i for i, byte in enumerate(data) if 32 <= byte < 127]
    for _ in range(chosen.randint(1, 12)):
        data[chosen.choice(letters or [0])] = chosen.choice(b"0123456789abcxyz/[]<=>#_-:;,.{}&*!|%@\"'\\\n\t \xff\0")


def move_pieces(data: bytearray, chosen: random.Random) -> None:
    """A piece is missing, there twice, or zeros."""
    at = chosen.randrange(len(data))
    size = chosen.choice([1, 9, 100, 4096, len(data) // 3])
    piece = data[at : at + size]
    kind = chosen.randrange(3)
    data[at : at + size] = b"" if kind == 0 else piece * 2 if kind == 1 else bytes(len(piece))


def repeat_much(data: bytearray, chosen: random.Random) -> None:
    """A short piece many times: long lines, deep nesting."""
    at, size = chosen.randrange(len(data)), chosen.choice([1, 2, 3, 20])
    data[at:at] = data[at : at + size] * chosen.choice([10, 1000, 20000])


DAMAGES: tuple[Damage, ...] = (flip_bits, change_numbers, change_records, change_text, move_pieces, repeat_much)


# What is read.


def bag(folder: Path) -> Path:
    """A bag with checksums, in chunks."""
    return _bag(folder, "zstd")


def _bag(folder: Path, compression: Any) -> Path:
    whole = make(folder, compression, samples=150)
    path = folder / "sound.mcap"
    path.write_bytes(whole.content)
    return path


def bag_without_checksums(folder: Path) -> Path:
    """The same without checksums and compression: damage gets through to the messages."""
    source = open_bag(_bag(folder, "none"))
    path = folder / "plain.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE, enable_crcs=False, chunk_size=8000)
        writer.start(profile="ros2")
        channels = {}
        for topic in source.topics.values():
            schema = writer.register_schema(topic.type, "ros2msg", topic.definition.encode())
            channels[topic.name] = writer.register_channel(topic.name, "cdr", schema, {"offered_qos_profiles": ""})
        for one in source.messages():
            writer.add_message(channels[one.topic], one.log_time_ns, one.data, one.publish_time_ns)
        writer.finish()
    return path


def metadata(folder: Path) -> Path:
    """The metadata.yaml of a bag."""
    make(folder, "zstd", samples=150)
    return folder / "source" / "metadata.yaml"


def table(folder: Path) -> Path:
    """A CSV file."""
    from msd_ident.io import write_csv

    _bag(folder, "zstd")
    write_csv(read(folder / "sound.mcap"), folder / "sound.csv")
    return folder / "sound.csv"


def rig(folder: Path) -> Path:
    """The file of a rig."""
    path = folder / "rig.yaml"
    shutil.copy(Path(__file__).parents[2] / "config" / "ecp.yaml", path)
    return path


def try_bag(path: Path) -> str:
    """Read, describe and repair it."""
    outcome = _tried(lambda: read(path))
    _tried(lambda: describe(path))
    return outcome if _tried(lambda: repair(path)) == "read" else f"{outcome}, not repaired"


def try_own_bag(path: Path) -> str:
    """The same, and whatever comes back was written."""
    if not _known:
        _known.update(_messages(path.with_name("sound.mcap")))
    outcome = "read"
    try:
        found = _messages(path)
    except MsdError:
        return "refused"
    if not found <= _known:
        raise AssertionError(f"{len(found - _known)} messages that nobody wrote")
    return try_bag(path) if outcome == "read" else outcome


_known: set[tuple[str, bytes]] = set()


def _messages(path: Path) -> set[tuple[str, bytes]]:
    return {(one.topic, one.data) for one in open_bag(path).messages()}


def try_folder(path: Path) -> str:
    """The folder whose metadata were damaged."""
    return try_bag(path.parent)


def try_table(path: Path) -> str:
    """As ``msd info`` and ``msd identify`` read it."""
    _tried(lambda: describe(path))
    _tried(lambda: read(path, SourceOptions(force="none", position="position_m", time="time_s")))
    return _tried(lambda: read(path))


def try_rig(path: Path) -> str:
    """As ``msd simulate`` does."""
    return _tried(lambda: config.parse(config.load(str(path))))


def _tried(action: Callable[[], object]) -> str:
    try:
        action()
    except (MsdError, RigError) as error:
        line = str(error)
        if "\n" in line or len(line) < 20 or len(line) > 3000:
            raise AssertionError(f"not one line: {line[:300]!r}") from None
        return "refused"
    return "read"


KINDS = (
    Kind("bag with checksums", bag, try_own_bag),
    Kind("bag without checksums", bag_without_checksums, try_bag),
    Kind("metadata.yaml", metadata, try_folder),
    Kind("CSV file", table, try_table),
    Kind("YAML file of a rig", rig, try_rig),
)


# Trying them, in a process of its own that may not take more than it should.


@dataclass(frozen=True)
class Outcome:
    """Of many damaged files: counts by outcome, the longest reading [s of processor time], faults in words."""

    counts: Counter[str]
    longest: float
    faults: list[str]


def attack(kind: Kind, folder: Path, count: int, seed: int) -> Outcome:
    """Damage and read so many files; a traceback, a hang or too much memory is a fault with its seed."""
    sound = kind.make(folder)
    original = sound.read_bytes()
    counts: Counter[str] = Counter()
    longest, faults, begin = 0.0, [], 0
    while begin < count:
        fork = multiprocessing.get_context("fork")
        here, there = fork.Pipe(duplex=False)
        process = fork.Process(target=_work, args=(kind, sound, original, range(begin, count), seed, there))
        process.start()
        there.close()
        for number, outcome, seconds in _received(here):
            begin, longest = number + 1, max(longest, seconds)
            counts[outcome.partition(":")[0]] += 1
            if ":" in outcome:
                faults.append(f"{kind.name}, number {number} of seed {seed}: {outcome}")
        process.join()
        if begin < count and process.exitcode:
            how = "took more than 10 s" if process.exitcode == -signal.SIGPROF else f"died of {-process.exitcode}"
            faults.append(f"{kind.name}, number {begin} of seed {seed}: {how}")
            counts["fault"] += 1
            begin += 1
    sound.write_bytes(original)
    return Outcome(counts, longest, faults)


def _received(pipe: Any) -> Iterator[tuple[int, str, float]]:
    while True:
        try:
            yield pipe.recv()
        except EOFError:
            return


def _work(kind: Kind, sound: Path, original: bytes, numbers: Sequence[int], seed: int, pipe: Any) -> None:
    """Read damaged files until one kills this process."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (used + BYTES, used + BYTES))
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    for number in numbers:
        chosen = random.Random(f"{seed} {number}")
        data = bytearray(original)
        for damage in chosen.sample(DAMAGES, chosen.choice([1, 1, 1, 2])):
            damage(data, chosen)
            data = data or bytearray(b"\0")
        path = sound if sound.name == "metadata.yaml" else sound.with_name(f"damaged{sound.suffix}")
        path.write_bytes(data)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        began = time.process_time()
        try:
            outcome = kind.try_it(path)
        except Exception:
            outcome = "fault: " + traceback.format_exc(limit=-4)
        signal.setitimer(signal.ITIMER_PROF, 0)
        pipe.send((number, outcome, time.process_time() - began))
        for rest in path.parent.glob("*.damaged*"):
            rest.unlink()
    pipe.close()
