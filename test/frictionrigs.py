"""The examples' plant with dry friction of any law, by scipy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from effect_examples import DAMPING, MASS, STIFFNESS
from scipy.integrate import solve_ivp

from msd_ident.data.record import Record


def rubbing(measured: Record, friction: Callable[[float, float], float], steepness: float) -> np.ndarray:
    """Positions (n,) of the plant with friction(t, x)·tanh(v·steepness), nearly a jump at v = 0."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        rubs = friction(t, state[0]) * math.tanh(state[1] * steepness)
        return [state[1], (force - DAMPING * state[1] - rubs - STIFFNESS * state[0]) / MASS]

    found, state = [0.0], np.zeros(2)
    for begin, end in zip(measured.time[:-1], measured.time[1:], strict=True):
        state = solve_ivp(slope, (begin, end - 1e-12), state, method="LSODA", rtol=1e-8, atol=1e-11).y[:, -1]
        found.append(float(state[0]))
    return np.array(found)
