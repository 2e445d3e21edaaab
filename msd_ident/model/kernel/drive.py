"""The general path's way through the segments of a record."""

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import lean, making
from msd_ident.model.kernel.general import (
    _SHORTEST,
    EVENTS,
    STEPS,
    STEPS_A_SEGMENT,
    _dip,
    _knee,
    _rest,
    _turn,
)  # fmt: skip
from msd_ident.model.kernel.rk import acceleration_at, applied, forces_at, second_acceleration, step, step_to
from msd_ident.model.kernel.spring import piece

#: State: x [m], v [m/s], a [m/s²] of the cart; y, u, c of the second mass; s direction, i piece of the spring,
#: longest [s] the longest step that has been accurate, budget: steps left.


@lean
def _settle(world, p, w, place, drive, t, x, y, u):
    """Direction in which a cart at v = 0 goes on; 0 if dry friction holds it."""
    net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
    hold = laws.breakaway(world[0], p, w, x) if world[0] & laws.DRY_BITS else 0.0
    if abs(net) <= hold:
        return 0.0
    return 1.0 if net > 0.0 else -1.0


@lean
def _place(springs, i):
    """(slope, intercept, own slope, own intercept) of piece i of the spring."""
    return springs[0, i], springs[1, i], springs[2, i], springs[3, i]


@lean
def segment(world, held, p, w, edges, springs, drive, length, eventful, restless, state, tol_x, tol_v):
    """The state at the end of one segment; NaN where the motion runs away."""
    x, v, a, y, u, c, s, i, longest, budget = state
    t, events = 0.0, 0
    place = _place(springs, i)
    while t < length:
        left = length - t
        if eventful and s == 0.0:
            wait, leaves, y, u, c, longest = _rest(
                world, held, p, w, place, drive, restless, t, left, longest, x, y, u, c, tol_x, tol_v
            )
            t = length if wait >= left else t + wait
            budget -= 1
            if leaves:
                events += 1
                net = forces_at(world, p, w, place, drive, 0.0, t, x, 0.0, y, u)
                if net == 0.0:
                    net = forces_at(world, p, w, place, drive, 0.0, t + 1e-6 * length, x, 0.0, y, u)
                s = 1.0 if net > 0.0 else -1.0
                i = piece(edges, x, s)
                place = _place(springs, i)
                a = acceleration_at(world, p, w, place, drive, s, t, x, 0.0, y, u)
            if events > EVENTS or budget < 0:
                break
            continue
        h = left if left <= longest else left / math.ceil(left / longest)
        x1, v1, a1, y1, u1, c1, error_x, error_v = step(world, p, w, place, drive, s, t, h, x, v, a, y, u, c)
        error = max(error_x / tol_x, error_v / tol_v)
        budget -= 1
        if not error <= 1.0:
            longest = h * (max(0.2, 0.9 * error**-0.25) if error < 1e12 else 0.2)
            if h < _SHORTEST * length or budget < 0:
                x = math.nan
                break
            continue
        event = 0
        if eventful:
            if v == 0.0 and not s * v1 > 0.0:
                # A start from rest that ends beyond the next turn: look at its first part alone.
                events += 1
                if h > 1e-6 * length and events < EVENTS:
                    longest = 0.5 * h
                    continue
                v1, event = 0.0, 1
            elif s * v > 0.0 and s * v1 > 0.0 and s * a < 0.0 and s * a1 > 0.0:
                slowest = _dip(h, s * v, s * a, s * v1, s * a1)
                x2, v2, a2, y2, u2, c2, _, _ = step_to(world, p, w, place, drive, s, t, slowest, x, v, a, y, u, c)
                if s * v2 <= 0.0:
                    h, x1, v1, a1, y1, u1, c1 = slowest, x2, v2, a2, y2, u2, c2
            if event == 0 and not s * v1 > 0.0:
                h = _turn(world, p, w, place, drive, s, t, h, x, v, a, y, u, c, v1, a1)
                x1, v1, a1, y1, u1, c1, _, _ = step_to(world, p, w, place, drive, s, t, h, x, v, a, y, u, c)
                v1, event = 0.0, 1
            edge = edges[i + 1] if s > 0.0 else edges[i]
            if s * (x1 - edge) > 0.0:
                h = _knee(world, p, w, place, drive, s, t, h, x, v, a, y, u, c, edge, x1)
                x1, v1, a1, y1, u1, c1, _, _ = step_to(world, p, w, place, drive, s, t, h, x, v, a, y, u, c)
                x1, event = edge, 2
                if not s * v1 > 0.0:
                    v1 = 0.0
        if event == 0 and error < 0.02 and longest < 2.0 * h:
            longest = 2.0 * h
        x, v, a, y, u, c = x1, v1, a1, y1, u1, c1
        t = length if h >= left else t + h
        if event == 1:
            laws.remember(world[0], p, w, x, s)
            s = _settle(world, p, w, place, drive, t, x, y, u)
            i = piece(edges, x, s)
        elif event == 2:
            i += 1 if s > 0.0 else -1
        if event > 0:
            events += 1
            place = _place(springs, i)
            a = acceleration_at(world, p, w, place, drive, s, t, x, v, y, u) if s != 0.0 or not eventful else 0.0
            if events > EVENTS:
                break
    return x, v, a, y, u, c, s, i, longest, budget


