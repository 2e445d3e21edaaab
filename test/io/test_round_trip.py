"""Reading, writing and reading again gives the same samples to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from msd_ident.data.record import LARGEST, SMALLEST, Record, from_samples
from msd_ident.data.streams import from_stamps
from msd_ident.errors import DataError, UsageError
from msd_ident.io import SourceOptions, read, write_bag, write_csv

SETTINGS = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
#: Of bags, each of which is written to the disk file by file.
BAGS = settings(SETTINGS, max_examples=12)
VALUES = st.floats(-LARGEST, LARGEST)


def measurable(values: np.ndarray) -> bool:
    """Whether a record takes values of this size."""
    largest = np.max(np.abs(values))
    return bool(largest == 0.0 or largest >= SMALLEST)


@st.composite
def records(draw: st.DrawFn) -> Record:
    """Records as they come from messages: any stamps, force and position each with their own."""
    count = draw(st.integers(20, 60))
    start = draw(st.integers(1, 2 * 10**18))
    gaps = draw(arrays(np.int64, count - 1, elements=st.integers(1, 10**10)))
    ns = start + np.concatenate([[0], np.cumsum(gaps)])
    position = draw(arrays(np.float64, count, elements=VALUES).filter(lambda x: x.min() < x.max() and measurable(x)))
    own = draw(st.booleans())
    if own:
        size = draw(st.integers(1, 10))
        force_ns = draw(
            arrays(np.int64, size, elements=st.integers(max(1, start - 10**10), int(ns[-1])), unique=True).map(np.sort)
        )
    else:
        force_ns = ns
    force = draw(arrays(np.float64, force_ns.size, elements=VALUES).filter(measurable))
    return from_stamps(ns, position, force_ns, force)


def assert_same(one: Record, other: Record) -> None:
    for name in ("time", "position", "force_time", "force"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


@BAGS
@given(record=records())
def test_bags_keep_every_bit(tmp_path: Path, record: Record) -> None:
    write_bag(record, tmp_path / "bag", overwrite=True)
    again = read(tmp_path / "bag")
    assert_same(record, again)
    assert again.start_ns == record.start_ns
    assert again.notes == () or not np.ptp(record.force)


@SETTINGS
@given(record=records())
def test_tables_keep_every_bit(tmp_path: Path, record: Record) -> None:
    write_csv(record, tmp_path / "data.csv", overwrite=True)
    again = read(tmp_path / "data.csv")
    assert_same(record, again)
    assert again.notes == () or not np.ptp(record.force)


@BAGS
@given(record=records())
def test_a_bag_gives_what_a_table_of_it_gives(tmp_path: Path, record: Record) -> None:
    write_bag(record, tmp_path / "bag", overwrite=True)
    write_csv(read(tmp_path / "bag"), tmp_path / "data.csv", overwrite=True)
    write_bag(read(tmp_path / "data.csv"), tmp_path / "again", overwrite=True)
    assert_same(read(tmp_path / "again"), record)


def test_stamps_survive_to_the_nanosecond(tmp_path: Path) -> None:
    """Hours after the start, at stamps that no product with 1e-9 gives back."""
    ns = 1_700_000_000_000_000_001 + np.arange(3000, dtype=np.int64) * 33_333_333_331
    record = from_stamps(ns, np.sin(np.arange(3000)), ns[:1], [1.0])
    write_bag(record, tmp_path / "bag")
    again = read(tmp_path / "bag")
    np.testing.assert_array_equal(again.start_ns + np.rint(again.time * 1e9).astype(np.int64), ns)


def test_units_and_free_decays_survive(tmp_path: Path) -> None:
    t = np.arange(100) / 100
    record = Record(t, np.cos(t), np.array([0.0]), np.array([0.0]), force_unit="N·m", position_unit="rad")
    write_bag(record, tmp_path / "bag")
    write_csv(record, tmp_path / "data.csv")
    for path in (tmp_path / "bag", tmp_path / "data.csv"):
        again = read(path)
        assert (again.force_unit, again.position_unit) == ("N·m", "rad")
        assert_same(record, again)
    assert read(tmp_path / "bag", SourceOptions(force_unit="V")).force_unit == "V"


def test_a_record_without_absolute_time_gets_stamps_that_ros_takes_for_some(tmp_path: Path) -> None:
    t = np.arange(50) / 50
    record = Record(t, np.cos(t), np.array([-3.5, 0.5]), np.array([1.0, 2.0]))
    write_bag(record, tmp_path / "bag")
    again = read(tmp_path / "bag")
    assert again.start_ns == 5 * 10**9
    assert_same(record, again)
    assert again.notes == ()


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_other_libraries_read_the_bag(tmp_path: Path, compression: str) -> None:
    t = np.arange(2000) / 1000
    record = from_samples(t, np.sign(np.sin(9 * t)), np.cos(t))
    folder = tmp_path / "bag"
    write_bag(record, folder, compression=compression)  # type: ignore[arg-type]
    with AnyReader([folder]) as reader:
        assert reader.message_count == 4000
        assert sorted(reader.topics) == ["/msd/encoder", "/msd/force"]
        assert reader.topics["/msd/encoder"].msgtype == "sensor_msgs/msg/JointState"
        encoder = [
            reader.deserialize(raw, connection.msgtype).position[0]
            for connection, _, raw in reader.messages(reader.topics["/msd/encoder"].connections)
        ]
    assert encoder == record.position.tolist()
    with (folder / "bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        messages = list(reader.iter_messages(topics=["/msd/encoder"]))
        assert [message.publish_time for _, _, message in messages] == [
            10**9 + int(x) for x in np.rint(record.time * 1e9)
        ]
        assert [message.sequence for _, _, message in messages] == list(range(2000))


def test_a_time_that_ros_cannot_stamp(tmp_path: Path) -> None:
    ns = 3 * 10**18 + np.arange(30)
    with pytest.raises(DataError, match="before 2038"):
        write_bag(from_stamps(ns, np.arange(30.0), ns[:1], [0.0]), tmp_path / "bag")


def test_only_bags_are_ever_replaced(tmp_path: Path) -> None:
    record = from_samples(np.arange(30) / 10, np.zeros(30), np.arange(30.0))
    folder = tmp_path / "bag"
    write_bag(record, folder)
    with pytest.raises(UsageError, match="exists; expected a new name"):
        write_bag(record, folder)
    write_bag(record, folder, overwrite=True)
    (folder / "thesis.tex").write_text("do not delete")
    with pytest.raises(UsageError, match="exists and is no bag"):
        write_bag(record, folder, overwrite=True)
    assert (folder / "thesis.tex").read_text() == "do not delete"
    with pytest.raises(UsageError, match="is a file"):
        write_bag(record, folder / "thesis.tex", overwrite=True)
    (tmp_path / "empty").mkdir()
    write_bag(record, tmp_path / "empty")
