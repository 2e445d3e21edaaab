"""The live buffer: what goes in comes out in order, the oldest leave first, the record is the bag reader's."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import START_NS, ringing, stamps  # noqa: E402
from hypothesis import given  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

from msd_ident.data.streams import from_stamps  # noqa: E402
from msd_ident.errors import DataError, UsageError  # noqa: E402
from msd_ident.ros.common.fault_log import FaultLog  # noqa: E402
from msd_ident.ros.common.live_buffer import LiveBuffer, Ring, Units  # noqa: E402, Units

chunks = st.lists(st.lists(st.integers(0, 10**6), max_size=30), max_size=12)


@given(capacity=st.integers(1, 40), chunks=chunks, single=st.booleans(), last=st.integers(0, 50))
def test_a_ring_holds_the_latest_samples_in_order_of_arrival(
    capacity: int, chunks: list[list[int]], single: bool, last: int
) -> None:
    ring = Ring(capacity)
    for chunk in chunks:
        if single:
            for ns in chunk:
                ring.append(ns, ns / 2)
        else:
            ring.extend(np.array(chunk, dtype=np.int64), np.array(chunk) / 2)
    everything = [ns for chunk in chunks for ns in chunk]
    expected = everything[-capacity:]
    ns, values = ring.samples()
    assert ns.tolist() == expected and values.tolist() == [ns / 2 for ns in expected]
    assert ring.samples(last)[0].tolist() == (expected[-last:] if last else [])
    assert not everything or ring.newest_ns == max(everything)


def test_a_buffer_without_room_is_refused() -> None:
    with pytest.raises(UsageError, match="a buffer of 0 samples; expected at least 1"):
        Ring(0)


def test_the_record_is_the_one_of_from_stamps() -> None:
    ns = np.array(stamps(300), dtype=np.int64)
    x = ringing(ns.tolist())
    buffer = LiveBuffer(1000, hold="linear", units=Units("V", "rad"))
    buffer.add_force(int(ns[0]), 0.0)
    buffer.add_force(int(ns[100]), 10.0)
    for at, value in zip(ns[:120].tolist(), x[:120].tolist(), strict=True):
        buffer.add_position(at, value)
    buffer.add_positions(ns[120:], x[120:])
    expected = from_stamps(ns, x, ns[[0, 100]], [0.0, 10.0], hold="linear", force_unit="V", position_unit="rad")
    record = buffer.record()
    for name in ("time", "position", "force_time", "force"):
        assert np.array_equal(getattr(record, name), getattr(expected, name))
    assert (record.hold, record.force_unit, record.position_unit) == ("linear", "V", "rad")
    assert (record.start_ns, record.name) == (START_NS, "live")


def test_late_samples_and_duplicates_are_counted_and_mended() -> None:
    ns = stamps(100)
    buffer = LiveBuffer(1000)
    buffer.add_force(ns[0], 1.0)
    for at in [*ns[:50], ns[20], ns[49], ns[51], ns[50], *ns[52:]]:
        buffer.add_position(at, float(at - START_NS))
    assert (buffer.counts.positions, buffer.counts.late, buffer.counts.duplicates) == (102, 1, 2)
    record = buffer.record()
    assert record.samples == 100
    assert any("duplicate stamps" in note for note in record.notes)
    assert "position: 1 repeated samples, or samples with a repeated stamp, were left out." in record.notes


@pytest.mark.parametrize("lead_ms", [50, 1500])
def test_forces_that_are_taken_back_did_not_act(lead_ms: int) -> None:
    """A run that is stopped sends 0 in the place of each force that it sent ahead of its instant."""
    ns = np.array(stamps(6000))
    stop = 6000 - lead_ms
    buffer = LiveBuffer(100_000)
    buffer.add_positions(ns[:stop], ringing(ns[:stop].tolist()))
    sent = ns[::4]
    for at in sent:
        buffer.add_force(int(at), 5.0)
    for at in (ns[stop] - 1000, *sent[sent >= ns[stop]]):
        buffer.add_force(int(at), 0.0)
    record = buffer.record()
    stopped = (ns[stop] - 1000 - ns[0]) / 1e9
    assert set(record.force[record.force_time >= stopped]) == {0.0}
    assert set(record.force[record.force_time < stopped]) == {5.0}


def test_a_clock_set_back_begins_a_new_recording_with_the_force_that_holds() -> None:
    ns = stamps(4000)
    buffer = LiveBuffer(10_000)
    buffer.add_force(ns[0] - 5, 2.0)
    buffer.add_force(ns[2000], 7.0)
    for at in ns:
        buffer.add_position(at, 0.5)
    for at in ns[:200]:
        buffer.add_position(at, float(at - START_NS))
    assert buffer.counts.restarts == 1
    record = buffer.record()
    assert record.samples == 200 and record.force.tolist() == [2.0]


def test_an_empty_buffer_says_what_is_missing() -> None:
    with pytest.raises(DataError, match="no position samples; expected at least one"):
        LiveBuffer(100).record()


def test_a_free_decay_waits_for_no_force() -> None:
    buffer = LiveBuffer(1000, free=True)
    ns = np.array(stamps(100), dtype=np.int64)
    buffer.add_positions(ns, ringing(ns.tolist()))
    record = buffer.record()
    assert record.force.tolist() == [0.0] and record.force_time.tolist() == [0.0]


def test_recent_gives_the_last_seconds_by_stamp() -> None:
    buffer = LiveBuffer(10_000)
    ns = np.array(stamps(1000), dtype=np.int64)
    buffer.add_positions(ns, np.arange(1000.0))
    assert buffer.recent(0.1)[1].tolist() == list(range(899, 1000))
    buffer.clear()
    assert buffer.recent(1.0)[0].size == 0 and buffer.counts.positions == 1000


def test_the_force_that_acts_outlasts_a_clearing() -> None:
    """A publisher that holds its force does not tell it again: the next force would seem to have acted before."""
    ns = stamps(400)
    for first, later, expected in (
        ([(ns[0], 3.0), (ns[50], 10.0)], [(ns[300], 5.0)], [10.0, 5.0]),
        ([(ns[0], 10.0)], [], [10.0]),
        ([(ns[0], 10.0)], [(ns[150], 0.0), (ns[300], 5.0)], [0.0, 5.0]),  # it ended before the new recording
        ([], [(ns[300], 5.0)], [5.0]),
    ):
        buffer = LiveBuffer(10_000)
        for at, force in first:
            buffer.add_force(at, force)
        for at in ns[:100]:
            buffer.add_position(at, 0.5)
        for _ in range(2):  # nor does a second clearing forget it
            buffer.clear()
        for at, force in later:
            buffer.add_force(at, force)
        for at in ns[200:]:
            buffer.add_position(at, 0.5)
        record = buffer.record()
        assert record.samples == 200 and record.force.tolist() == expected
        assert record.force_time[0] <= 0.0 or not first


@pytest.mark.parametrize("taken_back", [True, False])
def test_a_clearing_knows_what_was_taken_back_and_what_was_sent_ahead(taken_back: bool) -> None:
    """A run sends 5 N ahead of its instant; a stop takes it back with 0 at the same stamp, and did so for nothing."""
    ns = stamps(400)
    buffer = LiveBuffer(10_000)
    for at in ns[:100]:
        buffer.add_position(at, 0.5)
    for at, force in ((ns[0], 1.0), (ns[98], 5.0), (ns[110], 5.0), *(((ns[99], 0.0), (ns[110], 0.0)) * taken_back)):
        buffer.add_force(at, force)
    buffer.clear()
    for at in ns[105:]:
        buffer.add_position(at, 0.5)
    record = buffer.record()
    assert set(record.force.tolist()) == ({0.0} if taken_back else {5.0})
    assert record.force_time.tolist()[-1] == pytest.approx((ns[110] - ns[105]) / 1e9)


def test_the_force_that_acts_outlasts_a_clearing_and_a_clock_that_is_set_back() -> None:
    ns = stamps(200)
    buffer = LiveBuffer(10_000)
    buffer.add_force(ns[100], 10.0)
    buffer.clear()
    for at in ns[:50]:
        buffer.add_position(at, 0.5)
    assert (buffer.record().force.tolist(), buffer.record().force_time.tolist()) == ([10.0], [0.0])


def filled(count: int = 1000) -> tuple[LiveBuffer, FaultLog, list[int]]:
    watch = FaultLog()
    buffer = LiveBuffer(10_000, watch=watch)
    ns = stamps(count)
    buffer.add_force(ns[0], 3.0)
    for at in ns:
        buffer.add_position(at, 0.5)
    return buffer, watch, ns


def test_a_clock_set_forward_begins_a_new_recording() -> None:
    buffer, watch, ns = filled()
    later = [at + 3600 * 10**9 for at in ns]
    for at in later:
        buffer.add_position(at, 0.25)
    record = buffer.record()
    assert record.samples == 1000 and record.start_ns == later[0] and record.force.tolist() == [3.0]
    assert watch.recent == ("the clock jumped forward by 3599 s: a new recording starts",)


def test_a_clock_set_back_by_less_than_a_second_begins_a_new_recording() -> None:
    buffer, watch, ns = filled()
    for at in ns:
        buffer.add_position(at + 700_000_000 + 100_000, 0.25)
    assert buffer.counts.restarts == 1
    assert set(buffer.record().position) == {0.25}
    assert "clock set back" in watch.counts


def test_single_stamps_from_elsewhere_are_left_out() -> None:
    buffer, watch, ns = filled()
    for i, at in enumerate(range(ns[-1] + 1_000_000, ns[-1] + 501_000_000, 1_000_000)):
        if i % 50 == 7:
            buffer.add_position(at + (-1) ** i * 10**15, 9.0)
        buffer.add_position(at, 0.5)
    assert buffer.counts.wild == 10 and buffer.counts.restarts == 0
    record = buffer.record()
    assert record.samples == 1500 and set(record.position) == {0.5}
    assert watch.counts["wild stamps"] == 10


@pytest.mark.parametrize("size", [1, 10])
def test_a_stamp_that_stands_still_does_not_push_out_what_is_there(size: int) -> None:
    buffer, watch, ns = filled(9000)
    for _ in range(3000):
        buffer.add_positions(np.full(size, ns[-1], dtype=np.int64), np.full(size, 0.7))
    assert buffer.record().samples == 9000
    assert buffer.counts.duplicates == 3000 * size
    assert watch.recent[0] == "the stamps of 3000 samples in a row stand still"


def test_a_batch_that_comes_twice_counts_once() -> None:
    buffer, watch, ns = filled()
    again = np.array(ns[-100:], dtype=np.int64)
    buffer.add_positions(again, np.full(100, 0.5))
    assert (buffer.counts.duplicates, buffer.counts.late) == (100, 0)
    assert buffer.record().samples == 1000 and buffer.position.size == 1000


def test_a_force_of_another_clock_waits_for_a_position_there() -> None:
    buffer, watch, ns = filled()
    ahead = ns[0] + 3600 * 10**9
    buffer.add_force(ahead + 5, 7.0)
    assert buffer.record().force.tolist() == [3.0]
    assert watch.recent[0].startswith("a force is stamped 3599 s ahead of the position: are there two clocks?")
    for at in ns:
        buffer.add_position(at + 3600 * 10**9, 0.5)
    assert buffer.record().force.tolist() == [3.0, 7.0]
