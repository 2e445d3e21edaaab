"""Records from streams: late, repeated and lost stamps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from msd_ident.data.streams import batch_stamps, from_seconds, from_stamps
from msd_ident.errors import DataError

T = np.arange(30) / 10
X = np.sin(T)


@given(
    start=st.integers(0, 2**62),
    gaps=arrays(np.int64, 40, elements=st.integers(1, 10**11)),
)
def test_nanoseconds_can_be_got_back(start: int, gaps: np.ndarray) -> None:
    ns = start + np.cumsum(gaps)
    record = from_stamps(ns, np.arange(40.0), ns[:1], [0.0])
    np.testing.assert_array_equal(record.start_ns + np.rint(record.time * 1e9).astype(np.int64), ns)


@given(order=st.permutations(range(3)), repeated=st.lists(st.integers(0, 99), max_size=2))
def test_late_and_repeated_samples_change_nothing_but_the_notes(order: list[int], repeated: list[int]) -> None:
    ns = 10**18 + 10**6 * np.arange(100, dtype=np.int64)
    x = np.arange(100.0)
    clean = from_stamps(ns, x, ns[:1], [0.0])
    places = [*range(40), *(40 + i for i in order), *range(43, 100)]
    for i in repeated:
        places.insert(places.index(i), i)
    record = from_stamps(ns[places], x[places], ns[:1], [0.0])
    np.testing.assert_array_equal(record.time, clean.time)
    np.testing.assert_array_equal(record.position, clean.position)
    late = any(a > b for a, b in zip(places, places[1:], strict=False))
    assert any("came late" in note for note in record.notes) == late
    assert any(f"{len(repeated)} samples with duplicate stamps" in note for note in record.notes) == bool(repeated)


def test_stamps_that_jump_back_are_refused() -> None:
    ns = 10**18 + 10**6 * np.arange(100, dtype=np.int64)
    for places, words in (
        ([*range(100), *range(50)], "0.099 s back at sample 101 of 150 \\(50 samples in all\\)"),
        ([*range(99, -1, -1)], "0.001 s back at sample 2 of 100 \\(99 samples in all\\); .* sort them by time"),
    ):
        with pytest.raises(DataError, match=words):
            from_stamps(ns[places], np.arange(float(len(places))), ns[:1], [0.0])
    reset = np.append(ns, ns[-3:] - 5 * 10**9)
    with pytest.raises(DataError, match="5.002 s back at sample 101 of 103|5.000 s back at sample 101 of 103"):
        from_stamps(reset, np.arange(103.0), ns[:1], [0.0])


def test_an_old_message_that_is_sent_again_is_no_jump() -> None:
    """A publisher that keeps its last message sends it again to every new subscriber."""
    ns = 10**18 + 10**9 * np.arange(30, dtype=np.int64)
    record = from_stamps(ns, np.arange(30.0), ns[[0, 10, 20, 0]], [0.0, 1.0, 2.0, 0.0])
    assert record.force.tolist() == [0.0, 1.0, 2.0]


@given(st.lists(st.integers(0, 59), min_size=10, max_size=60), st.integers(1, 20))
def test_a_rig_that_tells_its_commands_again_changes_nothing_but_the_notes(told: list[int], later: int) -> None:
    """Each of its messages has the stamp and the value of the command, and comes behind newer ones."""
    ns = 10**18 + 10**7 * np.arange(60, dtype=np.int64)
    force = np.random.default_rng(3).normal(size=60)
    places = list(range(60))
    for i in told:
        places.insert(min(places.index(i) + later, len(places)), i)
    clean, record = (from_stamps(ns, np.arange(60.0), ns[at], force[at]) for at in (list(range(60)), places))
    np.testing.assert_array_equal(record.force_time, clean.force_time)
    np.testing.assert_array_equal(record.force, clean.force)
    assert any(f"{len(told)} samples with duplicate stamps were dropped." in note for note in record.notes)


@pytest.mark.parametrize(("period", "ahead"), [(2, 25), (2, 700), (500, 3)])
def test_forces_that_are_taken_back_did_not_act(period: int, ahead: int) -> None:
    """Who stops sends 0 with the present stamp, and with each stamp that it sent ahead: the later one counts."""
    ns = 10**18 + 10**6 * np.arange(4000, dtype=np.int64)
    sent = ns[100:3000:period]
    stop = sent[-ahead] - 300_000
    told = np.concatenate([sent, [stop], sent[-ahead:]])
    force = np.concatenate([1.0 + np.arange(sent.size) % 7, np.zeros(ahead + 1)])
    record = from_stamps(ns, np.arange(4000.0), told, force)
    stopped = (stop - ns[0]) / 1e9
    np.testing.assert_array_equal(record.force[record.force_time >= stopped], np.zeros(ahead + 1))
    np.testing.assert_array_equal(record.force[record.force_time < stopped], force[: sent.size - ahead])
    dropped = f"force: {ahead} samples with duplicate stamps were dropped"
    assert record.notes == (f"{dropped}, {ahead} of them replaced by a 0 that was sent later.",)


def test_of_forces_of_a_clock_that_ticks_rarely_the_first_one_of_a_tick_counts() -> None:
    """As of the positions beside it. No 0 among them takes anything back."""
    ns = 10**18 + 2 * 10**7 * (np.arange(2000, dtype=np.int64) // 20)
    force = np.where(np.arange(2000) % 7 < 4, 5.0, 0.0)
    record = from_stamps(ns, np.arange(2000.0), ns, force)
    np.testing.assert_array_equal(record.force, force[::20])
    (said,) = [note for note in record.notes if note.startswith("force: ")]
    assert "with another value: their clock ticks every 0.02 s" in said and "sent later" not in said


@pytest.mark.parametrize(("place", "stamp"), [(500, -5.0), (500, 0.0), (300, 60.0)])
def test_one_stamp_out_of_place_is_named(place: int, stamp: float) -> None:
    time = 0.01 * np.arange(1000) + 1.0
    time[place] = stamp
    with pytest.raises(DataError, match=f"in all.*sample {place + 1} alone is out of place, remove it"):
        from_seconds(time, np.arange(1000.0), time[:1], [0.0])


def test_a_table_keeps_the_first_line_of_a_stamp() -> None:
    """Its lines are no messages, of which a later one replaces an earlier one."""
    record = from_seconds(np.repeat(T, 2), np.repeat(X, 2), np.repeat(T, 2), np.tile([1.0, 0.0], T.size))
    assert set(record.force) == {1.0}


def test_commands_from_before_the_record_may_come_in_any_order() -> None:
    """A recorder that listens late is sent all that a publisher keeps, after the first new command."""
    ns = 10**18 + 10**7 * np.arange(200, dtype=np.int64)
    force = np.random.default_rng(3).normal(size=200)
    places = [100, *range(0, 80), *range(101, 200)]
    clean = from_stamps(ns[100:], np.arange(100.0), ns[sorted(places)], force[sorted(places)])
    record = from_stamps(ns[100:], np.arange(100.0), ns[places], force[places])
    np.testing.assert_array_equal(record.force_time, clean.force_time)
    np.testing.assert_array_equal(record.force, clean.force)
    assert any("80 samples from before the positions came out of order" in note for note in record.notes)


@pytest.mark.parametrize("back", [0, 10**18 - 5 * 10**11])
def test_a_clock_of_the_force_that_is_set_back_is_no_history(back: int) -> None:
    """From halfway on all forces are from before the record: they act within it."""
    ns = 10**18 + 10**7 * np.arange(200, dtype=np.int64)
    told = ns.copy()
    told[100:] = back + 10**7 * np.arange(100)
    with pytest.raises(DataError, match="force stamps run backwards"):
        from_stamps(ns, np.arange(200.0), told, np.arange(200.0))


def test_one_stamp_in_the_future_is_no_reversed_table() -> None:
    ns = 10**18 + 10**7 * np.arange(50, dtype=np.int64)
    told = np.append(ns[-1] + 10**12, ns)
    with pytest.raises(DataError, match="looped or its clock was reset"):
        from_stamps(told, np.arange(51.0), ns[:1], [0.0])


def test_a_table_that_is_sorted_by_another_column_or_has_one_wrong_stamp_is_told_so() -> None:
    """The recording was said to be looped, "107 samples in all" of which came before a first stamp of 1.074 s."""
    time = 0.01 * np.arange(2000)
    wrong = np.append(1.074, time[1:])
    with pytest.raises(DataError, match="rising stamps: sample 1 alone is out of place, remove it; or the recording"):
        from_seconds(wrong, np.sin(time), [0.0], [0.0])
    order = np.argsort(np.sin(7.0 * time))
    with pytest.raises(DataError, match="their order is that of something else, sort them by time"):
        from_seconds(time[order], np.sin(7.0 * time)[order], [0.0], [0.0])


def test_forces_that_jump_back_within_the_record_are_refused() -> None:
    ns = 10**18 + 10**7 * np.arange(200, dtype=np.int64)
    places = [*range(100), *range(50, 150)]
    with pytest.raises(DataError, match="force stamps run backwards: 0.490 s back at sample 101 of 200"):
        from_stamps(ns, np.arange(200.0), ns[places], np.arange(200.0))


def test_streams_of_different_length_are_refused() -> None:
    with pytest.raises(DataError, match="3 stamps for 2 position values"):
        from_stamps([1, 2, 3], [0.0, 0.0], [1], [0.0])
    with pytest.raises(DataError, match="no force samples"):
        from_stamps(np.arange(30), np.arange(30.0), [], [])


def test_seconds_count_from_the_first_position() -> None:
    record = from_seconds(T + 5.0, X, np.array([4.0, 7.0]), np.array([1.0, 2.0]))
    np.testing.assert_allclose(record.time, T, atol=1e-15)
    np.testing.assert_allclose(record.force_time, [-1.0, 2.0])
    with pytest.raises(DataError, match="position time holds 1 values that are not finite"):
        from_seconds(np.where(T == 1.0, np.nan, T), X, T, X)


@pytest.mark.parametrize("table", [True, False])
def test_samples_that_share_a_stamp_say_why(table: bool) -> None:
    """A clock that stood still for 600 of 1000 samples does not "tick every 0.005 s"; packets have a rate to give."""
    time = 0.005 * np.arange(1000)
    still, packets = np.minimum(time, time[400]), 0.08 * np.floor(time / 0.08)
    notes = []
    for stamps in (still, packets):
        of = (stamps, time[:1]) if table else (np.rint(1e9 * stamps).astype(np.int64), np.zeros(1, dtype=np.int64))
        make = from_seconds if table else from_stamps
        notes.append(" ".join(make(of[0], np.arange(1000.0), of[1], [0.0]).notes))
    assert "the clock stood still at 2.000 s, for 600 samples" in notes[0] and "ticks" not in notes[0]
    assert "their clock ticks every 0.08 s, so force and position may be as far apart" in notes[1]
    assert ("give their rate, about 200 Hz, with --rate" in notes[1]) == table
    if table:
        with pytest.raises(DataError, match="only 4 different stamps; .* give their rate, about 200 Hz, with --rate"):
            from_seconds(1.25 * np.floor(time / 1.25), np.arange(1000.0), time[:1], [0.0])


def test_batches_are_stamped_by_their_period() -> None:
    assert batch_stamps(10**18 + 1, 33, 4).tolist() == [10**18 + 1 + 33 * i for i in range(4)]
    assert batch_stamps(5, 33, 0).size == 0
