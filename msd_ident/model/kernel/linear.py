"""Exact motion of m x'' + b x' + k x = f + r t + e exp(-t/tau), by matrix and by Taylor series.

No case is told from another: underdamped, critical, overdamped, without spring or without damping are one series,
short enough steps of which converge to the last digit.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.groups import Line, Motion, Series

#: Terms of the longest series; with rate * time up to LONGEST the rest is below the last digit.
TERMS = 26
LONGEST = 2.0
#: Unit starts of (x, v, f, r, e).
_UNITS = tuple(tuple(float(i == j) for i in range(5)) for j in range(5))
_INVERSE = np.array([1.0 / ((n + 1.0) * (n + 2.0)) for n in range(TERMS)])


@lean
def fastest_rate(plant):
    """Largest rate [1/s] of the free motion."""
    m, b, k = plant
    return max(abs(b) / m, math.sqrt(abs(k) / m))


@lean
def terms_for(reach):
    """Number of terms after which the series of a step rate * time = reach has converged."""
    if reach <= 0.06:
        return 9
    if reach <= 0.5:
        return 15
    return TERMS


@lean
def series(c, terms, plant, motion, line):
    """The motion from ``motion`` under the force ``line``: Taylor coefficients of x(t) into c[:terms]."""
    m, b, k = plant
    c[0] = motion.x
    c[1] = motion.v
    push = line.f + line.e
    transient = line.e
    lightness = 1.0 / m
    for n in range(terms - 2):
        c[n + 2] = (push - k * c[n] - b * (n + 1.0) * c[n + 1]) * lightness * _INVERSE[n]
        transient *= -line.decay / (n + 1.0)
        push = transient
        if n == 0:
            push += line.r
    return Series(c, terms)


@lean
def position(series, t):
    """x(t) of the series."""
    c, terms = series
    value = c[terms - 1]
    for n in range(terms - 2, -1, -1):
        value = value * t + c[n]
    return value


@lean
def velocity(series, t):
    """x'(t) of the series."""
    c, terms = series
    value = (terms - 1.0) * c[terms - 1]
    for n in range(terms - 2, 0, -1):
        value = value * t + n * c[n]
    return value


@lean
def acceleration(series, t):
    """x''(t) of the series."""
    c, terms = series
    value = 0.0
    for n in range(terms - 1, 1, -1):
        value = value * t + n * (n - 1.0) * c[n]
    return value


@lean
def jerk(series, t):
    """x'''(t) of the series."""
    c, terms = series
    value = 0.0
    for n in range(terms - 1, 2, -1):
        value = value * t + n * (n - 1.0) * (n - 2.0) * c[n]
    return value


@lean
def velocity_and_acceleration(series, t):
    """(x'(t), x''(t)) of the series."""
    c, terms = series
    value, slope = (terms - 1.0) * c[terms - 1], 0.0
    for n in range(terms - 2, 0, -1):
        slope = slope * t + value
        value = value * t + n * c[n]
    return value, slope


@lean
def propagator(row, plant, h, decay, c):
    """Fill row (10,) with x <- x, v, f, r, e and v <- x, v, f, r, e over a time h [s]; ``c``: room for a series.

    The series of each unit start over a step short enough, then the step doubled as often as need be.
    """
    rate = fastest_rate(plant)
    fast = decay > 4.0 * rate
    lag = 0.0 if fast else decay
    doublings = 0
    step = h
    while max(rate, lag) * step > 0.5 and doublings < 60:
        step *= 0.5
        doublings += 1
    terms = terms_for(max(rate, lag) * step)
    for j in range(5):
        x, v, f, r, e = _UNITS[j]
        unit = series(c, terms, plant, Motion(x, v), Line(f, r, e, lag))
        row[j], row[5 + j] = position(unit, step), velocity(unit, step)
    for _ in range(doublings):
        fade = math.exp(-lag * step)
        for j in range(5):
            x, v, f, r, e = _UNITS[j]
            c[j], c[5 + j] = propagate(row, Motion(row[j], row[5 + j]), Line(f + r * step, r, e * fade, lag))
        for j in range(10):
            row[j] = c[j]
        step *= 2.0
    if fast:
        _fast_transient(row, plant, h, decay)


@lean
def propagate(row, motion, line):
    """The motion after the time that row was made for, see ``propagator``."""
    x, v = motion
    f, r, e, _ = line
    return Motion(
        row[0] * x + row[1] * v + row[2] * f + row[3] * r + row[4] * e,
        row[5] * x + row[6] * v + row[7] * f + row[8] * r + row[9] * e,
    )


@lean
def _fast_transient(row, plant, h, decay):
    """The columns of e where its decay is much faster than the plant: particular solution q exp(-t/tau)."""
    m, b, k = plant
    q = 1.0 / ((m * decay - b) * decay + k)
    end = math.exp(-decay * h)
    row[4] = q * (end - (row[0] - row[1] * decay))
    row[9] = q * (-decay * end - (row[5] - row[6] * decay))
