"""Tracks: the latest rows, by number, in memory that does not grow."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.live.track import Track


@given(st.integers(1, 20), st.lists(st.integers(0, 50), max_size=20))
def test_holds_the_latest_rows_under_their_numbers(capacity: int, sizes: list[int]) -> None:
    track, everything = Track(capacity, 2), np.empty(0)
    room = track.bytes
    for size in sizes:
        new = everything.size + np.arange(size, dtype=float)
        track.append(new, -new)
        everything = np.append(everything, new)
        expected = everything[-capacity:]
        assert np.array_equal(track.column(0), expected)
        assert np.array_equal(track.column(1), -expected)
        assert track.first == everything.size - expected.size
    assert track.bytes == room


def test_columns_that_are_not_given_are_unknown() -> None:
    track = Track(4, 3)
    for _ in range(5):
        track.append([1.0, 2.0], [3.0, 4.0])
        track.column(2)[:] = 7.0
    track.append([5.0], [6.0])
    assert np.isnan(track.column(2)[-1])
    assert np.all(track.column(2)[:-1] == 7.0)


def test_numbers_go_on_after_clearing() -> None:
    track = Track(4, 1)
    track.append([1.0, 2.0, 3.0])
    track.clear()
    assert len(track) == 0
    assert track.first == 3
