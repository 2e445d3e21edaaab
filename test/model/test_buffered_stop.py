"""Stops with buffers, against scipy and against the simple law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record

from msd_ident.model import Simulator, simulate
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


def test_a_buffer_without_a_spring_still_damps_beyond_its_place() -> None:
    measured = record()
    bare, soft = plant() + BufferedStop(0.0, 0.014, 0.0, 20.0), plant() + BufferedStop(0.0, 0.014, 1e-6, 20.0)
    found, free = (simulate(model, measured).position for model in (bare, plant()))
    assert found == pytest.approx(simulate(soft, measured).position, abs=1e-9)
    assert np.ptp(found) < 0.99 * np.ptp(free), "it is to damp the motion"


def test_long_steps_see_where_contact_begins_and_where_the_buffer_lets_go() -> None:
    """The force jumps, and bends. A step that saw beyond either was wrong by up to 1.4e-7 m here."""
    coarse = record(rate=250.0, duration=2.0)
    time = np.arange(16 * (coarse.time.size - 1) + 1) / 4000.0
    fine = replace(coarse, time=time, position=0.0 * time)
    draw = np.random.default_rng(1)
    for _ in range(24):
        stop = BufferedStop(0.001, draw.uniform(0.008, 0.018), draw.uniform(1e3, 1e4), draw.uniform(2.0, 60.0))
        model = plant() + stop
        found = simulate(model, coarse, 0.004, 0.05).position
        assert found == pytest.approx(simulate(model, fine, 0.004, 0.05).position[::16], abs=5e-9)
