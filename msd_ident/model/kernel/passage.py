"""One segment of the general path, from event to event.

It is one step of fourth order where that is accurate enough, else steps of fifth order of even lengths. Names: see
``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import inlined, joined, lean
from msd_ident.model.kernel.events import knee, rest, slowest, turn
from msd_ident.model.kernel.rk import (
    acceleration_at,
    forces_at,
    step5,
    step_to,
)  # fmt: skip
from msd_ident.model.kernel.spring import piece

#: Events in one segment after which the rest of it is passed over: a motion too small to matter.
EVENTS = 200
_SHORTEST = 1e-10
#: Growth, each fifth-order step, of the step that fourth order may take: now and then it is worth another try.
RETRY = 1.02
_NONE, _TURN, _KNEE, _AGAIN = 0, 1, 2, 3


@lean
def _settle(world, p, w, place, drive, t, x, y, u):
    """Direction in which a cart at v = 0 goes on; 0 if dry friction holds it."""
    net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
    hold = laws.breakaway(world[0], p, w, x, place[3] + place[2] * x) if world[0] & laws.DRY_BITS else 0.0
    if abs(net) <= hold:
        return 0.0
    return 1.0 if net > 0.0 else -1.0


@lean
def _leave(world, p, w, place, drive, t, soon, x, y, u):
    """Direction in which a cart breaks away at t: of the force then, or shortly after if it is just 0."""
    net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
    if net == 0.0:
        net = forces_at(world, p, w, place, drive, 0.0, t + soon, x, 0.0, y, u)
    return 1.0 if net > 0.0 else -1.0


@inlined
def calm(s, low, high, a, x1, v1, a1):
    """Whether a step from acceleration a to (x1, v1, a1) went on in direction s without any event."""
    return s * v1 > 0.0 and low <= x1 <= high and (s * a >= 0.0 or s * a1 <= 0.0)


@inlined
def near_turn(left, v, a):
    """Whether the cart turns about within the segment: there a ``quick`` law asks for fifth order."""
    return abs(v) < 2.0 * abs(a) * left


@lean
def place_of(springs, i):
    """(slope, intercept, own slope, own intercept) of piece i of the spring."""
    return springs[0, i], springs[1, i], springs[2, i], springs[3, i]


@lean
def _first_event(fifth, world, p, w, place, drive, s, t, h, low, high, start, end, k):
    """The first event in a step of length h from ``start`` to ``end``, each (x, v, a, y, u, c).

    Returns (event, length, x, v, a, y, u, c) with the state at the event, or at the end of the step without one.
    ``_AGAIN``: the step begins at rest and ends beyond its next turn; a shorter one must be tried.
    """
    x, v, a, y, u, c = start
    x1, v1, a1, y1, u1, c1 = end
    event = _NONE
    if v == 0.0 and not s * v1 > 0.0:
        return _AGAIN, h, x1, v1, a1, y1, u1, c1
    edge = high if s > 0.0 else low
    beyond = s * (x1 - edge) > 0.0
    if s * v1 > 0.0 and s * a < 0.0 and s * a1 > 0.0:
        dip = slowest(h, s * v, s * a, s * v1, s * a1)
        x2, v2, a2, y2, u2, c2, _, _ = step_to(fifth, world, p, w, place, drive, s, t, dip, x, v, a, y, u, c, k)
        if s * v2 <= 0.0:
            h, x1, v1, a1, y1, u1, c1 = dip, x2, v2, a2, y2, u2, c2
            beyond = s * (x1 - edge) > 0.0
    if not (s * v1 > 0.0 or beyond):
        event = _TURN
        h, x1, v1, a1, y1, u1, c1 = turn(fifth, world, p, w, place, drive, s, t, h, x, v, a, y, u, c, v1, a1, k)
        v1 = 0.0
        beyond = s * (x1 - edge) > 0.0
    if beyond:
        event = _KNEE
        h, x1, v1, a1, y1, u1, c1 = knee(fifth, world, p, w, place, drive, s, t, h, x, v, a, y, u, c, edge, x1, k)
        x1 = edge
        if not s * v1 > 0.0:
            v1 = 0.0
    return event, h, x1, v1, a1, y1, u1, c1


@joined
def _attempt(world, p, w, place, drive, s, t, left, fifth, longest5, x, v, a, y, u, c, tolerances, k):
    """A step towards the end of the segment, ``left`` [s] away: (length, error in parts of what is allowed, end)."""
    if fifth:
        h = left if left <= longest5 else left / math.ceil(left / longest5)
        x1, v1, a1, y1, u1, c1, error_x, error_v = step5(world, p, w, place, drive, s, t, h, x, v, a, y, u, c, k)
        return h, max(error_x / tolerances[2], error_v / tolerances[3]), x1, v1, a1, y1, u1, c1
    x1, v1, a1, y1, u1, c1, error_x, error_v = step_to(
        fifth, world, p, w, place, drive, s, t, left, x, v, a, y, u, c, k
    )
    return left, max(error_x / tolerances[0], error_v / tolerances[1]), x1, v1, a1, y1, u1, c1


@joined
def _adapt(fifth, h, error, longest4, longest5):
    """The longest steps that either method may take next."""
    if not error <= 1.0:
        shorter = h * (max(0.2, 0.9 * error**-0.2) if error < 1e12 else 0.2)
        return (longest4, shorter) if fifth else (shorter, longest5)
    if fifth:
        longest4 *= RETRY
        if error < 0.02:
            longest5 = max(longest5, 2.0 * h)
    return longest4, longest5


@joined
def _after(event, world, p, w, edges, springs, drive, s, i, t, x, v, y, u):
    """(direction, piece of the spring, acceleration) after a turn or at a knee."""
    if event == _TURN:
        laws.remember(world[0], p, w, x, s)
        s = _settle(world, p, w, place_of(springs, i), drive, t, x, y, u)
        i = piece(edges, x, s)
    else:
        i += 1 if s > 0.0 else -1
    if s == 0.0:
        return s, i, 0.0
    return s, i, acceleration_at(world, p, w, place_of(springs, i), drive, s, t, x, v, y, u)


@joined
def _stay(world, held, p, w, edges, springs, drive, restless, length, t, longest, x, y, u, c, i, tolerances, k):
    """A stretch of rest: (time when it ends, whether the cart leaves, s, i, a, y, u, c, longest)."""
    left = length - t
    place = place_of(springs, i)
    wait, leaves, y, u, c, longest = rest(
        world, held, p, w, place, drive, restless, t, left, longest, x, y, u, c, tolerances[2], tolerances[3], k
    )
    t = length if wait >= left else t + wait
    if not leaves:
        return t, False, 0.0, i, 0.0, y, u, c, longest
    s = _leave(world, p, w, place, drive, t, 1e-6 * length, x, y, u)
    i = piece(edges, x, s)
    a = acceleration_at(world, p, w, place_of(springs, i), drive, s, t, x, 0.0, y, u)
    return t, True, s, i, a, y, u, c, longest


@lean
def passage(world, held, p, w, edges, springs, drive, length, eventful, restless, quick, state, tolerances, k):
    """The state at the end of one segment; NaN where the motion runs away.

    state: (x, v, a, y, u, c, s, i, longest4, longest5, budget) with i the piece of the spring, the longest steps [s]
    that either method may take now, and the number of steps left. tolerances: of position and velocity for the
    fourth-order step, then for the fifth.
    """
    x, v, a, y, u, c, s, i, longest4, longest5, budget = state
    t, events = 0.0, 0
    while t < length and events <= EVENTS and budget > 0:
        budget -= 1
        if eventful and s == 0.0:
            t, leaves, s, i, a, y, u, c, longest5 = _stay(
                world, held, p, w, edges, springs, drive, restless, length, t, longest5, x, y, u, c, i, tolerances, k
            )
            events += leaves
            continue
        left = length - t
        place = place_of(springs, i)
        fifth = left > longest4 or (quick and near_turn(left, v, a))
        h, error, x1, v1, a1, y1, u1, c1 = _attempt(
            world, p, w, place, drive, s, t, left, fifth, longest5, x, v, a, y, u, c, tolerances, k
        )
        longest4, longest5 = _adapt(fifth, h, error, longest4, longest5)
        if not error <= 1.0:
            if h < _SHORTEST * length:
                budget = 0
            continue
        event = _NONE
        if eventful and not calm(s, edges[i], edges[i + 1], a, x1, v1, a1):
            event, h, x1, v1, a1, y1, u1, c1 = _first_event(
                fifth, world, p, w, place, drive, s, t, h, edges[i], edges[i + 1],
                (x, v, a, y, u, c), (x1, v1, a1, y1, u1, c1), k,
            )  # fmt: skip
            events += event != _NONE
            if event == _AGAIN:
                if h > 1e-6 * length and events < EVENTS:
                    longest4, longest5 = min(longest4, 0.5 * h), 0.5 * h
                    continue
                v1, event = 0.0, _TURN
        x, v, a, y, u, c = x1, v1, a1, y1, u1, c1
        t = length if h >= left else t + h
        if event != _NONE:
            s, i, a = _after(event, world, p, w, edges, springs, drive, s, i, t, x, v, y, u)
            if event == _KNEE:  # beyond it the motion may be slower
                longest4 = 2.0 * length
    if budget <= 0:
        x = math.nan
    return x, v, a, y, u, c, s, i, longest4, longest5, budget
