"""The compiled laws' own sine."""

from __future__ import annotations

import math

import numba
import numpy as np
import pytest

from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.kernel.sine import sine, with_own_sine


@numba.njit
def _sines(angles: np.ndarray) -> np.ndarray:
    out = np.empty(angles.size)
    for i in range(angles.size):
        out[i] = sine(angles[i])
    return out


@pytest.mark.parametrize("largest", [1.0, 10.0, 1e5])
def test_right_to_the_last_digits(largest: float) -> None:
    angles = np.concatenate([np.linspace(-largest, largest, 100_001), 0.5 * np.pi * np.arange(-9, 10)])
    assert np.max(np.abs(_sines(angles) - np.sin(angles))) < 5e-16


def test_what_is_not_finite_stays_so() -> None:
    assert not np.isfinite(_sines(np.array([np.nan, np.inf, -np.inf]))).any()


def test_a_law_keeps_its_text() -> None:
    law = numba.njit(with_own_sine(Cogging.force))
    assert law(0.013, 2.0, 0.01, 0.4) == pytest.approx(2.0 * math.sin(2.0 * math.pi * 1.3 + 0.4), abs=1e-14)
    assert with_own_sine(CubicSpring.force) is CubicSpring.force
