"""Sizes of a motion: a rest after it changes none of them."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model.effects import typical


def swings(rest: float, noise: float = 1e-6) -> Record:
    """One second of a swing of 10 mm at 5 Hz, then a rest [s], with noise [m], at 500 Hz."""
    time = np.arange(round(500 * (1.0 + rest))) / 500.0
    position = np.where(time < 1.0, 1e-2 * np.sin(10.0 * np.pi * time), 0.0)
    position += noise * np.random.default_rng(1).standard_normal(time.size)
    return from_samples(time, np.zeros(time.size), position)


@pytest.mark.parametrize("rest", [0.0, 1.0, 20.0, 200.0])
def test_the_top_speed_does_not_depend_on_how_long_the_cart_rests(rest: float) -> None:
    assert typical.speed(swings(rest)) == pytest.approx(0.1 * np.pi, rel=0.05)
