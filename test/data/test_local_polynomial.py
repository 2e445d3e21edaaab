"""The local polynomials have the digits of scipy.signal."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.local_polynomial import local_polynomial


@given(st.integers(0, 2**31), st.integers(2, 40), st.integers(0, 60), st.floats(1e-5, 1.0), st.integers(0, 3))
def test_digits_are_those_of_scipy(seed: int, half: int, more: int, step: float, derivative: int) -> None:
    window = 2 * half + 1
    signal = np.random.default_rng(seed).normal(size=window + more)
    found = local_polynomial(signal, window, 3, derivative, step)
    expected = scipy.signal.savgol_filter(signal, window, 3, deriv=derivative, delta=step)
    assert np.array_equal(found, expected)


@pytest.mark.parametrize(("derivative", "expected"), [(0, [0, 1, 8, 27, 64]), (1, [0, 3, 12, 27, 48])])
def test_a_cubic_is_kept(derivative: int, expected: list[float]) -> None:
    """The signal t³ at the times 0, 1, … 4 s, its ends included."""
    found = local_polynomial(np.arange(5.0) ** 3, 5, 3, derivative, 1.0)
    assert found == pytest.approx(expected, abs=1e-9)
