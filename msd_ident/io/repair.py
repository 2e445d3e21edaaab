"""Repair of bags that were not finished: the index and correct metadata are written, and losses are counted."""

from __future__ import annotations

import mmap
import os
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.io.bag_folder import look_into
from msd_ident.io.crash_safe_file import copies_of, is_being_written, sync_folder
from msd_ident.io.metadata import LOST, UNFINISHED, BagEntry, FileEntry, TopicEntry, read_entry
from msd_ident.paths import check_plain

if TYPE_CHECKING:
    from msd_ident.io.mcap_file import Loss, McapFile

#: Ending of a damaged file that is kept beside the one made of it.
DAMAGED = ".damaged"


@dataclass(frozen=True)
class Repair:
    """What was done to a bag.

    Attributes:
        path: of the folder or file.
        entry: files and topics of the bag as it is now.
        messages: number of messages that are there.
        lost: number of lost messages; estimated from sizes unless ``exact``.
        seconds: log time that these covered; 0 where nothing tells it.
        open_seconds: time before the end of a recording that was never finished, of which nothing is known.
        changed: whether anything had to be done.
        notes: one sentence for each thing that was done or lost.
    """

    path: Path
    entry: BagEntry
    messages: int
    lost: int
    seconds: float
    exact: bool
    open_seconds: float
    changed: bool
    notes: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """For people."""
        about = "" if self.exact else "about "
        span = f" ({self.seconds:.3g} s)" if self.seconds else ""
        lost = f"{about}{self.lost} lost{span}" if self.lost or self.seconds else "none lost"
        text = f"{self.path}: {self.messages} messages, {lost}"
        if self.open_seconds:
            text += f" of what was on the disk; up to {self.open_seconds:g} s before the recording broke off never got"
            text += f" there (at its rate {self._unknown} messages)"
        return text + ("" if self.changed else "; nothing to repair")

    @property
    def _unknown(self) -> int:
        files = [file for file in self.entry.files if file.messages]
        span = (max(f.last_ns for f in files) - min(f.first_ns for f in files)) / 1e9 if files else 0.0
        return round(self.messages / span * self.open_seconds) if span > 0 else self.messages


def repair(path: str | os.PathLike[str]) -> Repair:
    """Finish a bag or a single MCAP file; what is whole already stays as it is.

    A file of which something could not be read is kept, with ``.damaged`` behind its name.

    Raises:
        DataError: nothing there, or nothing that is an MCAP file.
        UsageError: it is being recorded, or of a kind that is not repaired here.
        SetupError: the disk does not take it.
    """
    where = Path(path)
    if where.name == "metadata.yaml":
        where = where.parent
    check_plain(where, "a bag folder or an .mcap file")
    try:
        return _repair_folder(where) if where.is_dir() else _repair_file(where)
    except OSError as error:
        raise SetupError(f"cannot repair {where}: {error.strerror or error}; expected a place to write to") from None


def _repair_folder(folder: Path) -> Repair:
    found = look_into(folder)
    known = read_entry(found.information)
    for path in found.paths:
        _check(path)
    mended = [_mend(path) for path in found.paths]
    promised = {file.name: file for file in known.files}
    entry = BagEntry(custom={key: text for key, text in known.custom.items() if key != UNFINISHED})
    for one in mended:
        one.expect(promised.get(one.file.name, FileEntry(one.file.name)))
        entry.files.append(one.file)
        for name, topic in one.topics.items():
            known_topic = entry.topics.setdefault(name, TopicEntry(name, topic.type, topic.qos, topic.type_hash))
            known_topic.messages += topic.messages
    open_seconds = _seconds(known.custom.get(UNFINISHED, ""))
    changed = any(one.changed for one in mended) or bool(found.notes) or UNFINISHED in known.custom
    losses = [one.loss for one in mended]
    lost = sum(loss.messages for loss in losses)
    if changed:
        lost_parts = [f"{lost} messages are lost"] if lost else []
        lost_parts += [f"up to {open_seconds:g} s before its end may be missing"] if open_seconds else []
        entry.custom |= {LOST: ", ".join(lost_parts)} if lost_parts else {}
        entry.write(folder)
        _tidy(found.paths)
    notes = [*found.notes, *(note for one in mended for note in one.notes)]
    seconds, exact = sum(loss.seconds for loss in losses), all(loss.exact for loss in losses)
    return Repair(folder, entry, entry.messages, lost, seconds, exact, open_seconds, changed, tuple(notes))


def _repair_file(path: Path) -> Repair:
    if not path.exists():
        raise DataError(f"{path} does not exist; expected a bag folder or an .mcap file: check the path")
    _check(path)
    one = _mend(path)
    _tidy([path])
    entry = BagEntry([one.file], one.topics)
    lost, seconds, exact = one.loss.messages, one.loss.seconds, one.loss.exact
    return Repair(path, entry, one.file.messages, lost, seconds, exact, 0.0, one.changed, tuple(one.notes))


