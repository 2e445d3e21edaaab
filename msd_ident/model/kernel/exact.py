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
from msd_ident.model.kernel.compiled import give_up, inlined, joined, lean, making
from msd_ident.model.kernel.groups import Glide, Going, Line, Linear, Motion, Slide
from msd_ident.model.kernel.roots import first_exit
from msd_ident.model.kernel.slide import CROSSED, SEVERAL, STIFF, TURNED, UNKNOWN, by_matrix, by_series
from msd_ident.model.kernel.spring import piece

#: Events in one segment after which the rest of it is passed over: a motion too small to matter.
EVENTS = 200
#: Phase [rad] of the free motion within which a velocity of one sign at both ends was never zero: less than half a turn
#: under a constant force; under a ramp its acceleration is no more than those at both ends together up to 2 pi / 3.
ONE_TURN = 2.0


@lean
def glide_held(j, motion, stretch, segments, path):
    """Propagate segment after segment while nothing happens; returns (j, motion) before the first with an event.

    For a force that is constant on each segment.
    """
    x, v = motion
    s, low, high, plant, load, table = stretch
    _, b, k = plant
    kind, level = segments.kind, segments.level
    keep = path.v.size > 0
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
                    return j, Motion(x, v)
                if s * (f - k * x - b * v) < 0.0 and s * (f - k * x1 - b * v1) > 0.0:
                    # Slower, then faster: it may have stopped in between.
                    return j, Motion(x, v)
            x, v = x1, v1
            j += 1
            path.x[j] = x
            if keep:
                path.v[j] = v
        if j == begun:
            break
    return j, Motion(x, v)


@lean
def glide(j, motion, stretch, segments, path):
    """The same for a force that changes during a segment."""
    x, v = motion
    s, low, high, plant, load, table = stretch
    m, b, k = plant
    kind = segments.kind
    keep = path.v.size > 0
    while j < kind.size:
        n = kind[j]
        if n < 0:
            break
        line = _line(segments, j, load)
        f, _, e, _ = line
        x1, v1 = linear.propagate(table[n], Motion(x, v), line)
        if s != 0:
            if not (s * v1 > 0.0 and x1 >= low and x1 <= high):
                break
            push, push1 = abs(f - k * x - b * v), abs(f - k * x1 - b * v1)
            if s * v1 < (push + push1 + abs(e)) * table[n, 1] / m:
                # So slow that it may have stopped in between.
                break
        x, v = x1, v1
        j += 1
        path.x[j] = x
        if keep:
            path.v[j] = v
    return j, Motion(x, v)


@inlined
def _line(segments, j, load):
    """Force on segment j less a constant ``load`` [N]."""
    rise = segments.slope[j] if segments.slope.size > 0 else 0.0
    fade = segments.transient[j] if segments.transient.size > 0 else 0.0
    return Line(segments.level[j] - load, rise, fade, segments.decay)


@lean
def rest(j, going, axis, segments, path):
    """Stay at rest while the force lets it; returns the first segment in which the cart leaves."""
    length, level, slope, transient = segments.length, segments.level, segments.slope, segments.transient
    steep, lagged, keep = slope.size > 0, transient.size > 0, path.v.size > 0
    x, _, _, i = going
    balance = axis.constant + axis.spring.lines[1, i] + axis.spring.lines[0, i] * x
    while j < level.size:
        net = level[j] - balance
        if steep or lagged:
            rise = slope[j] if steep else 0.0
            fade = transient[j] if lagged else 0.0
            if not abs(net) + abs(rise) * length[j] + abs(fade) <= axis.hold:
                break
        elif not abs(net) <= axis.hold:
            break
        j += 1
        path.x[j] = x
        if keep:
            path.v[j] = 0.0
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
def _settle(x, t, i, axis, line):
    """(direction, piece of the spring) in which a cart goes on that comes to rest at x, t after the segment began."""
    net = line.f + line.r * t - axis.constant - axis.spring.lines[1, i] - axis.spring.lines[0, i] * x
    if line.e != 0.0:
        net += line.e * math.exp(-line.decay * t)
    s = 0 if abs(net) <= axis.hold else (1 if net > 0.0 else -1)
    return s, piece(axis.spring.edges, x, s)


@lean
def walk(h, going, axis, line, c):
    """One segment of length h [s] under the force ``line``, from event to event; ``c``: room for a series.

    Returns (where it is going then, time left), the latter where a series would take too many pieces: a stiff plant.
    """
    x, v, s, i = going
    m, b, constant, kinetic, hold, spring, _ = axis
    edges, springs, intercepts = spring.edges, spring.lines[0], spring.lines[1]
    f, r, e, decay = line
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
            wait = first_exit(left, Line(net, r, e_now, rate), hold)
            t += wait
            if wait >= left:
                break
            s = _way_out(wait, net + e_now, r, e_now, rate)
            i = piece(edges, x, s)
            continue
        plant, motion = Linear(m, b, springs[i]), Motion(x, v)
        push = Line(f_now - constant - intercepts[i] - s * kinetic, r, e_now, rate)
        slide = Slide(s, edges[i], edges[i + 1], plant, motion, push)
        event, until, there = UNKNOWN, left, motion
        reach = linear.fastest_rate(plant) * left
        if reach > SEVERAL:
            event, until, there = by_matrix(slide, left, c)
        if event == UNKNOWN:
            if reach > STIFF:
                return Going(x, v, s, i), left
            event, until, there = by_series(slide, left, c)
        t = h if until >= left else t + until
        x, v = there
        if event == CROSSED:
            x, v = edges[i + 1] if s > 0 else edges[i], v if s * v > 0.0 else 0.0
            i += s
        elif event == TURNED:
            v = 0.0
            s, i = _settle(x, t, i, axis, line)
        if not abs(x) < math.inf:
            break
    return Going(x, v, s, i), 0.0


