"""Loops of ``nonparametric``, for numba to compile: what they find, they fill in."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit


@njit(error_model="numpy")
def _value(table, at):
    """Piecewise linear, going on straight beyond the ends."""
    knots, values = table
    i = min(max(np.searchsorted(knots, at) - 1, 0), knots.size - 2)
    share = (at - knots[i]) / (knots[i + 1] - knots[i])
    return values[i] + share * (values[i + 1] - values[i])


@njit(error_model="numpy")
def simulate(time, force, plant, start, out):
    """Classical Runge–Kutta, two steps a sample; a held force between samples."""
    m, spring, damper = plant
    x, v = start[0], start[1]
    out[0] = x
    for i in range(1, time.size):
        h = 0.5 * (time[i] - time[i - 1])
        u = force[i - 1]
        for _ in range(2):
            a1 = (u - _value(spring, x) - _value(damper, v)) / m
            v2 = v + 0.5 * h * a1
            a2 = (u - _value(spring, x + 0.5 * h * v) - _value(damper, v2)) / m
            v3 = v + 0.5 * h * a2
            a3 = (u - _value(spring, x + 0.5 * h * v2) - _value(damper, v3)) / m
            v4 = v + h * a3
            a4 = (u - _value(spring, x + h * v3) - _value(damper, v4)) / m
            x += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
        out[i] = x
