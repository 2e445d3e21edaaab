"""Stops with buffers, against scipy and against the simple law."""

from __future__ import annotations

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record

from msd_ident.model import Simulator
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.end_stop import EndStop


@pytest.mark.parametrize(("centre", "damping"), [(0.004, 3.0), (-0.004, 60.0)])
def test_contact_begins_with_the_dampers_force_and_ends_where_it_would_pull(centre: float, damping: float) -> None:
    measured = record(rate=500.0, duration=1.5)
    stop = BufferedStop(centre, 0.012, 4e3, damping)

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        off = x - stop.buffer_centre
        depth = abs(off) - stop.buffer_reach
        push = max(4e3 * depth + damping * v * np.sign(off), 0.0) if depth > 0.0 else 0.0
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        return [v, (force - DAMPING * v - STIFFNESS * x - np.sign(off) * push) / MASS]

    found = Simulator(plant() + stop, measured).positions((plant() + stop).values)
    expected = followed(slope, measured)
    assert np.max(np.abs(found - expected)) < 3e-5 * np.ptp(expected)
    assert np.max(np.abs(expected - centre)) > 0.0125, "both stops are to be hit"


def test_without_damping_around_zero_it_is_the_simple_stop() -> None:
    measured = record()
    simple, same = plant() + EndStop(0.014, 5e3), plant() + BufferedStop(0.0, 0.014, 5e3, 0.0)
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)
