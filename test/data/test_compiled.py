"""The compiled functions have the digits of scipy."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import scipy.ndimage
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data import compiled

#: Coarse values, so that flat tops are common.
STEPS = st.lists(st.integers(-6, 6), min_size=3, max_size=80)


@given(STEPS, st.integers(0, 8))
def test_peaks_are_those_of_scipy(values: list[int], prominence: int) -> None:
    signal = np.array(values, dtype=float)
    expected, shape = scipy.signal.find_peaks(signal, prominence=prominence, plateau_size=1)
    middles = (shape["left_edges"] + shape["right_edges"]) // 2
    assert compiled.peaks(signal, float(prominence)).tolist() == middles.tolist() == expected.tolist()


@given(st.integers(0, 2**31), st.integers(0, 12), st.integers(1, 3))
def test_filter_has_the_digits_of_scipy(seed: int, order: int, rows: int) -> None:
    lots = np.random.default_rng(seed)
    coefficients = np.concatenate([[1.0], 0.3 * lots.normal(size=order)])
    signals = lots.normal(size=(rows, 60))
    expected = np.stack([scipy.signal.lfilter([1.0], coefficients, row) for row in signals])
    assert np.array_equal(compiled.all_pole(coefficients, signals), expected)
    backwards = compiled.all_pole(coefficients, signals[:, ::-1])
    assert np.array_equal(backwards[0], compiled.all_pole(coefficients, signals[0, ::-1]))


@given(st.integers(0, 2**31), st.integers(1, 6), st.floats(0.1, 10.0))
def test_filter_with_zeros_has_the_digits_of_scipy(seed: int, order: int, first: float) -> None:
    lots = np.random.default_rng(seed)
    above, below = lots.normal(size=order + 1), np.concatenate([[first], 0.3 * lots.normal(size=order)])
    signal = lots.normal(size=60)
    assert np.array_equal(compiled.pole_zero(above, below, signal), scipy.signal.lfilter(above, below, signal))


@given(STEPS, st.integers(1, 30), st.floats(0.0, 0.999))
def test_ranks_are_those_of_scipy(values: list[int], window: int, share: float) -> None:
    signal = np.array(values, dtype=float)
    window = min(window, signal.size)
    rank = int(share * window)
    around = scipy.ndimage.rank_filter(signal, rank, size=window)
    expected = around[window // 2 : window // 2 + signal.size - window + 1]
    assert np.array_equal(compiled.ranked(signal, rank, window), expected)


def test_identify_does_not_import_what_is_slow_to_import() -> None:
    slow = "{'scipy.ndimage', 'scipy.signal', 'scipy.stats'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", f"import sys, msd_ident.workflow.identify; assert not {slow}"], check=True)