@dataclass
class _Mended:
    """A file after its repair."""

    file: FileEntry
    topics: dict[str, TopicEntry]
    loss: Loss
    changed: bool
    notes: list[str]

    def expect(self, promised: FileEntry) -> None:
        """Messages and log times that the metadata promise, where the file itself does not say."""
        if not self.loss.exact and promised.messages >= self.file.messages:
            self.loss.messages, self.loss.exact = promised.messages - self.file.messages, True
            beside = promised.duration_ns
            if self.file.messages:
                beside = max(self.file.first_ns - promised.first_ns, 0) + max(promised.last_ns - self.file.last_ns, 0)
            self.loss.seconds = max(self.loss.seconds, min(beside, promised.duration_ns) / 1e9)


def _check(path: Path) -> None:
    if path.suffix != ".mcap":
        raise UsageError(f"{path} is no .mcap file; expected one: only these can be repaired here")
    if is_being_written(path):
        raise UsageError(f"{path} is being recorded; expected a bag that nobody writes: stop the recorder first")


def _mend(path: Path) -> _Mended:
    """Make a whole file of what can be read, unless it is one; a copy that the recorder left may have more."""
    looks = [(look, source) for source in (path, *copies_of(path)) if (look := _look(source, path.name))]
    if not looks:
        return _set_aside(path)
    (mcap, found), source = max(looks, key=lambda pair: pair[0][1].file.messages)
    if source == path and not mcap.losses:
        return found
    draft = path.with_name(f".{path.name}.repaired")
    draft.unlink(missing_ok=True)
    _copy(mcap, draft)
    found.changed = True
    found.notes = list(mcap.losses)
    if source == path and (found.loss.messages or found.loss.seconds):
        kept = _free_name(path)
        os.rename(path, kept)
        found.notes.append(f"{path.name}: written anew; the file as it was is kept as {kept.name}.")
    os.replace(draft, path)
    sync_folder(path.parent)
    return found


def _look(source: Path, name: str) -> tuple[McapFile, _Mended] | None:
    """A file with its topics and counts; nothing when it is no MCAP file."""
    from msd_ident.io.mcap_file import McapFile  # imported here: only a repair needs it

    file = FileEntry(name)
    topics: dict[str, int] = {}
    try:
        with source.open("rb") as stream:
            mcap = McapFile(mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ), name)
    except (DataError, ValueError):  # an empty file cannot be mapped
        return None
    for message in mcap.messages():
        if message.channel in mcap.channels:
            topic = mcap.channels[message.channel].topic
            topics[topic] = topics.get(topic, 0) + 1
            file.count(message.log_time_ns)
    entries = {}
    for channel in mcap.channels.values():
        schema = mcap.schemas.get(channel.schema_id)
        qos, type_hash = (channel.metadata.get(key, "") for key in ("offered_qos_profiles", "topic_type_hash"))
        count = topics.get(channel.topic, 0)
        entries[channel.topic] = TopicEntry(channel.topic, schema.name if schema else "", qos, type_hash, count)
    return mcap, _Mended(file, entries, mcap.loss, False, [])


def _copy(mcap: McapFile, draft: Path) -> None:
    """All messages of a file into another."""
    from msd_ident.io.mcap_writer import McapWriter

    writer = McapWriter(draft, "zstd")
    schemas: dict[int, int] = {}
    channels: dict[int, int] = {}
    counts: Counter[int] = Counter()
    try:
        for channel in mcap.channels.values():
            schema = mcap.schemas.get(channel.schema_id)
            if schema and schema.id not in schemas:
                schemas[schema.id] = writer.add_schema(schema.name, schema.encoding, schema.data)
            number = schemas.get(channel.schema_id, 0)
            channels[channel.id] = writer.add_channel(channel.topic, channel.message_encoding, number, channel.metadata)
        for channel_id, log_time, publish_time, data in mcap.messages():
            if channel_id in channels:
                writer.add_message(channels[channel_id], counts[channel_id], log_time, publish_time, data)
                counts[channel_id] += 1
        writer.close()
    except BaseException:
        writer.abandon()
        draft.unlink(missing_ok=True)
        raise


def _set_aside(path: Path) -> _Mended:
    """A file that holds nothing that can be read leaves the bag, under another name."""
    from msd_ident.io.mcap_file import Loss
    from msd_ident.io.mcap_writer import McapWriter

    kept = _free_name(path)
    os.replace(path, kept)
    writer = McapWriter(path, "zstd")
    writer.close()
    note = f"{path.name}: nothing in it can be read; the file as it was is kept as {kept.name}."
    return _Mended(FileEntry(path.name), {}, Loss(exact=False), True, [note])


def _free_name(path: Path) -> Path:
    number = 0
    while True:
        kept = path.with_name(f"{path.name}{DAMAGED}{number or ''}")
        if not kept.exists():
            return kept
        number += 1


def _tidy(paths: list[Path]) -> None:
    """Remove what writers that were killed left beside the files."""
    for path in paths:
        for copy in copies_of(path):
            copy.unlink(missing_ok=True)


def _seconds(text: str) -> float:
    try:
        return max(float(text), 0.0)
    except ValueError:
        return 0.0
