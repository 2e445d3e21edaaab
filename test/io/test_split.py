"""Bags in several files: by size and by time, never over anything, each file whole by itself."""

from __future__ import annotations

from pathlib import Path
from unittest import mock

import pytest
import yaml
from bagmaker import JOINTS, encoder_messages, stamps
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from msd_ident.errors import UsageError
from msd_ident.io import BagWriter, open_bag
from msd_ident.io.crash_safe_file import CrashSafeFile


def record(folder: Path, **options: object) -> list[Path]:
    with BagWriter(folder, "none", **options) as writer:  # type: ignore[arg-type]
        writer.add_topic("/msd/encoder", JOINTS)
        for topic, _, raw, log_time in encoder_messages(stamps(1000)):
            writer.write(topic, raw, log_time)
    return sorted(folder.glob("*.mcap"))


def check(folder: Path, files: list[Path]) -> list[int]:
    """Messages of each file, which the metadata and three readers agree on."""
    information = yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert information["relative_file_paths"] == [path.name for path in files]
    counts = []
    for entry, path in zip(information["files"], files, strict=True):
        with path.open("rb") as stream:
            times = [message.log_time for _, _, message in make_reader(stream, validate_crcs=True).iter_messages()]
        assert entry["path"] == path.name
        assert entry["starting_time"]["nanoseconds_since_epoch"] == times[0]
        assert entry["duration"]["nanoseconds"] == times[-1] - times[0]
        counts.append(entry["message_count"])
        assert counts[-1] == len(times)
    with Reader(folder) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages()) == 1000
        assert reader.duration == 999_000_001
    assert [message.log_time_ns for message in open_bag(folder).messages()] == stamps(1000)
    return counts


def test_a_file_ends_after_a_time(tmp_path: Path) -> None:
    files = record(tmp_path / "bag", split_seconds=0.25)
    assert [path.name for path in files] == [f"bag_{i}.mcap" for i in range(4)]
    assert check(tmp_path / "bag", files) == [250] * 4


def test_a_file_ends_at_a_size(tmp_path: Path) -> None:
    files = record(tmp_path / "bag", split_bytes=40_000)
    assert len(files) == 3
    check(tmp_path / "bag", files)
    assert all(40_000 <= path.stat().st_size < 50_000 for path in files[:-1])


def test_a_file_ends_after_many_chunks(tmp_path: Path) -> None:
    with mock.patch("msd_ident.io.writer.MOST_CHUNKS", 20), BagWriter(tmp_path / "bag", sync_seconds=0.0) as writer:
        writer.add_topic("/msd/encoder", JOINTS)
        for topic, _, raw, log_time in encoder_messages(stamps(50)):
            writer.write(topic, raw, log_time)
    assert len(list((tmp_path / "bag").glob("*.mcap"))) == 3
    assert sum(1 for _ in open_bag(tmp_path / "bag").messages()) == 50


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    """Also not what comes into the folder while the bag is written."""
    folder = tmp_path / "bag"
    with BagWriter(folder, split_seconds=0.5) as writer:
        writer.add_topic("/msd/encoder", JOINTS)
        (folder / "bag_1.mcap").write_text("something of somebody's own")
        for topic, _, raw, log_time in encoder_messages(stamps(1000)):
            writer.write(topic, raw, log_time)
    assert (folder / "bag_1.mcap").read_text() == "something of somebody's own"
    assert sum(1 for _ in open_bag(folder).messages()) == 1000
    with pytest.raises(FileExistsError):
        CrashSafeFile(folder / "bag_0.mcap")
    with pytest.raises(UsageError, match="exists; expected a new name"):
        BagWriter(folder)


def test_a_disk_without_second_names_is_written_in_place(tmp_path: Path) -> None:
    """As on a USB stick with FAT."""
    with mock.patch("msd_ident.io.crash_safe_file.os.link", side_effect=PermissionError(1, "Operation not permitted")):
        files = record(tmp_path / "bag", split_seconds=0.5, sync_seconds=0.01)
    assert check(tmp_path / "bag", files) == [500, 500]
    assert sorted(path.name for path in (tmp_path / "bag").iterdir()) == ["bag_0.mcap", "bag_1.mcap", "metadata.yaml"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sync_seconds": -1.0}, "the time between syncs is -1.0 s; expected 0 or more"),
        ({"sync_seconds": float("nan")}, "the time between syncs is nan s"),
        ({"split_bytes": 100}, "the size of a file is 100 bytes; expected at least 10000"),
        ({"split_seconds": float("inf")}, r"the length of a file is inf s; expected 0 \(for no limit\) or more"),
    ],
)
def test_limits_that_make_no_sense_are_refused(tmp_path: Path, options: dict[str, float], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        BagWriter(tmp_path / "bag", **options)  # type: ignore[arg-type]
    assert not (tmp_path / "bag").exists()