@making
def general(active, p, w, m, b, edges, springs, constant, second, start, length, level, slope, transient, decay, x, v, scale, speed, out_x, out_v):
    """Positions (and velocities) at all segment boundaries.

    Args:
        active, p, w: set of effects, parameters, memory.
        edges, springs: knees of the spring and its pieces, see ``spring.characteristic``.
        constant: force [N] against +x.
        second: (m2, k2, b2) of the second mass; m2 = 0 without one.
        start, length: of each segment [s].
        level, slope, transient: force on each, see ``exact``.
        scale, speed: errors [m] and [m/s] that a step may make.
    """
    steep, lagged, keep = slope.size > 0, transient.size > 0, out_v.size > 0
    eventful = (active & (laws.DRY_BITS | laws.TURNING_BITS)) != 0 or edges.size > 2
    restless = (active & laws.UNSTEADY_BITS) != 0 or second[0] > 0.0
    world = (active, m, b, constant, second[0], second[1], second[2])
    held = (active, math.inf, b, constant, second[0], second[1], second[2])
    out_x[0] = x
    if keep:
        out_v[0] = v
    laws.remember(active, p, w, x, 0.0)
    s = (1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)) if eventful else 0.0
    i = piece(edges, x, s)
    before = 0.0
    state = (x, v, 0.0, x, v, 0.0, s, i, length[0], STEPS + STEPS_A_SEGMENT * length.size)
    for j in range(length.size):
        drive = (start[j], level[j], slope[j] if steep else 0.0, transient[j] if lagged else 0.0, decay)
        x, v, a, y, u, c, s, i, longest, budget = state
        begins = applied(drive, 0.0)
        if j == 0:
            if s != 0.0 or not eventful:
                a = acceleration_at(world, p, w, _place(springs, i), drive, s, 0.0, x, v, y, u)
            c = second_acceleration(world, x, v, y, u)
        elif s != 0.0 or not eventful:
            # Position and velocity go on smoothly, so only the force can have jumped.
            a += (begins - before) / m
        state = segment(
            world, held, p, w, edges, springs, drive, length[j], eventful, restless,
            (x, v, a, y, u, c, s, i, longest, budget), scale, speed,
        )  # fmt: skip
        before = applied(drive, length[j])
        out_x[j + 1] = state[0]
        if keep:
            out_v[j + 1] = state[1]
        if not abs(state[0]) < 1e12 * scale:
            out_x[j + 1 :] = math.nan
            out_v[j + 1 :] = math.nan
            break
