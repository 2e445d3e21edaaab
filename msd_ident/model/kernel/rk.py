"""One Runge-Kutta step of the whole equation of motion, with an estimate of its error.

The classic fourth-order method. The slope at the end of a step is the first of the next one, and in place of the
fourth it makes a third-order result: the difference is the estimate (weights 1/6, 1/3, 1/3, 0, 1/6).
"""

from __future__ import annotations

import math

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.compiled import inlined, lean


@inlined
def applied(drive, t):
    """Force [N] on the cart a time t [s] after the segment began: f + r t + e exp(-decay t)."""
    _, f, r, e, decay = drive
    force = f + r * t
    if e != 0.0:
        force += e * math.exp(-decay * t)
    return force


@inlined
def other_forces(world, p, w, piece, drive, s, t, x, v, y, u):
    """Sum of all forces on the cart but dry friction [N]; t is the time since the segment began.

    world: (active, m, b, constant, m2, k2, b2); p, w: parameters and memory; piece: (slope, intercept, own slope, own intercept) of the
    spring; drive: see ``applied``; s: direction of motion; (x, v) and (y, u): the two masses.
    """
    active, _, b, constant, m2, k2, b2 = world
    slope, intercept, own_slope, own_intercept = piece
    net = applied(drive, t) - constant - intercept - slope * x - b * v
    net -= laws.force(active, p, w, drive[0] + t, x, v, s, s * v, own_intercept + own_slope * x)
    if m2 > 0.0:
        net -= k2 * (x - y) + b2 * (v - u)
    return net


@inlined
def acceleration(world, p, w, piece, drive, s, t, x, v, y, u):
    """x'' [m/s²] while sliding in direction s."""
    net = other_forces(world, p, w, piece, drive, s, t, x, v, y, u)
    if world[0] & laws.DRY_BITS:
        net -= s * laws.friction(world[0], p, w, x, s * v)
    return net / world[1]


@inlined
def second_acceleration(world, x, v, y, u):
    """Acceleration [m/s²] of the second mass."""
    _, _, _, _, m2, k2, b2 = world
    if m2 > 0.0:
        return (k2 * (x - y) + b2 * (v - u)) / m2
    return 0.0


@lean
def forces_at(world, p, w, piece, drive, s, t, x, v, y, u):
    """``other_forces`` as a call of its own, for places where speed does not matter."""
    return other_forces(world, p, w, piece, drive, s, t, x, v, y, u)


@lean
def acceleration_at(world, p, w, piece, drive, s, t, x, v, y, u):
    """``acceleration`` as a call of its own."""
    return acceleration(world, p, w, piece, drive, s, t, x, v, y, u)


@inlined
def step(world, p, w, piece, drive, s, t, h, x, v, a, y, u, c):
    """(x, v, a, y, u, c) a time h later, and the error estimates of position [m] and velocity [m/s].

    x, v, a: position, velocity, acceleration of the cart; y, u, c: of the second mass. A held cart has an infinite
    mass in its ``world``, so that the second one moves alone.
    """
    vn, an, un, cn = v, a, u, c
    sum_v, sum_a, sum_u, sum_c = v, a, u, c
    reach, weight = 0.5 * h, 2.0
    for stage in range(3):
        if stage == 2:
            reach, weight = h, 1.0
        xn, yn = x + reach * vn, y + reach * un
        vn, un = v + reach * an, u + reach * cn
        an = acceleration(world, p, w, piece, drive, s, t + reach, xn, vn, yn, un)
        cn = second_acceleration(world, xn, vn, yn, un)
        sum_v, sum_a = sum_v + weight * vn, sum_a + weight * an
        sum_u, sum_c = sum_u + weight * un, sum_c + weight * cn
    sixth = h / 6.0
    x1, v1 = x + sixth * sum_v, v + sixth * sum_a
    y1, u1 = y + sixth * sum_u, u + sixth * sum_c
    a1 = acceleration(world, p, w, piece, drive, s, t + h, x1, v1, y1, u1)
    c1 = second_acceleration(world, x1, v1, y1, u1)
    error_x = sixth * (abs(vn - v1) + abs(un - u1))
    error_v = sixth * (abs(an - a1) + abs(cn - c1))
    return x1, v1, a1, y1, u1, c1, error_x, error_v


@lean
def step_to(world, p, w, piece, drive, s, t, h, x, v, a, y, u, c):
    """``step`` as a call of its own, for the search of events."""
    return step(world, p, w, piece, drive, s, t, h, x, v, a, y, u, c)
