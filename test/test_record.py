"""Record: refuses bad data at birth, keeps what is good to the last bit."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from msd_ident.errors import DataError
from msd_ident.record import Record, batch_stamps, from_samples, from_seconds, from_stamps

T = np.arange(30) / 10
X = np.sin(T)


def build(**changes: object) -> Record:
    parts = {"time": T, "position": X, "force_time": np.array([0.0, 1.0]), "force": np.array([0.0, 2.0]), **changes}
    return Record(**parts)  # type: ignore[arg-type]


def test_a_record_is_frozen_and_keeps_its_own_copy() -> None:
    x = X.copy()
    record = build(position=x)
    x[0] = 99.0
    assert record.position[0] == X[0]
    with pytest.raises(ValueError, match="read-only"):
        record.position[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.name = "other"  # type: ignore[misc]


def test_sizes_and_times() -> None:
    record = build()
    assert (record.samples, record.duration, record.period) == (30, 2.9, pytest.approx(0.1))
    assert not record.shared_clock
    assert from_samples(T, X, X).shared_clock


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"time": T[:19], "position": X[:19]}, "19 position samples; expected at least 20: record longer or faster"),
        ({"position": X[:29]}, "30 stamps for 29 positions"),
        ({"force": np.zeros(3)}, "2 stamps for 3 forces"),
        ({"force": np.zeros(0), "force_time": np.zeros(0)}, "no force samples"),
        ({"position": X[:, None]}, "position has 2 dimensions"),
        ({"position": np.where(T == 1.0, np.nan, X)}, r"position holds 1 values .* \(first: nan at sample 10\)"),
        ({"force": np.array([0.0, np.inf])}, "force holds 1 values that are not finite"),
        ({"time": np.where(T == 1.0, np.inf, T)}, "time holds 1 values that are not finite"),
        ({"time": T[::-1]}, "time runs backwards 29 times"),
        ({"time": np.where(T == 1.0, 0.9, T)}, "time holds 1 duplicate stamps"),
        ({"force_time": np.array([1.0, 0.5])}, "force time runs backwards"),
        ({"force_time": np.array([5.0, 6.0])}, "force starts at 5.000 s, after the last position at 2.900 s"),
        ({"force_time": np.arange(20) - 40.0, "force": np.zeros(20)}, "force ends at -21.000 s, before the first"),
        ({"hold": "cubic"}, "hold is 'cubic'; expected 'zero' or 'linear'"),
    ],
)
def test_bad_data_is_refused_in_words(changes: dict[str, object], words: str) -> None:
    with pytest.raises(DataError, match=words) as refused:
        build(**changes)
    assert "\n" not in str(refused.value)


def test_the_force_between_its_stamps() -> None:
    at = [-1.0, 0.0, 0.5, 1.0, 9.0]
    assert build(force=np.array([1.0, 2.0])).force_at(at).tolist() == [0.0, 1.0, 1.0, 2.0, 2.0]
    assert build(force=np.array([1.0, 2.0]), hold="linear").force_at(at).tolist() == [0.0, 1.0, 1.5, 2.0, 2.0]


@given(start=st.floats(-1, 2.0), length=st.floats(1.95, 5), hold=st.sampled_from(["zero", "linear"]))
def test_a_window_keeps_the_force_that_acts_in_it(start: float, length: float, hold: str) -> None:
    stamps = np.array([-0.5, 0.03, 0.71, 1.2, 2.6])
    record = build(force_time=stamps, force=np.array([1.0, -2.0, 3.0, 0.5, 4.0]), hold=hold)
    inside = (start <= T) & (start + length >= T)
    if np.count_nonzero(inside) < 20:
        with pytest.raises(DataError, match="position samples between"):
            record.window(start, start + length)
        return
    part = record.window(start, start + length)
    np.testing.assert_array_equal(part.time, T[inside])
    np.testing.assert_array_equal(part.position, X[inside])
    np.testing.assert_allclose(part.force_at(part.time), record.force_at(part.time), rtol=1e-12)


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
        ([*range(99, -1, -1)], "0.001 s back at sample 2 of 100 \\(99 samples in all\\)"),
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


def test_batches_are_stamped_by_their_period() -> None:
    assert batch_stamps(10**18 + 1, 33, 4).tolist() == [10**18 + 1 + 33 * i for i in range(4)]
    assert batch_stamps(5, 33, 0).size == 0


def test_what_was_found_out_is_kept_with_this_very_record_alone() -> None:
    record = from_samples(np.arange(30.0), np.ones(30), np.arange(30.0))
    asked: list[int] = []

    def find() -> int:
        asked.append(1)
        return 7

    assert [record.kept("size", find), record.kept("size", find)] == [7, 7] and len(asked) == 1
    long = from_samples(np.arange(60_000.0), np.ones(60_000), np.arange(60_000.0))
    assert [long.kept("size", find, small=True) for _ in range(2)] == [7, 7] and len(asked) == 2
    assert [long.kept("curve", find) for _ in range(2)] == [7, 7] and len(asked) == 4
    copied = pickle.loads(pickle.dumps(record))
    assert copied.kept("size", lambda: 8) == 8
    assert dataclasses.replace(record, name="other").kept("size", lambda: 9) == 9
