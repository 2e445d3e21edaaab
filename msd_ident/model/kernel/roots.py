"""Events inside a segment: roots of the series of the motion, and of the force on a cart at rest."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.groups import Ends
from msd_ident.model.kernel.linear import (
    acceleration,
    jerk,
    position,
    velocity,
    velocity_and_acceleration,
)

_ITERATIONS = 60
#: A Newton step this small, in parts of the interval, is the last: the error after it is of its square.
SETTLED = 1e-8


@lean
def _velocity_root(series, low, high, s):
    """Root of v in (low, high), where s v goes from above 0 to below: Newton, kept inside by bisection.

    The first guess is the root of the parabola through both ends with the slope at the first.
    """
    span = high - low
    v, a = velocity_and_acceleration(series, low)
    v_high = s * velocity(series, high)
    v, a = s * v, s * a
    bend = (v_high - v - a * span) / (span * span)
    t = low + 2.0 * v / (math.sqrt(max(a * a - 4.0 * bend * v, 0.0)) - a)
    if not low < t < high:
        t = 0.5 * (low + high)
    for _ in range(_ITERATIONS):
        v, a = velocity_and_acceleration(series, t)
        v, a = s * v, s * a
        if v > 0.0:
            low = t
        else:
            high = t
        new = t - v / a if a < 0.0 else 0.5 * (low + high)
        if abs(new - t) <= SETTLED * high:
            return new
        t = new if low < new < high else 0.5 * (low + high)
    return t


@lean
def _acceleration_root(series, low, high):
    """Root of x'' in (low, high), where it changes sign."""
    rising = acceleration(series, high) > 0.0
    t = 0.5 * (low + high)
    for _ in range(_ITERATIONS):
        a = acceleration(series, t)
        if (a > 0.0) == rising:
            high = t
        else:
            low = t
        slope = jerk(series, t)
        new = t - a / slope if slope != 0.0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - t) <= 1e-12 * high:
            return new
        t = new
    return t


@lean
def _jerk_root(series, low, high):
    """Root of x''' in (low, high), where it changes sign; bisection is good enough to split a segment there."""
    rising = jerk(series, high) > 0.0
    for _ in range(30):
        t = 0.5 * (low + high)
        if (jerk(series, t) > 0.0) == rising:
            high = t
        else:
            low = t
    return 0.5 * (low + high)


@lean
def first_turn(series, d, s, v, uneven):
    """First time in (0, d] at which a motion in direction s comes to v = 0; infinite if it does not.

    Under a force that is not constant (``uneven``) the acceleration may change sign twice on the way.
    """
    c = series.c
    a0 = s * 2.0 * c[2]
    a1 = s * acceleration(series, d)
    if uneven and (a0 > 0.0) == (a1 > 0.0) and (c[3] > 0.0) != (jerk(series, d) > 0.0):
        middle = _jerk_root(series, 0.0, d)
        a = s * acceleration(series, middle)
        if (a > 0.0) != (a0 > 0.0):
            # Look for a turn before the middle, then behind it.
            turn = _turn_before(series, 0.0, middle, s, Ends(s * v, a0, a))
            if turn <= middle:
                return turn
            return _turn_before(series, middle, d, s, Ends(s * velocity(series, middle), a, a1))
    return _turn_before(series, 0.0, d, s, Ends(s * v, a0, a1))


@lean
def _turn_before(series, low, d, s, ends):
    """The same between low and d, where the acceleration has one root at most; ``ends`` are those of this interval."""
    v0, a0, a1 = ends
    v1 = s * velocity(series, d)
    if v1 > 0.0:
        if a0 < 0.0 and a1 > 0.0 and v0 > 0.0:
            slowest = _acceleration_root(series, low, d)
            if s * velocity(series, slowest) <= 0.0:
                return _velocity_root(series, low, slowest, s)
        return math.inf
    if v0 > 0.0:
        return _velocity_root(series, low, d, s)
    if a0 > 0.0 and a1 < 0.0:
        fastest = _acceleration_root(series, low, d)
        return _velocity_root(series, fastest, d, s)
    # A start from rest that goes nowhere: the force was at the edge of what friction holds.
    return d


@lean
def fall_through(series, d, edge, s):
    """Time in [0, d] at which a motion in direction s passes x = edge, which it does before d."""
    low, high = 0.0, d
    x0, x1 = s * (series.c[0] - edge), s * (position(series, d) - edge)
    if x0 >= 0.0:
        return 0.0
    t = d * x0 / (x0 - x1)
    for _ in range(_ITERATIONS):
        x = s * (position(series, t) - edge)
        if x < 0.0:
            low = t
        else:
            high = t
        slope = s * velocity(series, t)
        new = t - x / slope if slope > 0.0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - t) <= SETTLED * high or not low < new < high:
            return new
        t = new
    return t


@lean
def first_exit(left, line, hold):
    """First time in [0, left] at which the force ``line`` is beyond ``hold`` either side; left if it does not."""
    net, r, e, decay = line
    if abs(net + e) > hold:
        return 0.0
    low = 0.0
    if e != 0.0:
        if r * e > 0.0 and 0.0 < r / (e * decay) < 1.0:
            extreme = -math.log(r / (e * decay)) / decay
            if extreme < left:
                if abs(net + r * extreme + e * math.exp(-decay * extreme)) > hold:
                    return _exit_between(0.0, extreme, line, hold)
                low = extreme
    elif r != 0.0:
        return min(left, max(0.0, (math.copysign(hold, r) - net) / r))
    if abs(net + r * left + e * math.exp(-decay * left)) <= hold:
        return left
    return _exit_between(low, left, line, hold)


@lean
def _exit_between(low, high, line, hold):
    net, r, e, decay = line
    for _ in range(_ITERATIONS):
        t = 0.5 * (low + high)
        if abs(net + r * t + e * math.exp(-decay * t)) > hold:
            high = t
        else:
            low = t
    return high
