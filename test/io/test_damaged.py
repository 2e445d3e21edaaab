"""Files that are cut off or damaged: what can be read is read, the loss is stated, no sample is ever wrong."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from bagmaker import make_bag, number, ringing, stamps, step_experiment, storage
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, IndexType, Writer

from msd_ident.data.record import Record
from msd_ident.errors import DataError
from msd_ident.io import open_bag, read


@pytest.fixture(scope="module", params=["zstd", "lz4", "none"])
def whole(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole") / request.param
    return storage(make_bag(folder, step_experiment(), compression=request.param))


def samples_of(record: Record) -> set[tuple[int, float]]:
    ns = record.start_ns + np.rint(record.time * 1e9).astype(np.int64)
    return set(zip(ns.tolist(), record.position.tolist(), strict=True))


ORIGINAL = set(zip(stamps(), ringing(stamps()).tolist(), strict=True))


def read_bytes(data: bytes, folder: Path) -> Record | None:
    """Record from the bytes, ``None`` when they are refused in one line."""
    path = folder / "damaged.mcap"
    path.write_bytes(data)
    try:
        return read(path)
    except DataError as error:
        assert "\n" not in str(error)
        assert len(str(error)) > 30
        return None


def test_the_whole_file_loses_nothing(whole: Path, tmp_path: Path) -> None:
    record = read_bytes(whole.read_bytes(), tmp_path)
    assert record is not None
    assert samples_of(record) == ORIGINAL
    assert record.notes == ()


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_flipped_bytes_never_give_a_wrong_sample(whole: Path, tmp_path: Path, data: st.DataObject) -> None:
    damaged = bytearray(whole.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(damaged) - 1))
        damaged[at] ^= data.draw(st.integers(1, 255))
    record = read_bytes(bytes(damaged), tmp_path)
    if record is not None:
        assert samples_of(record) <= ORIGINAL
        if len(samples_of(record)) < len(ORIGINAL):
            assert any("lost" in note or "could be read" in note for note in record.notes), record.notes


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_file_that_is_cut_off_gives_what_comes_before_the_cut(
    whole: Path, tmp_path: Path, data: st.DataObject
) -> None:
    content = whole.read_bytes()
    cut = data.draw(st.integers(0, len(content) - 1))
    record = read_bytes(content[:cut], tmp_path)
    if record is None:
        assert cut < 0.5 * len(content)
        return
    assert samples_of(record) <= ORIGINAL
    assert any("could be read" in note for note in record.notes), record.notes


@pytest.mark.parametrize(("compression", "least"), [("none", 200), ("lz4", 100), ("zstd", 100)])
def test_a_chunk_that_is_cut_off_gives_its_first_messages(tmp_path: Path, compression: str, least: int) -> None:
    """As in a short recording of rosbag2, which has one chunk for all."""
    messages = step_experiment(5000)
    folder = make_bag(tmp_path / "bag", messages, flush_every=10**6, compression=compression, sync_seconds=1e6)
    content = storage(folder).read_bytes()
    record = read_bytes(content[: int(0.5 * len(content))], tmp_path)
    assert record is not None
    assert least < record.samples < 5000
    original = set(zip(stamps(5000), ringing(stamps(5000)).tolist(), strict=True))
    assert samples_of(record) <= original


def test_blocks_that_never_reached_the_disk_are_no_samples(tmp_path: Path) -> None:
    """After a power cut a file can have its length and end in zeros."""
    raw = storage(make_bag(tmp_path / "bag", step_experiment(), flush_every=10**6, compression="none")).read_bytes()
    cut = int(0.6 * len(raw))
    record = read_bytes(raw[:cut] + bytes(4096), tmp_path)
    assert record is not None
    assert samples_of(record) <= ORIGINAL
    assert record.samples > 200


def test_a_killed_recorder_leaves_all_but_the_last_chunk(tmp_path: Path) -> None:
    from msd_ident.io import BagWriter

    writer = BagWriter(tmp_path / "killed")
    messages = step_experiment()
    for i, (topic, type_name, data, log_time) in enumerate(messages):
        writer.add_topic(topic, type_name)
        writer.write(topic, data, log_time)
        if i == 400:
            writer.flush()
    shutil.copytree(tmp_path / "killed", tmp_path / "found")  # what is on disk at this moment
    record = read(tmp_path / "found")
    assert record.samples == 399
    assert samples_of(record) <= ORIGINAL
    (note,) = record.notes
    assert note == (
        "the recording was not finished: what came in its last 1 s may be missing; msd repair finishes the bag."
    )
    writer.close()
    assert samples_of(read(tmp_path / "killed")) == ORIGINAL


def test_a_damaged_chunk_is_left_out_and_counted(tmp_path: Path) -> None:
    path = storage(make_bag(tmp_path / "bag", step_experiment(), compression="none"))
    raw = bytearray(path.read_bytes())
    raw[raw.index(b"cart", len(raw) // 3) + 60] ^= 0xFF
    path.write_bytes(raw)
    record = read(path)
    assert record.samples == 401
    assert record.notes == ("bag_0.mcap: 1 of 7 chunks are damaged and were left out; 100 of 502 messages are lost.",)


def test_a_damaged_record_in_the_middle_costs_no_chunk_behind_it(tmp_path: Path) -> None:
    path = storage(make_bag(tmp_path / "bag", step_experiment(), compression="none"))
    raw = bytearray(path.read_bytes())
    chunk = raw.index(b"\x06", len(raw) // 3)
    while raw[chunk + 1 + 8 + 28 : chunk + 1 + 8 + 32] != bytes(4) or raw[chunk + 3 : chunk + 9] != bytes(6):
        chunk = raw.index(b"\x06", chunk + 1)
    raw[chunk + 1 : chunk + 9] = b"\xff" * 8  # its length
    path.write_bytes(raw)
    record = read(path)
    assert record.samples == 400
    assert "100 of 502 messages are lost" in record.notes[0]


@pytest.mark.parametrize("chunked", [True, False])
def test_files_without_any_index_are_read(tmp_path: Path, chunked: bool) -> None:
    path = tmp_path / "plain.mcap"
    with path.open("wb") as stream:
        writer = Writer(
            stream,
            compression=CompressionType.NONE,
            index_types=IndexType.NONE,
            repeat_channels=False,
            repeat_schemas=False,
            use_chunking=chunked,
            use_statistics=False,
            use_summary_offsets=False,
        )
        writer.start(profile="ros2")
        schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
        channel = writer.register_channel("/x", "cdr", schema, {})
        for t in (3, 1, 2):
            writer.add_message(channel, t, number(float(t)), t)
        writer.finish()
    bag = open_bag(path)
    assert [message.log_time_ns for message in bag.messages(by_log_time=False)] == [3, 1, 2]
    assert [message.log_time_ns for message in bag.messages()] == [1, 2, 3]
    assert bag.notes == ()
    assert bag.topics["/x"].type == "std_msgs/msg/Float64"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", ["is empty", "record again"]),
        (b"hello, this is no bag at all", ["does not begin like an MCAP file"]),
        (b"\x89MCAP0\r\n", ["no topic called encoder"]),
    ],
)
def test_files_that_are_no_bag_are_refused(tmp_path: Path, content: bytes, words: list[str]) -> None:
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError) as refused:
        read(path)
    for word in words:
        assert word in str(refused.value)


def test_a_folder_without_metadata_is_read_with_a_note(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    (folder / "metadata.yaml").unlink()
    record = read(folder)
    assert samples_of(record) == ORIGINAL
    assert record.notes == ("metadata.yaml is missing; the files of the folder were read in the order of their names.",)


@pytest.mark.parametrize("text", ["", "a: [", "rosbag2_bagfile_information: 3", "\xff\xfe", "- 1"])
def test_a_folder_with_damaged_metadata_is_read_with_a_note(tmp_path: Path, text: str) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    (folder / "metadata.yaml").write_text(text, encoding="latin-1")
    record = read(folder)
    assert samples_of(record) == ORIGINAL
    assert "metadata.yaml cannot be read" in record.notes[0]


def test_a_missing_part_of_a_split_bag_is_said(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    metadata = folder / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("- bag_0.mcap", "- bag_0.mcap\n  - bag_1.mcap"))
    record = read(folder)
    assert record.notes == ("1 of 2 files of the bag are missing: bag_1.mcap.",)
