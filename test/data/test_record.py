"""Record: refuses bad data at birth, keeps what is good to the last bit."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError

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


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_window_before_the_first_force_has_none(hold: str) -> None:
    late = build(force_time=np.array([0.9 * T[-1], T[-1]]), force=np.array([3.0, 1.0]), hold=hold)
    part = late.window(T[0], 0.8 * T[-1])
    np.testing.assert_array_equal(part.force_at(part.time), 0.0)


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
