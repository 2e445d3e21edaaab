"""Loops of ``force_smoother``, for numba to compile: what they find, they fill in."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator"

from __future__ import annotations

import math

import numpy as np
from numba import njit

from msd_ident.residuals.force_smoother import SETTLED, STATES, WORK, Law, Readings

__all__ = ["Law", "Readings", "filtered", "smoothed"]


@njit(error_model="numpy")
def _transition(h, law, a, g):
    """Fill a (5, 5) with the transition of the state over h and g (2,) with the effect of a held force."""
    # Taylor series of the generator [[0, 1, 0], [-k/m, -b/m, -1/m], [0, 0, 0]] on each column, over a part of the step
    # in which the plant hardly moves; then that part twice, and so on.
    m, b, k, memory = law.m, law.b, law.k, law.memory
    p, r = -k / m, -b / m
    halvings = max(0, math.ceil(math.log2(max(h * max(math.sqrt(abs(p)), abs(r)), 1e-300))))
    part = h * 0.5**halvings
    for i in range(STATES):
        for j in range(STATES):
            a[i, j] = 0.0
    for column in range(3):
        x = 1.0 if column == 0 else 0.0
        v = 1.0 if column == 1 else 0.0
        d = 1.0 if column == 2 else 0.0
        sx, sv = x, v
        for n in range(1, 13):
            x, v, d = v * part / n, (p * x + r * v - d / m) * part / n, 0.0
            sx += x
            sv += v
        a[0, column], a[1, column] = sx, sv
    for _ in range(halvings):
        a00, a01, a10, a11 = a[0, 0], a[0, 1], a[1, 0], a[1, 1]
        a02, a12 = a[0, 2], a[1, 2]
        a[0, 2], a[1, 2] = a00 * a02 + a01 * a12 + a02, a10 * a02 + a11 * a12 + a12
        a[0, 0], a[0, 1] = a00 * a00 + a01 * a10, a00 * a01 + a01 * a11
        a[1, 0], a[1, 1] = a10 * a00 + a11 * a10, a10 * a01 + a11 * a11
    a[2, 2] = 1.0
    rate = 1.0 / memory
    fade = math.exp(-rate * h)
    a[3, 3], a[3, 4] = fade * (1.0 + rate * h), fade * h
    a[4, 3], a[4, 4] = -fade * rate * rate * h, fade * (1.0 - rate * h)
    g[0], g[1] = -a[0, 2], -a[1, 2]


@njit(error_model="numpy")
def _carried(a, c, out):
    """out = a c aᵀ."""
    for i in range(STATES):
        for j in range(i + 1):
            total = 0.0
            for u in range(STATES):
                for w in range(STATES):
                    total += a[i, u] * c[u, w] * a[j, w]
            out[i, j] = total
            out[j, i] = total


@njit(error_model="numpy")
def _walked(h, law, a, out):
    """out += Q, the covariance that the walk and the smooth error gain over h (plant forces within a step left out)."""
    m, walk = law.m, law.walk
    out[0, 0] += walk * h**5 / (20.0 * m * m)
    out[1, 1] += walk * h**3 / (3.0 * m * m)
    out[2, 2] += walk * h
    cross = walk * h**4 / (8.0 * m * m), -walk * h**3 / (6.0 * m), -walk * h**2 / (2.0 * m)
    out[0, 1] += cross[0]
    out[1, 0] += cross[0]
    out[0, 2] += cross[1]
    out[2, 0] += cross[1]
    out[1, 2] += cross[2]
    out[2, 1] += cross[2]
    # Of the smooth error, what makes its variance and that of its rate stay: P - A P A'.
    error, rate = law.smooth, law.smooth / (law.memory * law.memory)
    out[3, 3] += error - (a[3, 3] * a[3, 3] * error + a[3, 4] * a[3, 4] * rate)
    out[4, 4] += rate - (a[4, 3] * a[4, 3] * error + a[4, 4] * a[4, 4] * rate)
    both = a[3, 3] * a[4, 3] * error + a[3, 4] * a[4, 4] * rate
    out[3, 4] -= both
    out[4, 3] -= both


@njit(error_model="numpy")
def filtered(readings, law, typical, kept, likelihood):
    """Kalman filter; ``typical`` is the median step of time [s], which sizes the first velocity."""
    states, work = kept
    steps, y, u = readings
    m, k, variance = law.m, law.k, law.variance
    n, keep = y.size, states.shape[0] > 0
    a, g = np.empty((STATES, STATES)), np.empty(2)
    c, ahead = np.zeros((STATES, STATES)), np.zeros((STATES, STATES))
    gain = np.zeros(STATES)
    low, high, largest = y[0], y[0], 0.0
    for i in range(n):
        low, high = min(low, y[i]), max(high, y[i])
    for i in range(u.size):
        largest = max(largest, abs(u[i]))
    reach = high - low
    c[0, 0] = variance + law.smooth
    c[1, 1] = max(reach / typical, 1e-12) ** 2 * 1e-2
    c[2, 2] = max(largest, abs(k) * reach, m * reach) ** 2 + law.walk
    c[3, 3], c[4, 4] = law.smooth, law.smooth / (law.memory * law.memory)
    c[0, 3] = c[3, 0] = -law.smooth  # the first reading is x + c
    x, v, d, e, r = y[0], 0.0, 0.0, 0.0, 0.0
    if keep:
        states[0, 0], states[0, 1], states[0, 2], states[0, 3], states[0, 4] = x, v, d, e, r
        for p in range(STATES):
            for q in range(STATES):
                work[0, STATES * p + q] = c[p, q]
    total, last, settled, spread, logged = 0.0, -1.0, False, 0.0, 0.0
    for i in range(1, n):
        h = steps[i - 1]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, law, a, g)
            last, settled = h, False
        if not settled:
            _carried(a, c, ahead)
            _walked(h, law, a, ahead)
            before = spread
            spread = ahead[0, 0] + 2.0 * ahead[0, 3] + ahead[3, 3] + variance
            logged = math.log(spread)
            for p in range(STATES):
                gain[p] = (ahead[p, 0] + ahead[p, 3]) / spread
            for p in range(STATES):
                for q in range(STATES):
                    c[p, q] = ahead[p, q] - gain[p] * (ahead[0, q] + ahead[3, q])
            settled = abs(spread - before) < SETTLED * spread and i > 50
        nx = a[0, 0] * x + a[0, 1] * v + a[0, 2] * d + g[0] * u[i - 1]
        nv = a[1, 0] * x + a[1, 1] * v + a[1, 2] * d + g[1] * u[i - 1]
        ne, nr = a[3, 3] * e + a[3, 4] * r, a[4, 3] * e + a[4, 4] * r
        surprise = y[i] - nx - ne
        x, v, d = nx + gain[0] * surprise, nv + gain[1] * surprise, d + gain[2] * surprise
        e, r = ne + gain[3] * surprise, nr + gain[4] * surprise
        total -= 0.5 * (surprise * surprise / spread + logged)
        if not keep:
            continue
        states[i, 0], states[i, 1], states[i, 2], states[i, 3], states[i, 4] = x, v, d, e, r
        work[i, WORK - 2], work[i, WORK - 1] = spread, surprise
        for p in range(STATES):
            for q in range(STATES):
                work[i, STATES * p + q] = c[p, q]
    likelihood[0] = total


@njit(error_model="numpy")
def smoothed(steps, law, states, work, spread):
    """Bryson-Frazier smoother of what the filter kept."""
    n, variance = states.shape[0], law.variance
    a, g, gain = np.empty((STATES, STATES)), np.empty(2), np.empty(STATES)
    # What the later readings say: minus the gradient of their log likelihood in the state, and its information.
    pull, known = np.zeros(STATES), np.zeros((STATES, STATES))
    moved, seen, half = np.empty(STATES), np.empty((STATES, STATES)), np.empty((STATES, STATES))
    c, last = np.empty((STATES, STATES)), -1.0
    for i in range(n - 1, -1, -1):
        for p in range(STATES):
            for q in range(STATES):
                c[p, q] = work[i, STATES * p + q]
        explained = 0.0
        for p in range(STATES):
            for q in range(STATES):
                states[i, p] -= c[p, q] * pull[q]
                explained += c[2, p] * known[p, q] * c[q, 2]
        spread[i] = max(c[2, 2] - explained, 0.0)
        if i == 0:
            break
        total, error = work[i, WORK - 2], work[i, WORK - 1]
        back = error / total
        for p in range(STATES):
            gain[p] = (c[p, 0] + c[p, 3]) / variance
            back += gain[p] * pull[p]
        # Back over the reading: C' l - h e / s, C' L C + h h' / s with C = 1 - gain h', h = (1, 0, 0, 1, 0) ...
        for p in range(STATES):
            moved[p] = pull[p]
        moved[0] -= back
        moved[3] -= back
        _seen_through(known, gain, seen)
        for p in (0, 3):
            for q in (0, 3):
                seen[p, q] += 1.0 / total
        # ... and over the step before it.
        h = steps[i - 1]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, law, a, g)
            last = h
        for p in range(STATES):
            pull[p] = 0.0
            for u in range(STATES):
                pull[p] += a[u, p] * moved[u]
                half[p, u] = 0.0
                for w in range(STATES):
                    half[p, u] += a[w, p] * seen[w, u]
        for p in range(STATES):
            for q in range(STATES):
                known[p, q] = 0.0
                for u in range(STATES):
                    known[p, q] += half[p, u] * a[u, q]


@njit(error_model="numpy")
def _seen_through(known, gain, out):
    """out = C' known C with C = 1 - gain h', h = (1, 0, 0, 1, 0)."""
    row = np.zeros(STATES)
    for q in range(STATES):
        for u in range(STATES):
            row[q] += gain[u] * known[u, q]
    for p in range(STATES):
        for q in range(STATES):
            out[p, q] = known[p, q] - (row[q] if p in (0, 3) else 0.0)
    for p in range(STATES):
        along = 0.0
        for u in range(STATES):
            along += out[p, u] * gain[u]
        out[p, 0] -= along
        out[p, 3] -= along
