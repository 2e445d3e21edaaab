"""Where the smooth motion of the general path ends: turns, knees of the spring, breaking away from rest.

A step that passes an event is repeated with another length until it ends on it. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.rk import forces_at, step5, step_to
from msd_ident.model.kernel.roots import first_exit

_SEARCHES = 60
#: A correction this small, in parts of the step, is left out: far below the error of the step itself.
_SETTLED = 1e-8


@lean
def turn(fifth, world, p, w, place, drive, s, t, h, x, v, a, y, u, c, v1, a1, k):
    """The step of length in (0, h] that ends with v = 0, given the end (v1, a1) of the step h beyond it.

    Returns (length, x, v, a, y, u, c), v up to what is left of the search.
    """
    low, high = 0.0, h
    tau = _cubic_root(h, s * v, s * a, s * v1, s * a1)
    for _ in range(_SEARCHES):
        xt, vt, at, yt, ut, ct, _, _ = step_to(fifth, world, p, w, place, drive, s, t, tau, x, v, a, y, u, c, k)
        if s * vt > 0.0:
            low = tau
        else:
            high = tau
        new = tau - vt / at if s * at < 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= _SETTLED * h or high - low <= 1e-15 * h:
            break
        tau = new if low < new < high else 0.5 * (low + high)
    return tau, xt, vt, at, yt, ut, ct


@lean
def _cubic_root(h, v0, a0, v1, a1):
    """Guess of the root of v in (0, h], v0 > 0 > v1, on the cubic through both ends with their slopes."""
    tau = v0 / (v0 - v1) if v0 > v1 else 0.5
    p, q = a0 * h, a1 * h
    for _ in range(3):
        rest = 1.0 - tau
        value = (v0 * (1.0 + 2.0 * tau) + p * tau) * rest * rest
        value += (v1 * (3.0 - 2.0 * tau) - q * rest) * tau * tau
        slope = 6.0 * (v1 - v0) * tau * rest + p * rest * (1.0 - 3.0 * tau) + q * tau * (3.0 * tau - 2.0)
        if not slope < 0.0:
            break
        tau = min(max(tau - value / slope, 0.0), 1.0)
    return tau * h if 0.0 < tau < 1.0 else 0.5 * h


@lean
def slowest(h, v0, a0, v1, a1):
    """Time in (0, h) at which a motion is slowest that slows down and speeds up again, on the same cubic."""
    p, q = a0 * h, a1 * h
    square, linear = 3.0 * (p + q) + 6.0 * (v0 - v1), -4.0 * p - 2.0 * q - 6.0 * (v0 - v1)
    low, high = 0.0, 1.0
    for _ in range(20):
        tau = 0.5 * (low + high)
        if (square * tau + linear) * tau + p < 0.0:
            low = tau
        else:
            high = tau
    return 0.5 * (low + high) * h


@lean
def knee(fifth, world, p, w, place, drive, s, t, h, x, v, a, y, u, c, edge, x1, k):
    """The step of length in [0, h] that ends with x = edge, which the step h passes; returned as by ``turn``."""
    low, high = 0.0, h
    if s * (x - edge) >= 0.0:
        return 0.0, x, v, a, y, u, c
    # First guess: the parabola through both ends with the velocity at the first.
    bend = (x1 - x - v * h) / (h * h)
    tau = 2.0 * (edge - x) / (v + s * math.sqrt(max(v * v + 4.0 * bend * (edge - x), 0.0)))
    if not low < tau < high:
        tau = h * (edge - x) / (x1 - x)
    for _ in range(_SEARCHES):
        xt, vt, at, yt, ut, ct, _, _ = step_to(fifth, world, p, w, place, drive, s, t, tau, x, v, a, y, u, c, k)
        if s * (xt - edge) < 0.0:
            low = tau
        else:
            high = tau
        new = tau - (xt - edge) / vt if s * vt > 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= _SETTLED * h or high - low <= 1e-15 * h:
            break
        tau = new if low < new < high else 0.5 * (low + high)
    return tau, xt, vt, at, yt, ut, ct


@lean
def _breakaway(world, held, p, w, place, drive, hold, t, h, x, y, u, c, k):
    """Length of the step in (0, h] of a held cart at whose end friction no longer holds it, as it does not after h."""
    low, high = 0.0, h
    yt, ut = y, u
    for _ in range(_SEARCHES):
        tau = 0.5 * (low + high)
        if world[4] > 0.0:
            _, _, _, yt, ut, _, _, _ = step5(held, p, w, place, drive, 0.0, t, tau, x, 0.0, 0.0, y, u, c, k)
        if abs(forces_at(world, p, w, place, drive, 0.0, t + tau, x, 0.0, yt, ut)) > hold:
            high = tau
        else:
            low = tau
        if high - low <= 1e-15 * h:
            break
    return high


@lean
def rest(world, held, p, w, place, drive, restless, t, left, longest, x, y, u, c, tol_x, tol_v, k):
    """One stretch of rest from t on; returns (its length, whether the cart breaks away then, y, u, c, longest).

    Where nothing but the commanded force changes (not ``restless``) the answer is exact for the whole segment.
    """
    hold = laws.breakaway(world[0], p, w, x, place[3] + place[2] * x) if world[0] & laws.DRY_BITS else 0.0
    net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
    if abs(net) > hold:
        return 0.0, True, y, u, c, longest
    if not restless:
        _, _, r, e, decay = drive
        e_now = e * math.exp(-decay * t) if e != 0.0 else 0.0
        wait = first_exit(left, net - e_now, r, e_now, decay, hold)
        return wait, wait < left, y, u, c, longest
    if world[4] == 0.0:
        # Quarters, so that a push that rises above the friction and falls again within a segment is seen.
        for quarter in range(1, 5):
            h = 0.25 * quarter * left
            if abs(forces_at(world, p, w, place, drive, 0.0, t + h, x, 0.0, y, u)) > hold:
                h = _breakaway(world, held, p, w, place, drive, hold, t, h, x, y, u, c, k)
                return h, True, y, u, c, longest
        return left, False, y, u, c, longest
    h = left if left <= longest else left / math.ceil(left / longest)
    while True:
        _, _, _, y1, u1, c1, error_x, error_v = step5(
            held, p, w, place, drive, 0.0, t, h, x, 0.0, 0.0, y, u, c, k
        )  # fmt: skip
        if max(error_x / tol_x, error_v / tol_v) <= 1.0 or not h > 1e-10 * left:
            break
        h *= 0.5
        longest = h
    if abs(forces_at(world, p, w, place, drive, 0.0, t + h, x, 0.0, y1, u1)) > hold:
        h = _breakaway(world, held, p, w, place, drive, hold, t, h, x, y, u, c, k)
        _, _, _, y1, u1, c1, _, _ = step5(held, p, w, place, drive, 0.0, t, h, x, 0.0, 0.0, y, u, c, k)
        return h, True, y1, u1, c1, longest
    return h, False, y1, u1, c1, longest
