"""What three independent readers find in a bag: our own, rosbags and the mcap library."""

from __future__ import annotations

from pathlib import Path

from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from msd_ident.io import open_bag


def with_msd(folder: Path) -> list[bytes]:
    """Messages in the order of the file."""
    return [message.data for message in open_bag(folder).messages(by_log_time=False)]


def with_rosbags(folder: Path) -> list[bytes]:
    """The same; its count must be that of the metadata or less, which are written after the file."""
    with Reader(folder) as reader:
        found = [raw for _, _, raw in reader.messages()]
        if reader.message_count > len(found):
            raise AssertionError(f"metadata.yaml promises {reader.message_count} messages, there are {len(found)}")
        return found


def with_mcap(folder: Path) -> list[bytes]:
    """The same, every checksum tested."""
    found = []
    for path in sorted(folder.glob("*.mcap"), key=lambda path: (len(path.name), path.name)):
        with path.open("rb") as stream:
            for _, _, message in make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False):
                found.append(message.data)
    return found


READERS = {"msd": with_msd, "rosbags": with_rosbags, "mcap": with_mcap}