@lean
def drift(h, motion, plant, line, c):
    """One segment without events; returns (motion, time left), the latter as ``walk`` does."""
    f, r, e, decay = line
    t = 0.0
    own = linear.fastest_rate(plant)
    while t < h:
        left = h - t
        if own * left > SEVERAL:
            return motion, left
        e_now = e * math.exp(-decay * t)
        if abs(e_now) < 1e-18 * abs(f):
            e_now = 0.0
        rate = decay if e_now != 0.0 else 0.0
        fastest = max(own, rate)
        d = min(left, linear.LONGEST / fastest)
        terms = linear.terms_for(fastest * d)
        series = linear.series(c, terms, plant, motion, Line(f + r * t, r, e_now, rate))
        motion = Motion(linear.position(series, d), linear.velocity(series, d))
        t = h if d >= left else t + d
    return motion, 0.0


@joined
def _leap(left, motion, plant, line, c):
    """The rest of a segment of a plant too stiff to be walked, by its own matrix and without events."""
    row = c[linear.TERMS :]
    linear.propagator(row, plant, left, line.decay, c)
    return linear.propagate(row, motion, line)


@joined
def _through(h, going, axis, line, c):
    """Where the motion goes after one segment that the matrices do not carry: with an event in it, or of odd length."""
    if axis.eventful:
        going, left = walk(h, going, axis, line, c)
    else:
        plant = Linear(axis.m, axis.b, axis.spring.lines[0, going.i])
        push = Line(line.f - axis.constant, line.r, line.e, line.decay)
        motion, left = drift(h, Motion(going.x, going.v), plant, push, c)
        going = Going(motion.x, motion.v, going.s, going.i)
    if left > 0.0:
        x, v, s, i = going
        plant, begun = Linear(axis.m, axis.b, axis.spring.lines[0, i]), h - left
        net = line.f - axis.constant - axis.spring.lines[1, i] - s * axis.kinetic
        rest_of_it = Line(net + line.r * begun, line.r, line.e * math.exp(-line.decay * begun), line.decay)
        x, v = _leap(left, Motion(x, v), plant, rest_of_it, c)
        going = Going(x, v, 1 if v > 0.0 else (-1 if v < 0.0 else 0), i)
    return going


@joined
def _stretch(going, axis, table):
    """The stretch without events that the motion is on; ``table``: propagators of its piece of the spring."""
    _, _, s, i = going
    edges, springs = axis.spring
    plant = Linear(axis.m, axis.b, springs[0, i])
    load = axis.constant + springs[1, i] + s * axis.kinetic
    return Glide(s if axis.eventful else 0, edges[i], edges[i + 1], plant, load, table)


@lean
def longest_glide(axis):
    """Longest segment [s] in which the velocity is zero once at most, on the softest piece of the spring.

    In a hard stop a cart turns within any sample; there it is the edge of the piece that ends a glide.
    """
    softest = math.inf
    for k in axis.spring.lines[0]:
        if k > 0.0:
            softest = min(softest, k)
    swing = softest / axis.m - (0.5 * axis.b / axis.m) ** 2
    return ONE_TURN / math.sqrt(swing) if 0.0 < swing < math.inf else math.inf


@making
def exact(axis, segments, motion, path):
    """Positions (and velocities) at all segment boundaries, from ``motion`` on."""
    springs, lengths = axis.spring.lines[0], segments.lengths
    table = np.empty((springs.size, lengths.size, 10))
    ready = np.zeros(springs.size, np.bool_)
    c = np.empty(linear.TERMS + 10)
    path.x[0] = motion.x
    if path.v.size > 0:
        path.v[0] = motion.v
    s = 1 if motion.v > 0.0 else (-1 if motion.v < 0.0 else 0)
    going = Going(motion.x, motion.v, s, piece(axis.spring.edges, motion.x, s))
    j = 0 * segments.length.size  # not the constant 0, for which numba would compile all that takes j once more
    while True:
        if going.s == 0 and axis.eventful:
            j = rest(j, going, axis, segments, path)
        else:
            if not ready[going.i]:
                plant = Linear(axis.m, axis.b, springs[going.i])
                for n in range(lengths.size):
                    linear.propagator(table[going.i, n], plant, lengths[n], segments.decay, c)
                ready[going.i] = True
            stretch = _stretch(going, axis, table[going.i])
            if segments.slope.size > 0 or segments.transient.size > 0:
                j, motion = glide(j, Motion(going.x, going.v), stretch, segments, path)
            else:
                j, motion = glide_held(j, Motion(going.x, going.v), stretch, segments, path)
            going = Going(motion.x, motion.v, going.s, going.i)
        if j == segments.length.size:
            break
        going = _through(segments.length[j], going, axis, _line(segments, j, 0.0), c)
        j += 1
        path.x[j] = going.x
        if path.v.size > 0:
            path.v[j] = going.v
        if not abs(going.x) < math.inf:
            give_up(path.x, j)
            give_up(path.v, j)
            break
