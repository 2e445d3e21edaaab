"""The next event of a motion on the exact path: a turn, the edge of a piece of the spring, or none.

By a Taylor series, or by a matrix of its own where damping stops the mass within a part of the segment.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import linear
from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.groups import Motion
from msd_ident.model.kernel.roots import fall_through, first_turn

#: Rate of the plant times length of a segment beyond which it is not walked by series.
STIFF = 300.0
#: The same beyond which a matrix of its own takes less time than the pieces of a series.
SEVERAL = 8.0
NONE, TURNED, CROSSED, UNKNOWN, _SLOWEST = 0, 1, 2, 3, 4


@lean
def _net(slide, motion, t):
    """Force [N] on the mass of a slide, a time t [s] after it began, in its direction."""
    _, b, k = slide.plant
    f, r, e, decay = slide.line
    push = f + r * t
    if e != 0.0:
        push += e * math.exp(-decay * t)
    return slide.s * (push - k * motion.x - b * motion.v)


@lean
def _leapt(slide, t, c):
    """Motion after a time t [s], by a matrix of its own."""
    row = c[linear.TERMS :]
    linear.propagator(row, slide.plant, t, slide.line.decay, c)
    return linear.propagate(row, slide.motion, slide.line)


@lean
def _halved(event, slide, until, c):
    """(time, motion) of the first instant at which it is there: the slowest of a dip, v = 0, or the edge."""
    s, begun, shortest = slide.s, 0.0, 1e-14 * until
    edge, there = slide.high if s > 0 else slide.low, _leapt(slide, until, c)
    while until - begun > shortest:
        middle = 0.5 * (begun + until)
        now = _leapt(slide, middle, c)
        if event == _SLOWEST:
            reached = _net(slide, now, middle) >= 0.0
        elif event == TURNED:
            reached = s * now.v <= 0.0
        else:
            reached = s * (now.x - edge) > 0.0
        if reached:
            until, there = middle, now
        else:
            begun = middle
    return until, there


@lean
def by_matrix(slide, left, c):
    """(event, its time, motion then) of a motion with more damping than makes it swing, by a matrix of its own.

    Its velocity under a constant force is the sum of two exponentials, which is zero once at most. Under another force
    it may stop in between where it slows down first and speeds up again. An event is located by halving the time where
    series would take too many pieces; else it is ``UNKNOWN``.
    """
    s, low, high, plant, motion, line = slide
    rate = plant.b / plant.m
    if plant.b * rate < 4.0 * abs(plant.k):
        return UNKNOWN, left, motion
    there, until, found = _leapt(slide, left, c), left, NONE
    changing = line.r != 0.0 or line.e != 0.0
    dips = changing and _net(slide, motion, 0.0) < 0.0 and _net(slide, there, left) > 0.0
    if s * there.v > 0.0 and low <= there.x <= high and not dips:
        return NONE, left, there
    if rate * left <= STIFF:
        return UNKNOWN, left, motion
    if dips and s * there.v > 0.0:
        slow, slowest = _halved(_SLOWEST, slide, left, c)
        if s * slowest.v <= 0.0:
            until, there = slow, slowest
    if s * there.v <= 0.0:
        until, there = _halved(TURNED, slide, until, c)
        found = TURNED
    if s * (there.x - (high if s > 0 else low)) > 0.0:
        until, there = _halved(CROSSED, slide, until, c)
        found = CROSSED
    return found, until, there


@lean
def by_series(slide, left, c):
    """(event, its time, motion then), the time that of one piece of a series at most."""
    s, low, high, plant, motion, line = slide
    fastest = max(linear.fastest_rate(plant), line.decay)
    d = min(left, linear.LONGEST / fastest)
    series = linear.series(c, linear.terms_for(fastest * d), plant, motion, line)
    turn = first_turn(series, d, s, motion.v, line.r != 0.0 or line.e != 0.0)
    until = min(turn, d)
    edge = high if s > 0 else low
    x = linear.position(series, until)
    if s * (x - edge) > 0.0:
        until = fall_through(series, until, edge, s)
        return CROSSED, until, Motion(edge, linear.velocity(series, until))
    if turn > d:
        return NONE, until, Motion(x, linear.velocity(series, until))
    return TURNED, until, Motion(x, 0.0)
