"""The exact path: the plant is linear between events, and the events are located.

Between events (v = 0, a knee of the spring) the motion is propagated by the precomputed matrix of the segment's
length; a segment with an event in it is walked by Taylor series from event to event.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel import linear
from msd_ident.model.kernel.compiled import give_up, joined, lean, making
from msd_ident.model.kernel.roots import fall_through, first_exit, first_turn
from msd_ident.model.kernel.spring import piece

#: Events in one segment after which the rest of it is passed over: a motion too small to matter.
EVENTS = 200
#: Rate of the plant times length of a segment beyond which it is not walked by series.
STIFF = 300.0


@lean
def glide_held(j, x, v, s, low, high, b, k, load, table, kind, level, out_x, out_v):
    """Propagate segment after segment while nothing happens; returns (j, x, v) before the first with an event.

    For a force that is constant on each segment. ``s`` is the direction of motion (0: none to keep, no event at v = 0),
    ``load`` [N] the constant force against +x, ``table`` the propagators of each kind of segment.
    """
    keep = out_v.size > 0
    while j < kind.size:
        n = kind[j]
        if n < 0:
            break
        xx, xv, xf, vx, vv, vf = table[n, 0], table[n, 1], table[n, 2], table[n, 5], table[n, 6], table[n, 7]
        begun = j
        while j < kind.size and kind[j] == n:
            f = level[j] - load
            x1 = xx * x + (xv * v + xf * f)
            v1 = vx * x + (vv * v + vf * f)
            if s != 0:
                if not (s * v1 > 0.0 and x1 >= low and x1 <= high):
                    return j, x, v
                if s * (f - k * x - b * v) < 0.0 and s * (f - k * x1 - b * v1) > 0.0:
                    # Slower, then faster: it may have stopped in between.
                    return j, x, v
            x, v = x1, v1
            j += 1
            out_x[j] = x
            if keep:
                out_v[j] = v
        if j == begun:
            break
    return j, x, v


@lean
def glide(j, x, v, s, low, high, m, b, k, load, table, kind, level, slope, transient, out_x, out_v):
    """The same for a force that changes during a segment."""
    steep, lagged, keep = slope.size > 0, transient.size > 0, out_v.size > 0
    while j < kind.size:
        n = kind[j]
        if n < 0:
            break
        f, r, e = level[j] - load, slope[j] if steep else 0.0, transient[j] if lagged else 0.0
        x1, v1 = linear.propagate(table[n], x, v, f, r, e)
        if s != 0:
            if not (s * v1 > 0.0 and x1 >= low and x1 <= high):
                break
            push, push1 = abs(f - k * x - b * v), abs(f - k * x1 - b * v1)
            if s * v1 < (push + push1 + abs(e)) * table[n, 1] / m:
                # So slow that it may have stopped in between.
                break
        x, v = x1, v1
        j += 1
        out_x[j] = x
        if keep:
            out_v[j] = v
    return j, x, v


@lean
def rest(j, x, spring, hold, length, level, slope, transient, out_x, out_v):
    """Stay at rest while the force lets it; returns the first segment in which the cart leaves."""
    steep, lagged, keep = slope.size > 0, transient.size > 0, out_v.size > 0
    while j < level.size:
        net = level[j] - spring
        if steep or lagged:
            rise = slope[j] if steep else 0.0
            fade = transient[j] if lagged else 0.0
            if not abs(net) + abs(rise) * length[j] + abs(fade) <= hold:
                break
        elif not abs(net) <= hold:
            break
        j += 1
        out_x[j] = x
        if keep:
            out_v[j] = 0.0
    return j


@lean
def _way_out(wait, net, r, e, rate):
    """Direction in which a cart leaves that was held for ``wait`` [s]; ``net`` [N] is the force when the wait began.

    After a wait, the force has left what friction holds on the side that it moves to.
    """
    if wait > 0.0 or net == 0.0:
        net = r - e * rate * math.exp(-rate * wait)
    return 1 if net > 0.0 else -1


@lean
def walk(h, x, v, s, i, plant, edges, springs, intercepts, f, r, e, decay, c):
    """One segment of length h [s] from event to event; returns (x, v, s, i, time left).

    ``s``: direction of motion, 0 at rest. ``i``: piece of the spring. ``plant``: (m, b, constant, kinetic, hold), see
    ``exact``. ``c``: room for a series. Time is left over where the plant is so stiff that a series would take too many
    pieces.
    """
    m, b, constant, kinetic, hold = plant
    t = 0.0
    for _ in range(EVENTS):
        left = h - t
        if not left > 0.0:
            break
        f_now, e_now = f + r * t, e * math.exp(-decay * t) if e != 0.0 else 0.0
        if abs(e_now) < 1e-18 * abs(f_now):
            e_now = 0.0
        rate = decay if e_now != 0.0 else 0.0
        if s == 0:
            net = f_now - constant - intercepts[i] - springs[i] * x
            wait = first_exit(left, net, r, e_now, rate, hold)
            t += wait
            if wait >= left:
                break
            s = _way_out(wait, net + e_now, r, e_now, rate)
            i = piece(edges, x, s)
            continue
        k = springs[i]
        fastest = linear.fastest_rate(m, b, k)
        if fastest * left > STIFF:
            return x, v, s, i, left
        fastest = max(fastest, rate)
        d = min(left, linear.LONGEST / fastest)
        terms = linear.terms_for(fastest * d)
        linear.series(c, terms, m, b, k, x, v, f_now - constant - intercepts[i] - s * kinetic, r, e_now, rate)
        turn = first_turn(c, terms, d, s, v, r != 0.0 or e_now != 0.0)
        until = min(turn, d)
        edge = edges[i + 1] if s > 0 else edges[i]
        x1 = linear.position(c, terms, until)
        if s * (x1 - edge) > 0.0:
            until = fall_through(c, terms, until, edge, s)
            x, v = edge, linear.velocity(c, terms, until)
            if s * v <= 0.0:
                v = 0.0
            i += s
            t += until
        else:
            x, v = x1, 0.0
            t = h if until >= left else t + until
            if turn > d:
                v = linear.velocity(c, terms, until)
            else:
                net = f + r * t - constant - intercepts[i] - springs[i] * x
                if e != 0.0:
                    net += e * math.exp(-decay * t)
                s = 0 if abs(net) <= hold else (1 if net > 0.0 else -1)
                i = piece(edges, x, s)
        if not abs(x) < math.inf:
            break
    return x, v, s, i, 0.0


@lean
def drift(h, x, v, m, b, k, f, r, e, decay, c):
    """One segment without events; returns (x, v, time left), the latter as ``walk`` does."""
    t = 0.0
    plant = linear.fastest_rate(m, b, k)
    while t < h:
        left = h - t
        if plant * left > STIFF:
            return x, v, left
        e_now = e * math.exp(-decay * t)
        if abs(e_now) < 1e-18 * abs(f):
            e_now = 0.0
        rate = decay if e_now != 0.0 else 0.0
        fastest = max(plant, rate)
        d = min(left, linear.LONGEST / fastest)
        terms = linear.terms_for(fastest * d)
        linear.series(c, terms, m, b, k, x, v, f + r * t, r, e_now, rate)
        x, v = linear.position(c, terms, d), linear.velocity(c, terms, d)
        t = h if d >= left else t + d
    return x, v, 0.0


@joined
def _leap(left, h, x, v, m, b, k, level, r, e, decay, c):
    """The rest of a segment of a plant too stiff to be walked, by its own matrix and without events: (x, v, s)."""
    begun = h - left
    row = c[linear.TERMS :]
    linear.propagator(row, m, b, k, left, decay, c)
    x, v = linear.propagate(row, x, v, level + r * begun, r, e * math.exp(-decay * begun))
    return x, v, 1 if v > 0.0 else (-1 if v < 0.0 else 0)


@joined
def _through(h, x, v, s, i, plant, eventful, edges, springs, intercepts, f, r, e, decay, c):
    """(x, v, s, i) after one segment that the matrices do not carry: with an event in it, or of an odd length."""
    m, b, constant, kinetic, _ = plant
    if eventful:
        x, v, s, i, left = walk(h, x, v, s, i, plant, edges, springs, intercepts, f, r, e, decay, c)
    else:
        x, v, left = drift(h, x, v, m, b, springs[i], f - constant, r, e, decay, c)
    if left > 0.0:
        net = f - constant - intercepts[i] - s * kinetic
        x, v, s = _leap(left, h, x, v, m, b, springs[i], net, r, e, decay, c)
    return x, v, s, i


@making
def exact(plant, edges, springs, intercepts, length, kind, lengths, level, slope, transient, decay, x, v, out_x, out_v):
    """Positions (and velocities) at all segment boundaries.

    Args:
        plant: (m, b, constant, kinetic, hold): ``constant`` force [N] against +x, dry friction [N] while sliding and
            the most that it holds at rest.
        edges, springs, intercepts: the spring, see ``spring.characteristic``.
        length, kind, lengths: segments, see ``segments.merge``.
        level, slope, transient, decay: force on each, level + slope t + transient exp(-decay t); the two in the middle
            may be empty.
    """
    m, b, constant, kinetic, hold = plant
    steep, lagged, keep = slope.size > 0, transient.size > 0, out_v.size > 0
    eventful = kinetic > 0.0 or hold > 0.0 or edges.size > 2
    table = np.empty((springs.size, lengths.size, 10))
    ready = np.zeros(springs.size, np.bool_)
    c = np.empty(linear.TERMS + 10)
    out_x[0] = x
    if keep:
        out_v[0] = v
    s = 1 if v > 0.0 else (-1 if v < 0.0 else 0)
    i = piece(edges, x, s)
    j = 0 * length.size  # not the constant 0, for which numba would compile all that takes j once more
    while True:
        k, load = springs[i], constant + intercepts[i]
        if s == 0 and eventful:
            j = rest(j, x, load + k * x, hold, length, level, slope, transient, out_x, out_v)
        else:
            if not ready[i]:
                for n in range(lengths.size):
                    linear.propagator(table[i, n], m, b, k, lengths[n], decay, c)
                ready[i] = True
            way, low, high = s if eventful else 0, edges[i], edges[i + 1]
            load += s * kinetic
            if steep or lagged:
                j, x, v = glide(
                    j, x, v, way, low, high, m, b, k, load, table[i], kind, level, slope, transient, out_x, out_v
                )
            else:
                j, x, v = glide_held(j, x, v, way, low, high, b, k, load, table[i], kind, level, out_x, out_v)
        if j == length.size:
            break
        r, e = slope[j] if steep else 0.0, transient[j] if lagged else 0.0
        x, v, s, i = _through(
            length[j], x, v, s, i, plant, eventful, edges, springs, intercepts, level[j], r, e, decay, c
        )
        j += 1
        out_x[j] = x
        if keep:
            out_v[j] = v
        if not abs(x) < math.inf:
            give_up(out_x, j)
            give_up(out_v, j)
            break
