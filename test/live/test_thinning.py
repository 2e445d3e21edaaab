"""Thinning: few points, no peak lost, no shimmer while the window moves."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.live.thinning import held, thinned


def test_keeps_every_peak_at_its_own_time() -> None:
    time = np.arange(100_000) / 1000.0
    values = np.sin(time)
    for at, peak in ((40_123, 5.0), (77_777, -6.0)):
        values[at] = peak
    at, shown = thinned(time, values, 10.0, 90.0, 400)
    assert at.size <= 2 * 403
    assert np.all(np.diff(at) >= 0.0)
    assert at[shown.argmax()] == time[40_123]
    assert shown.max() == 5.0
    assert at[shown.argmin()] == time[77_777]
    assert shown.min() == -6.0
    assert at[0] <= 10.0 + 0.2 and at[-1] >= 90.0 - 0.2


def test_each_column_spans_what_its_samples_span() -> None:
    rng = np.random.default_rng(1)
    time, values = (np.arange(10_000) + 0.5) / 1000.0, rng.normal(size=10_000)
    at, shown = thinned(time, values, 0.0, 10.0, 100)
    for column in range(100):
        within = (time >= column / 10) & (time < (column + 1) / 10)
        part = shown[(at >= column / 10) & (at < (column + 1) / 10)]
        assert (part.min(), part.max()) == (values[within].min(), values[within].max())


def test_points_stay_where_they_are_while_the_window_moves() -> None:
    rng = np.random.default_rng(2)
    time, values = 1000.0 + np.arange(20_000) / 1000.0, rng.normal(size=20_000)
    one = dict(zip(*thinned(time, values, 1002.0, 1012.0, 500), strict=True))
    other = dict(zip(*thinned(time, values, 1002.037, 1012.037, 500), strict=True))
    inside = {at: value for at, value in one.items() if 1002.1 < at < 1011.9}
    assert len(inside) > 900
    assert inside.items() <= other.items()


def test_few_samples_are_shown_as_they_are() -> None:
    time, values = np.arange(50) / 10.0, np.arange(50.0)
    at, shown = thinned(time, values, 1.0, 3.0, 100)
    assert np.array_equal(at, time[9:31]) and np.array_equal(shown, values[9:31])
    assert thinned(np.empty(0), np.empty(0), 0.0, 1.0, 10)[0].size == 0


def test_unknown_values_stay_gaps() -> None:
    time, values = np.arange(10_000) / 1000.0, np.ones(10_000)
    values[:5000] = np.nan
    at, shown = thinned(time, values, 0.0, 10.0, 100)
    assert np.all(np.isnan(shown[at < 4.9]))
    assert np.all(shown[at > 5.0] == 1.0)


def test_a_held_force_has_corners() -> None:
    at, shown = held(np.array([0.0, 2.0, 4.0]), np.array([1.0, 3.0, 0.0]), 1.0, 5.0, 100)
    assert at.tolist() == [1.0, 2.0, 2.0, 4.0, 4.0, 5.0]
    assert shown.tolist() == [1.0, 1.0, 3.0, 3.0, 0.0, 0.0]
    assert held(np.array([7.0]), np.array([1.0]), 1.0, 5.0, 100)[0].size == 0
    assert held(np.empty(0), np.empty(0), 1.0, 5.0, 100)[0].size == 0


def test_a_measured_force_is_thinned_like_the_rest() -> None:
    time = np.arange(10_000) / 1000.0
    force = np.sin(time)
    force[1234] = 9.0
    at, shown = held(time, force, 0.0, 10.0, 50)
    assert at.size <= 110
    assert shown.max() == pytest.approx(9.0)
