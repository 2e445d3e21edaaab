"""Where the smooth motion of the general path ends: turns, knees of the spring, breaking away from rest.

A step that passes an event is repeated with another length until it ends next to it; the last small way is that of a
parabola. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel.compiled import inlined, lean
from msd_ident.model.kernel.exponential import second_is_stiff
from msd_ident.model.kernel.groups import Line, Place, State, Step
from msd_ident.model.kernel.methods import EXPONENTIAL, FIFTH, step_to
from msd_ident.model.kernel.rk import breakaway, forces_at, grip_at, held
from msd_ident.model.kernel.roots import first_exit

_SEARCHES = 60
#: Error, in parts of what is allowed, below which the next step of fifth order may be twice as long.
EASY = 0.02
#: Length known to this part of the step is known well enough: far below the error of the step itself.
_SETTLED = 1e-8
#: Correction by Newton's method, in parts of the step, that leaves an error of about its square: no step is made anew.
_NEARLY = 1e-5


@lean
def turn(phase, step):
    """The step that ends with v = 0, where the one given ends beyond that.

    Returns (length, state), v up to what is left of the search.
    """
    method, t, h, start, end = step
    s = phase.s
    low, high = 0.0, h
    tau = _cubic_root(h, s * start.v, s * start.a, s * end.v, s * end.a)
    for _ in range(_SEARCHES):
        there, _, _ = step_to(method, phase, t, tau, start)
        if s * there.v > 0.0:
            low = tau
        else:
            high = tau
        new = tau - there.v / there.a if s * there.a < 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= _SETTLED * h or high - low <= 1e-15 * h:
            break
        if abs(new - tau) <= _NEARLY * h and 0.0 < new < h and s * there.a < 0.0:
            return new, _shifted(new - tau, there)
        tau = new if low < new < high else 0.5 * (low + high)
    return tau, there


@inlined
def _shifted(h, state):
    """The state a time h later, or before if h < 0, so short that the accelerations are still those of the state."""
    x, v, a, y, u, c = state
    return State(x + h * (v + 0.5 * h * a), v + h * a, a, y + h * (u + 0.5 * h * c), u + h * c, c)


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
def knee(phase, step, edge):
    """The step that ends with x = edge, which the one given passes; returned as by ``turn``."""
    method, t, h, start, end = step
    s, x, v = phase.s, start.x, start.v
    low, high = 0.0, h
    if s * (x - edge) >= 0.0:
        return 0.0, start
    # First guess: the parabola through both ends with the velocity at the first.
    bend = (end.x - x - v * h) / (h * h)
    tau = 2.0 * (edge - x) / (v + s * math.sqrt(max(v * v + 4.0 * bend * (edge - x), 0.0)))
    if not low < tau < high:
        tau = h * (edge - x) / (end.x - x)
    for _ in range(_SEARCHES):
        there, _, _ = step_to(method, phase, t, tau, start)
        if s * (there.x - edge) < 0.0:
            low = tau
        else:
            high = tau
        new = tau - (there.x - edge) / there.v if s * there.v > 0.0 else 0.5 * (low + high)
        if abs(new - tau) <= _SETTLED * h or high - low <= 1e-15 * h:
            break
        if abs(new - tau) <= _NEARLY * h and 0.0 < new < h and s * there.v > 0.0:
            return new, _shifted(new - tau, there)
        tau = new if low < new < high else 0.5 * (low + high)
    return tau, there


@lean
def release(phase, step):
    """The step that ends just beyond a change of sign of ``grip_at``, which the one given passes; see ``turn``."""
    method, t, h, start, end = step
    low, high = 0.0, h
    before = grip_at(phase, t, Place(start.x, start.v, start.y, start.u))
    after = grip_at(phase, t + h, Place(end.x, end.v, end.y, end.u))
    grips, side = before > 0.0, 0
    for _ in range(_SEARCHES):  # false position, with the value halved of an end that stays (Illinois)
        if high - low <= _SETTLED * h:
            break
        tau = low + (high - low) * before / (before - after)
        tau = min(max(tau, low + 0.4 * _SETTLED * h), high - 0.4 * _SETTLED * h)
        there, _, _ = step_to(method, phase, t, tau, start)
        value = grip_at(phase, t + tau, Place(there.x, there.v, there.y, there.u))
        if (value > 0.0) == grips:
            low, before, after, side = tau, value, 0.5 * after if side == 1 else after, 1
        else:
            high, end, after, before, side = tau, there, value, 0.5 * before if side == -1 else before, -1
    return high, end


@inlined
def _freed(phase, t, place):
    """Whether dry friction no longer holds a cart at rest there."""
    return abs(forces_at(phase, t, place)) > breakaway(phase, t, place.x)


@lean
def _breakaway(phase, step):
    """Length of a held cart's step in (0, h] at whose end friction no longer holds it, as it does not after h."""
    method, t, h, start, _ = step
    low, high = 0.0, h
    x, y, u = start.x, start.y, start.u
    for _ in range(_SEARCHES):
        tau = 0.5 * (low + high)
        if phase.world.cart.m2 > 0.0:
            there, _, _ = step_to(method, held(phase), t, tau, start)
            y, u = there.y, there.u
        if _freed(phase, t + tau, Place(x, 0.0, y, u)):
            high = tau
        else:
            low = tau
        if high - low <= 1e-15 * h:
            break
    return high


@lean
def rest(run, phase, t, longest, start):
    """One stretch of rest from t on; returns (its length, whether the cart breaks away then, state, longest).

    Where nothing but the commanded force changes (not ``restless``) the answer is exact for the whole segment.
    ``longest``: the longest step [s] that the second mass may take.
    """
    x, y, u = start.x, start.y, start.u
    start = State(x, 0.0, 0.0, y, u, start.c)
    left = phase.length - t
    hold = breakaway(phase, t, x)
    net = forces_at(phase, t, Place(x, 0.0, y, u))
    if abs(net) > hold:
        return 0.0, True, start, longest
    if not run.restless:
        _, _, r, e, decay = phase.drive
        e_now = e * math.exp(-decay * t) if e != 0.0 else 0.0
        wait = first_exit(left, Line(net - e_now, r, e_now, decay), hold)
        return wait, wait < left, start, longest
    if phase.world.cart.m2 == 0.0:
        # Quarters, so that a push that rises above the friction and falls again within a segment is seen.
        for quarter in range(1, 5):
            h = 0.25 * quarter * left
            if _freed(phase, t + h, Place(x, 0.0, y, u)):
                return _breakaway(phase, Step(FIFTH, t, h, start, start)), True, start, longest
        return left, False, start, longest
    h = left if left <= longest else left / math.ceil(left / longest)
    while True:
        method = EXPONENTIAL if second_is_stiff(phase, h, start) else FIFTH
        end, error_x, error_v = step_to(method, held(phase), t, h, start)
        error = max(error_x / run.tolerances.x5, error_v / run.tolerances.v5)
        if error <= 1.0 or not h > 1e-10 * left:
            break
        h *= 0.5
        longest = h
    if error < EASY:
        longest = max(longest, 2.0 * h)
    if _freed(phase, t + h, Place(x, 0.0, end.y, end.u)):
        h = _breakaway(phase, Step(method, t, h, start, end))
        end, _, _ = step_to(method, held(phase), t, h, start)
        return h, True, end, longest
    return h, False, end, longest
