"""One Runge-Kutta step of the whole equation of motion, with an estimate of its error.

The classic fourth-order method. The slope at the end of a step is the first of the next one, and in place of the
fourth it makes a third-order result: the difference is the estimate (weights 1/6, 1/3, 1/3, 0, 1/6).
"""

from __future__ import annotations

import math

from numba import njit

from msd_ident.model.kernel import laws


@njit(error_model="numpy")
def applied(drive, t):
    """Force [N] on the cart a time t [s] after the segment began: f + r t + e exp(-decay t)."""
    _, f, r, e, decay = drive
    force = f + r * t
    if e != 0.0:
        force += e * math.exp(-decay * t)
    return force


@njit(error_model="numpy")
def other_forces(world, piece, drive, s, t, x, v, y, u):
    """Sum of all forces on the cart but dry friction [N]; t is the time since the segment began.

    world: (active, p, w, m, b, constant, (m2, k2, b2)); piece: (slope, intercept, own slope, own intercept) of the
    spring; drive: see ``applied``; s: direction of motion; (x, v) and (y, u): the two masses.
    """
    active, p, w, _, b, constant, second = world
    slope, intercept, own_slope, own_intercept = piece
    net = applied(drive, t) - constant - intercept - slope * x - b * v
    net -= laws.force(active, p, w, drive[0] + t, x, v, s, s * v, own_intercept + own_slope * x)
    if second[0] > 0.0:
        net -= second[1] * (x - y) + second[2] * (v - u)
    return net


@njit(error_model="numpy")
def acceleration(world, piece, drive, s, t, x, v, y, u):
    """x'' [m/s²] while sliding in direction s."""
    net = other_forces(world, piece, drive, s, t, x, v, y, u)
    if world[0] & laws.DRY_BITS:
        net -= s * laws.friction(world[0], world[1], world[2], x, s * v)
    return net / world[3]


@njit(error_model="numpy")
def second_acceleration(world, x, v, y, u):
    """Acceleration [m/s²] of the second mass."""
    m2, k2, b2 = world[6]
    if m2 > 0.0:
        return (k2 * (x - y) + b2 * (v - u)) / m2
    return 0.0


@njit(error_model="numpy")
def step(world, piece, drive, s, t, h, x, v, a, y, u, c):
    """(x, v, a, y, u, c) a time h later, and the error estimates of position [m] and velocity [m/s].

    x, v, a: position, velocity, acceleration of the cart; y, u, c: of the second mass. With s = 0 in a model with dry
    friction the cart is held and the second mass moves alone.
    """
    g = 0.5 * h
    v2, u2 = v + g * a, u + g * c
    x2, y2 = x + g * v, y + g * u
    a2 = acceleration(world, piece, drive, s, t + g, x2, v2, y2, u2)
    c2 = second_acceleration(world, x2, v2, y2, u2)
    v3, u3 = v + g * a2, u + g * c2
    x3, y3 = x + g * v2, y + g * u2
    a3 = acceleration(world, piece, drive, s, t + g, x3, v3, y3, u3)
    c3 = second_acceleration(world, x3, v3, y3, u3)
    v4, u4 = v + h * a3, u + h * c3
    x4, y4 = x + h * v3, y + h * u3
    a4 = acceleration(world, piece, drive, s, t + h, x4, v4, y4, u4)
    c4 = second_acceleration(world, x4, v4, y4, u4)
    sixth = h / 6.0
    x1 = x + sixth * (v + 2.0 * (v2 + v3) + v4)
    v1 = v + sixth * (a + 2.0 * (a2 + a3) + a4)
    y1 = y + sixth * (u + 2.0 * (u2 + u3) + u4)
    u1 = u + sixth * (c + 2.0 * (c2 + c3) + c4)
    a1 = acceleration(world, piece, drive, s, t + h, x1, v1, y1, u1)
    c1 = second_acceleration(world, x1, v1, y1, u1)
    error_x = sixth * (abs(v4 - v1) + abs(u4 - u1))
    error_v = sixth * (abs(a4 - a1) + abs(c4 - c1))
    return x1, v1, a1, y1, u1, c1, error_x, error_v
