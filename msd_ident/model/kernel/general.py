"""The general path: any smooth law, integrated step by step between located events.

Events are the turning of the motion (v = 0), the knees of the spring, and the instant at which a cart at rest breaks
away. A step that passes one is repeated with another length until it ends on it.
"""

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.rk import forces_at, step_to
from msd_ident.model.kernel.roots import first_exit

#: Estimated error of a step, relative to the scales of position and velocity. The estimate is of third order; the
#: step itself, of fourth, is better by about the step in radians.
TOLERANCE = 2e-8
#: Events in one segment after which the rest of it is passed over: a motion too small to matter.
EVENTS = 200
#: Steps that a run may take: so many a segment, and so many on top. Beyond, the motion is given up as NaN.
STEPS_A_SEGMENT, STEPS = 400, 200_000
_SHORTEST = 1e-10


@lean
def _turn(world, p, w, place, drive, s, t, h, x, v, a, y, u, c, v1, a1):
    """Length of the step in (0, h] that ends with v = 0, given the end (v1, a1) of the step h beyond it."""
    low, high = 0.0, h
    tau = _hermite_root(h, s * v, s * a, s * v1, s * a1)
    for _ in range(60):
        _, vt, at, _, _, _, _, _ = step_to(world, p, w, place, drive, s, t, tau, x, v, a, y, u, c)
        if s * vt > 0.0:
            low = tau
        else:
            high = tau
        new = tau - vt / at if s * at < 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= 1e-9 * h or high - low <= 1e-15 * h:
            return min(max(new, 0.0), h)
        tau = new if low < new < high else 0.5 * (low + high)
    return tau


@lean
def _hermite_root(h, v0, a0, v1, a1):
    """Guess of the root of v in (0, h], v0 > 0 > v1, on the cubic through both ends with their slopes."""
    tau = v0 / (v0 - v1) if v0 > v1 else 0.5
    p, q = a0 * h, a1 * h
    for _ in range(3):
        rest = 1.0 - tau
        value = v0 * (1.0 + 2.0 * tau) * rest * rest + p * tau * rest * rest
        value += v1 * tau * tau * (3.0 - 2.0 * tau) - q * tau * tau * rest
        slope = 6.0 * (v1 - v0) * tau * rest + p * rest * (1.0 - 3.0 * tau) + q * tau * (3.0 * tau - 2.0)
        if not slope < 0.0:
            break
        tau = min(max(tau - value / slope, 0.0), 1.0)
    return tau * h if 0.0 < tau < 1.0 else 0.5 * h


@lean
def _dip(h, v0, a0, v1, a1):
    """Time in (0, h) of the slowest motion when it slows down and speeds up again, on the same cubic."""
    p, q = a0 * h, a1 * h
    # v'(tau) = A tau² + B tau + p on the unit interval, with v'(0) < 0 < v'(1).
    big, mid = 3.0 * (p + q) + 6.0 * (v0 - v1), -4.0 * p - 2.0 * q - 6.0 * (v0 - v1)
    low, high = 0.0, 1.0
    for _ in range(20):
        tau = 0.5 * (low + high)
        if (big * tau + mid) * tau + p < 0.0:
            low = tau
        else:
            high = tau
    return 0.5 * (low + high) * h


@lean
def _knee(world, p, w, place, drive, s, t, h, x, v, a, y, u, c, edge, x1):
    """Length of the step in [0, h] that ends with x = edge, which the step h passes."""
    low, high = 0.0, h
    if s * (x - edge) >= 0.0:
        return 0.0
    tau = h * (edge - x) / (x1 - x)
    for _ in range(60):
        xt, vt, _, _, _, _, _, _ = step_to(world, p, w, place, drive, s, t, tau, x, v, a, y, u, c)
        if s * (xt - edge) < 0.0:
            low = tau
        else:
            high = tau
        new = tau - (xt - edge) / vt if s * vt > 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= 1e-9 * h or high - low <= 1e-15 * h:
            return min(max(new, 0.0), h)
        tau = new if low < new < high else 0.5 * (low + high)
    return tau


@lean
def _breakaway(world, held, p, w, place, drive, hold, t, h, x, y, u, c):
    """Length of the step in (0, h] of a held cart after which it no longer holds, which it does not after h."""
    low, high = 0.0, h
    for _ in range(60):
        tau = 0.5 * (low + high)
        _, _, _, yt, ut, _, _, _ = step_to(held, p, w, place, drive, 0.0, t, tau, x, 0.0, 0.0, y, u, c)
        if abs(forces_at(world, p, w, place, drive, 0.0, t + tau, x, 0.0, yt, ut)) > hold:
            high = tau
        else:
            low = tau
        if high - low <= 1e-15 * h:
            break
    return high


@lean
def _rest(world, held, p, w, place, drive, restless, t, left, longest, x, y, u, c, tol_x, tol_v):
    """One stretch of rest from t on; returns (its length, whether the cart breaks away then, y, u, c, longest)."""
    hold = laws.breakaway(world[0], p, w, x)
    net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
    if abs(net) > hold:
        return 0.0, True, y, u, c, longest
    if not restless:
        start, f, r, e, decay = drive
        e_now = e * math.exp(-decay * t) if e != 0.0 else 0.0
        wait = first_exit(left, net - e_now, r, e_now, decay, hold)
        return wait, wait < left, y, u, c, longest
    h = min(0.25 * left if left > 0.5 * longest else left, longest)
    while True:
        _, _, _, y1, u1, c1, error_x, error_v = step_to(held, p, w, place, drive, 0.0, t, h, x, 0.0, 0.0, y, u, c)
        error = max(error_x / tol_x, error_v / tol_v)
        if error <= 1.0 or not h > _SHORTEST * left:
            break
        h *= 0.5
        longest = h
    if abs(forces_at(world, p, w, place, drive, 0.0, t + h, x, 0.0, y1, u1)) > hold:
        h = _breakaway(world, held, p, w, place, drive, hold, t, h, x, y, u, c)
        _, _, _, y1, u1, c1, _, _ = step_to(held, p, w, place, drive, 0.0, t, h, x, 0.0, 0.0, y, u, c)
        return h, True, y1, u1, c1, longest
    return h, False, y1, u1, c1, longest
