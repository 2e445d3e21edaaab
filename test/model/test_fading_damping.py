"""Damping that fades with the speed, against scipy and against its limit."""

from __future__ import annotations

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, plant, record
from scipy.integrate import solve_ivp

from msd_ident.model import Plant, Simulator
from msd_ident.model.effects.fading_damping import FadingDamping


@pytest.mark.parametrize(("speed", "exponent"), [(0.05, 2.0), (0.15, 1.0), (0.15, 0.7), (0.4, 3.0)])
def test_against_scipy(speed: float, exponent: float) -> None:
    measured = record(rate=500.0, duration=1.5)
    model = plant() + FadingDamping(3.0, speed, exponent)

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        fading = 3.0 * v / (1.0 + (abs(v) / speed) ** exponent)
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        return [v, (force - DAMPING * v - fading - STIFFNESS * x) / MASS]

    found = Simulator(model, measured).positions(model.values)
    state, expected = [0.0, 0.0], [0.0]
    for begin, end in zip(measured.time[:-1], measured.time[1:], strict=True):
        state = solve_ivp(slope, (begin, end - 1e-12), state, rtol=1e-10, atol=1e-14).y[:, -1].tolist()
        expected.append(state[0])
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)


def test_far_below_its_speed_it_is_damping() -> None:
    measured = record()
    slow, same = plant() + FadingDamping(3.0, 1e4, 3.0), Plant(MASS, DAMPING + 3.0, STIFFNESS)
    found = Simulator(slow, measured).positions(slow.values)
    expected = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)
