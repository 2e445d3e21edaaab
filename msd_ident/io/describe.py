"""What a bag or a table holds, for ``msd info``."""

from __future__ import annotations

import os
from array import array
from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.errors import DataError
from msd_ident.io import runs, time_unit
from msd_ident.io.bag import Bag, is_bag, open_bag
from msd_ident.io.columns import open_columns
from msd_ident.io.csv_file import choose_columns, choose_time
from msd_ident.io.joints import Joint, moving_joints
from msd_ident.io.reader import sources
from msd_ident.io.source_options import SourceOptions
from msd_ident.io.topics import Topic

_DEFAULTS = SourceOptions()


@dataclass(frozen=True)
class TopicInfo:
    """One topic, or one column of a table.

    Attributes:
        name: of the topic or column.
        type: of the messages; ``column`` in a table.
        messages: how many there are.
        duration: from the first to the last by log time [s].
        rate: messages a second, NaN for fewer than two.
        longest_gap: longest time between two messages [s], NaN for fewer than two.
        reliability, durability: of the first publisher's QoS, empty when not recorded.
    """

    name: str
    type: str
    messages: int
    duration: float
    rate: float
    longest_gap: float
    reliability: str = ""
    durability: str = ""


@dataclass(frozen=True)
class BagInfo:
    """Contents of a bag or table.

    Attributes:
        path: as given.
        kind: ``rosbag2 folder``, ``MCAP file`` or ``SQLite file``; of a table ``Columns.kind``, e.g. ``CSV file``.
        start_ns: log time of the first message [ns]; 0 for a table or without messages.
        duration: from the first to the last message [s].
        messages: number of messages, or of lines in a table.
        topics: in the order of the bag.
        position: ``TOPIC:FIELD`` or column that is used as position, empty when there is none.
        force: the same for the force; ``none`` for a free decay.
        problem: why position or force cannot be used, empty when they can.
        notes: what was lost or repaired on reading.
        is_table: it has columns and lines, not topics and messages.
        joints: of a bag whose position nobody named and no topic gives: its joints, and whether each moves.
    """

    path: str
    kind: str
    start_ns: int
    duration: float
    messages: int
    topics: tuple[TopicInfo, ...]
    position: str
    force: str
    problem: str
    notes: tuple[str, ...]
    is_table: bool = False
    joints: Mapping[Joint, bool] = field(default_factory=dict)


def describe(path: str | os.PathLike[str], options: SourceOptions = _DEFAULTS) -> BagInfo:
    """Contents of a bag or table, and which signals would be read.

    Args:
        path: bag or table.
        options: name the signals, as for ``read``.

    Raises:
        DataError: it cannot be opened at all.
    """
    return _describe_bag(open_bag(path), options) if is_bag(path) else _describe_table(Path(path), options)


def _describe_bag(bag: Bag, options: SourceOptions) -> BagInfo:
    times: defaultdict[str, array[int]] = defaultdict(lambda: array("q"))
    for message in bag.messages(by_log_time=False):
        times[message.topic].append(message.log_time_ns)
    position = force = problem = ""
    joints: Mapping[Joint, bool] = {}
    try:
        chosen = sources(bag, options, Counter({name: len(stamps) for name, stamps in times.items()}))
        position = chosen[0].label
        force = chosen[1].label if chosen[1] else "none"
    except DataError as error:
        problem = str(error)
        joints = {} if options.position else moving_joints(bag)
    first = min((min(stamps) for stamps in times.values()), default=0)
    last = max((max(stamps) for stamps in times.values()), default=0)
    return BagInfo(
        path=str(bag.path),
        kind=bag.kind,
        start_ns=first,
        duration=(last - first) / 1e9,
        messages=sum(len(stamps) for stamps in times.values()),
        topics=tuple(_topic_info(topic, times[name]) for name, topic in bag.topics.items()),
        position=position,
        force=force,
        problem=problem,
        notes=bag.notes,
        joints=joints,
    )


def _topic_info(topic: Topic, times: array[int]) -> TopicInfo:
    stamps = np.sort(np.frombuffer(times, dtype=np.int64)) if len(times) else np.zeros(0, dtype=np.int64)
    offered = (topic.offered_qos[0].reliability, topic.offered_qos[0].durability) if topic.offered_qos else ()
    return TopicInfo(topic.name, topic.type, stamps.size, *_pace(stamps, 1e9), *offered)


def _pace(stamps: npt.NDArray[np.int64] | FloatArray, ticks: float) -> tuple[float, float, float]:
    """Duration [s], rate [Hz] and longest gap [s] of rising stamps (n,), ``ticks`` a second; NaN for unknown."""
    duration = float(stamps[-1] - stamps[0]) / ticks if stamps.size else 0.0
    rate = (stamps.size - 1) / duration if duration > 0 else float("nan")
    return duration, rate, float(np.max(np.diff(stamps))) / ticks if stamps.size > 1 else float("nan")


def _describe_table(path: Path, options: SourceOptions) -> BagInfo:
    table = open_columns(path)
    columns = table.header
    position = force = problem = ""
    time = np.zeros(0)
    try:
        table = runs.select(table, options.run, str(path))
        time_at = choose_time(table, str(path), options)
        if time_at is not None:
            (time,) = table.columns([time_at])
            time = time[np.isfinite(time)]
            time = np.sort(time) * time_unit.factor(table.header[time_at], time, options.time_scale)[0]
        elif options.rate is not None:
            time = np.arange(table.lines) / options.rate
        chosen = choose_columns(table, str(path), options)
        position = table.header[chosen.position]
        force = "none" if chosen.force is None else table.header[chosen.force]
    except DataError as error:
        problem = str(error)
    lines = time.size or table.lines
    pace = _pace(time, 1.0)
    topics = tuple(TopicInfo(name, "column", lines, *pace) for name in columns)
    about = (str(path), table.kind, 0, pace[0], lines, topics)
    return BagInfo(*about, position, force, problem, table.notes, is_table=True)
