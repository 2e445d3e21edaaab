"""Bags of other writers: split, compressed in every way that rosbag2 knows, SQLite; and real files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import zstandard
from bagmaker import STORE, make_bag, ringing, stamps, step_experiment, storage
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from msd_ident.errors import DataError
from msd_ident.io import iterate_messages, open_bag, read


@pytest.mark.parametrize("version", [8, 9])
@pytest.mark.parametrize(
    ("plugin", "mode"),
    [
        *((StoragePlugin.MCAP, mode) for mode in CompressionMode),
        *((StoragePlugin.SQLITE3, mode) for mode in CompressionMode if mode != CompressionMode.STORAGE),
    ],
)
def test_bags_that_rosbags_writes(tmp_path: Path, plugin: StoragePlugin, version: int, mode: CompressionMode) -> None:
    folder = tmp_path / "bag"
    writer = Writer(folder, version=version, storage_plugin=plugin)  # type: ignore[arg-type]
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, type_name, raw, log_time in step_experiment():
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, type_name, typestore=STORE)
            writer.write(connections[topic], log_time, raw)
    record = read(folder)
    np.testing.assert_array_equal(record.position, ringing(stamps()))
    assert record.notes == ()


def test_split_bags_are_one(tmp_path: Path) -> None:
    messages = step_experiment()
    first = storage(make_bag(tmp_path / "a", messages[:200]))
    second = storage(make_bag(tmp_path / "b", messages[200:]))
    folder = tmp_path / "split"
    folder.mkdir()
    first.rename(folder / "split_9.mcap")
    (folder / "split_10.mcap.zstd").write_bytes(zstandard.compress(second.read_bytes()))
    record = read(folder)
    np.testing.assert_array_equal(record.position, ringing(stamps()))
    times = [message.log_time_ns for message in iterate_messages(folder)]
    assert times == sorted(times)
    assert len(times) == len(messages)


def test_messages_come_by_log_time_whatever_the_chunks(tmp_path: Path) -> None:
    messages = step_experiment()
    shuffled = [messages[i] for i in np.random.default_rng(5).permutation(len(messages))]
    folder = make_bag(tmp_path / "bag", shuffled)
    found = list(iterate_messages(folder))
    assert [m.log_time_ns for m in found] == sorted(m[3] for m in messages)
    assert {(m.topic, m.type, m.data, m.log_time_ns) for m in found} == set(messages)
    forces = list(iterate_messages(folder, ["/msd/force"]))
    assert [m.topic for m in forces] == ["/msd/force"] * 2
    with pytest.raises(DataError, match="has no topic /nope; there are: /msd/encoder, /msd/force"):
        iterate_messages(folder, ["/nope"])


def real_files(shared_data: Path) -> list[Path]:
    return [*sorted((shared_data / "mcap").rglob("*.mcap")), shared_data / "mcap" / "rosbag2_tests" / "wbag"]


def test_real_files_open_or_are_refused_in_one_line(shared_data: Path) -> None:
    refused = []
    for path in real_files(shared_data):
        try:
            bag = open_bag(path)
            messages = list(bag.messages())
        except DataError as error:
            refused.append(path.name)
            assert str(error) == (
                f"{path}: messages are encoded as 'wrong_format'; expected 'cdr', the encoding of ROS 2: "
                "record or convert the bag with ROS 2"
            )
            continue
        assert messages, path
        assert {message.topic for message in messages} <= set(bag.topics)
        assert bool(bag.notes) == ("truncated" in path.name), path
    assert refused == ["wrong_rmw_test_0.mcap"]


def test_a_real_file_that_is_cut_off(shared_data: Path) -> None:
    folder = shared_data / "mcap" / "tiryoh_fixtures"
    whole, cut = open_bag(folder / "test_sample.mcap"), open_bag(folder / "test_sample_truncated.mcap")
    assert list(cut.messages()) == list(whole.messages())
    assert cut.notes == (
        "test_sample_truncated.mcap: the file is cut off or damaged at byte 1475 of 1533; 14 messages could be read.",
    )


def test_a_real_split_bag(shared_data: Path) -> None:
    bag = open_bag(shared_data / "mcap" / "rosbag2_tests" / "wbag")
    assert sum(1 for _ in bag.messages()) == 6074  # as its metadata.yaml says
    assert bag.notes == ()
