"""Exponential steps, for a mass so small that damping stops it well within a segment.

An explicit step may hardly be longer than m/b, however slowly the cart creeps. So the motion is written as

    v' = -r v + g

and solved exactly for a g that is a parabola over the step: through its values at the beginning, half-way and at the
end (exponential time differencing; Cox & Matthews 2002, J. Comput. Phys. 176). The rate r is b/m, and what other laws
that depend on the speed add to it as the step begins; g changes as slowly as all other forces. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.groups import Place, State
from msd_ident.model.kernel.rk import acceleration_at, second_acceleration

#: A segment is stiff where it lasts longer than this many m/b: an explicit step of fifth order grows beyond 3.3.
STIFF = 3.0
#: The same beside laws that depend on the speed, whose forces change within m/b after a jump of the force: until the
#: cart creeps again, the steps are short by either method.
STIFF_BESIDE = 50.0
#: Change of the velocity by which the rate is told, in parts of it.
_SLIGHT = 1e-4
#: Least rate, in parts of b/m: a friction that falls with the speed may take the damping away.
_LEAST = 0.1
#: The parabola's error, in parts of what it differs by from a straight line. With this and ``_FADED``, five laws at
#: b·h/m of 5 to 3000 differ by at most 4.2e-7 of the motion from Radau's method (``test_stiff_motion``).
_BETTER = 0.05
#: z up to which the functions phi are summed as series: the recurrence from exp(-z) loses digits there.
_SERIES = 1.0
#: Factor by which an error of the velocity may be larger, at most: it fades within 1/r. With 100, and the scale of the
#: position whole (``run.WAY``), the largest difference was 8.5e-6.
_FADED = 10.0


@lean
def is_stiff(cart, length):
    """Whether steps as long as the segment [s] are exponential ones, by the linear damping alone."""
    least = STIFF_BESIDE if cart.active & laws.SPEED_BITS or cart.m2 > 0.0 else STIFF
    return cart.b * cart.lightness * length > least


@lean
def becomes_stiff(phase, t, left, start):
    """The same by what other laws, and a second mass, add to the damping, where any does."""
    cart = phase.world.cart
    return (cart.active & laws.SPEED_BITS or cart.m2 > 0.0) and _rate(phase, t, start) * left > STIFF_BESIDE


@lean
def _rate(phase, t, start):
    """Rate r [1/s] at which the velocity fades as the step begins."""
    cart = phase.world.cart
    plain = cart.b * cart.lightness
    if not (cart.active & laws.SPEED_BITS or cart.m2 > 0.0):
        return plain
    slight = _SLIGHT * max(abs(start.v), abs(start.a) * min(phase.length, 1.0 / plain if plain > 0.0 else phase.length))
    if slight == 0.0:
        return plain
    if phase.s < 0.0:
        slight = -slight
    faster = Place(start.x, start.v + slight, start.y, start.u)
    return max((start.a - acceleration_at(phase, t, faster)) / slight, _LEAST * plain)


@lean
def _decays(z):
    """exp(-z), and the functions phi_1 to phi_4 of -z: phi_k is the integral over s in (0, 1) of
    exp(-z (1 - s)) s^(k-1) / (k-1)!.
    """
    if z > _SERIES:
        e = math.exp(-z)
        p1 = (1.0 - e) / z
        p2 = (1.0 - p1) / z
        p3 = (0.5 - p2) / z
        return e, p1, p2, p3, (1.0 / 6.0 - p3) / z
    term, p4 = 1.0 / 24.0, 0.0
    for k in range(5, 20):
        p4 += term
        term *= -z / k
    p3 = 1.0 / 6.0 - z * p4
    p2 = 0.5 - z * p3
    p1 = 1.0 - z * p2
    return 1.0 - z * p1, p1, p2, p3, p4


@lean
def _faded(force, decay, rate, h):
    """(x, v) that an acceleration force·exp(-decay t) adds in a time h to a velocity that fades at this rate."""
    if force == 0.0:
        return 0.0, 0.0
    lost, stopped = -math.expm1(-decay * h), -math.expm1(-rate * h)
    v = force * (stopped - lost) / (rate - decay)
    return (force * lost / decay - v) / rate, v


@lean
def _transient(phase, t, rate):
    """Acceleration by the lagged part of the force as the step begins, which is solved apart; 0 where it is not."""
    _, _, _, e, decay = phase.drive
    if e == 0.0 or abs(rate - decay) < 0.01 * rate:
        return 0.0
    return e * math.exp(-decay * t) * phase.world.cart.lightness


@lean
def step_exponential(phase, t, h, start):
    """(state, error of position [m], of velocity [m/s]) of one exponential step.

    A second mass, which no damping of the cart stops, moves by a parabola of its acceleration. An error of the velocity
    fades within 1/r, so that only a part of it is one of the motion.
    """
    x, v, _, y, u, c = start
    cart, decay = phase.world.cart, phase.drive.decay
    rate = _rate(phase, t, start)
    lagged = _transient(phase, t, rate)
    g0, half, square = start.a + rate * v - lagged, 0.5 * h, h * h
    e, p1, p2, p3, p4 = _decays(0.5 * rate * h)
    fade_x, fade_v = _faded(lagged, decay, rate, half)
    xn, vn = x + half * (p1 * v + half * p2 * g0) + fade_x, e * v + half * p1 * g0 + fade_v
    yn, un = y + half * (u + 0.25 * h * c), u + half * c
    left = lagged * math.exp(-decay * half)
    change = acceleration_at(phase, t + half, Place(xn, vn, yn, un)) + rate * vn - left - g0
    cm = second_acceleration(cart, xn, vn, yn, un)
    xn, vn = xn + half * half * p3 * change, vn + half * p2 * change
    yn, un = yn + square * (cm - c) / 24.0, un + 0.25 * h * (cm - c)
    gm = acceleration_at(phase, t + half, Place(xn, vn, yn, un)) + rate * vn - left
    cm = second_acceleration(cart, xn, vn, yn, un)
    e, p1, p2, p3, p4 = _decays(rate * h)
    fade_x, fade_v = _faded(lagged, decay, rate, h)
    plain_x, plain_v = x + h * (p1 * v + h * p2 * g0) + fade_x, e * v + h * p1 * g0 + fade_v
    change = 2.0 * (gm - g0)
    line_x, line_v = plain_x + square * p3 * change, plain_v + h * p2 * change
    line_y, line_u = y + h * u + square * (c + 2.0 * cm) / 6.0, u + h * cm
    left = lagged * math.exp(-decay * h)
    g1 = acceleration_at(phase, t + h, Place(line_x, line_v, line_y, line_u)) + rate * line_v - left
    c1 = second_acceleration(cart, line_x, line_v, line_y, line_u)
    slope, bend = 4.0 * gm - 3.0 * g0 - g1, 4.0 * (g0 + g1) - 8.0 * gm
    x1, v1 = plain_x + square * (p3 * slope + p4 * bend), plain_v + h * (p2 * slope + p3 * bend)
    y1, u1 = line_y, u + h * (c + 4.0 * cm + c1) / 6.0
    a1 = acceleration_at(phase, t + h, Place(x1, v1, y1, u1))
    amiss = abs(a1 + rate * v1 - left - g1)
    error_x = _BETTER * abs(x1 - line_x) + square * abs(4.0 * p4 - p3) * amiss
    error_v = (_BETTER * abs(v1 - line_v) + h * abs(4.0 * p3 - p2) * amiss) / min(max(rate * h, 1.0), _FADED)
    end_c = second_acceleration(cart, x1, v1, y1, u1)
    late = h * (_BETTER * abs(c - 2.0 * cm + c1) + abs(end_c - c1)) / 6.0
    return State(x1, v1, a1, y1, u1, end_c), error_x + h * late, error_v + late
