"""Runge-Kutta steps of the whole equation of motion, each with an estimate of its error.

Two methods, both of which end with the slope that the next step begins with. The classic one of fourth order: put
in place of its fourth slope, the slope at the end makes a third-order result, and the difference is the estimate
(weights 1/6, 1/3, 1/3, 0, 1/6). And Dormand & Prince 1980 (J. Comput. Appl. Math. 6), of fifth order, where longer
steps are wanted.

Names, here and in the modules that refer to ``rk``: ``groups`` has the named tuples; t is the time since the segment
began, h the length of a step, s the direction of motion; ``outside`` is what ``outer`` gives. In the innermost
functions world is a ``Cart``, piece an ``Elastic``, x, v, a are of the cart and y, u, c of the second mass.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel import laws, places
from msd_ident.model.kernel.compiled import inlined, lean
from msd_ident.model.kernel.groups import Cart, Phase, State, World

_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
#: Slopes of one fifth-order step: rows v, a of the cart and u, c of the second mass.
STAGES = (4, 7)


@inlined
def applied(drive, t):
    """Force [N] on the cart a time t [s] after the segment began: f + r t + e exp(-decay t)."""
    _, f, r, e, decay = drive
    force = f + r * t
    if e != 0.0:
        force += e * math.exp(-decay * t)
    return force


@inlined
def beside(world, p, w, force, time):
    """The forces [N] on the cart that do not depend on its motion, at this time [s], with this one applied."""
    active, _, _, constant, _, _, _ = world
    return force - constant - laws.disturbance(active, p, w, time)


@inlined
def outer(world, p, w, drive, t):
    """The same a time t [s] after the segment began."""
    return beside(world, p, w, applied(drive, t), drive[0] + t)


@inlined
def net_force(world, p, w, piece, drive, outside, s, t, x, v, y, u):
    """Sum of all forces on the cart but dry friction [N]; ``outside`` is that of ``outer``."""
    active, _, b, _, m2, k2, b2 = world
    slope, intercept, own_slope, own_intercept, inside = piece
    plain = outside - intercept - (slope * x + b * v)
    if m2 > 0.0:
        plain -= k2 * (x - y) + b2 * (v - u)
    driven = 1.0 if drive[1] != 0.0 or drive[2] != 0.0 else 0.0
    lagged = u if m2 > 0.0 else v
    own = own_intercept + own_slope * x
    force = applied(drive, t) if active & places.DRIVEN_BITS else 0.0
    return plain - laws.force(active, p, w, drive[0] + t, x, v, s, s * v, own, driven, force, lagged, inside)


@inlined
def acceleration(world, p, w, piece, drive, outside, s, t, x, v, y, u):
    """x'' [m/s²] while sliding in direction s."""
    net = net_force(world, p, w, piece, drive, outside, s, t, x, v, y, u)
    if world[0] & places.DRY_BITS:
        net -= s * laws.friction(world[0], p, w, drive[0] + t, x, s * v, piece[3] + piece[2] * x)
    if world[0] & places.CONTACT_BITS:
        net = laws.contact(world[0], p, w, net, x, v, piece[4])
    return net * world[1]


@lean
def grip_at(phase, t, place):
    """What tells by its sign which formula of a stop's force holds."""
    world, piece, drive, _, s = phase
    cart, p, w, _ = world
    elastic = piece.elastic
    x, v, y, u = place
    net = net_force(cart, p, w, elastic, drive, outer(cart, p, w, drive, t), s, t, x, v, y, u)
    if cart.active & places.DRY_BITS:
        own = elastic.own_intercept + elastic.own_slope * x
        net -= s * laws.friction(cart.active, p, w, drive[0] + t, x, s * v, own)
    return laws.grip(cart.active, p, w, net, x, v, elastic.inside)


@inlined
def pull(world, x, v, y, u):
    """Force [N] of spring and damper between the masses on the second one."""
    _, _, _, _, m2, k2, b2 = world
    return k2 * (x - y) + b2 * (v - u) if m2 > 0.0 else 0.0


@inlined
def second_acceleration(world, p, w, pulled, u):
    """Acceleration [m/s²] of the second mass by ``pull`` [N], and by what acts on it alone."""
    active, _, _, _, m2, _, _ = world
    if m2 > 0.0:
        if active & places.SECOND_BITS:
            pulled -= laws.second_force(active, p, w, u)
        return pulled / m2
    return 0.0


@lean
def forces_at(phase, t, place):
    """What dry friction has to hold [N] of a cart at rest: ``net_force``, and what a contact makes of it."""
    world, piece, drive, _, s = phase
    cart, p, w, _ = world
    x, v, y, u = place
    net = net_force(cart, p, w, piece.elastic, drive, outer(cart, p, w, drive, t), s, t, x, v, y, u)
    if cart.active & places.CONTACT_BITS:
        return laws.contact_at_rest(cart.active, p, w, net, x)
    return net


@lean
def acceleration_at(phase, t, place):
    """``acceleration`` as a call of its own."""
    world, piece, drive, _, s = phase
    cart, p, w, _ = world
    x, v, y, u = place
    return acceleration(cart, p, w, piece.elastic, drive, outer(cart, p, w, drive, t), s, t, x, v, y, u)


@inlined
def breakaway(phase, t, x):
    """The most that dry friction holds [N] of a cart at rest at x [m], a time t [s] after the segment began."""
    cart, p, w, _ = phase.world
    if cart.active & places.DRY_BITS:
        elastic = phase.piece.elastic
        own = elastic.own_intercept + elastic.own_slope * x
        return laws.breakaway(cart.active, p, w, phase.drive[0] + t, x, own)
    return 0.0


@inlined
def held(phase):
    """The phase with the cart held, in which the second mass moves alone."""
    world, piece, drive, length, _ = phase
    active, _, b, constant, m2, k2, b2 = world.cart
    cart = Cart(active, 0.0, b, constant, m2, k2, b2)
    return Phase(World(cart, world.p, world.w, world.stages), piece, drive, length, 0.0)


@inlined
def step4(world, p, w, piece, drive, middle, last, s, t, h, x, v, a, y, u, c):
    """(x, v, a, y, u, c) a time h later by the classic method, and the errors of position [m] and velocity [m/s].

    middle, last: what ``outer`` gives half-way and at the end.
    """
    vn, an, un, cn = v, a, u, c
    sum_v, sum_a, sum_u, sum_c = v, a, u, c
    v4, a4, u4, c4 = v, a, u, c
    sixth, outside = h / 6.0, middle
    for stage in range(4):  # one loop, so that the laws are compiled once: three slopes, then the end
        if stage < 3:
            reach = h if stage == 2 else 0.5 * h
            xn, yn = x + reach * vn, y + reach * un
            vn, un = v + reach * an, u + reach * cn
        else:
            v4, a4, u4, c4 = vn, an, un, cn
            xn, yn = x + sixth * sum_v, y + sixth * sum_u
            vn, un = v + sixth * sum_a, u + sixth * sum_c
        if stage == 2:
            outside = last
        an = acceleration(world, p, w, piece, drive, outside, s, t + (h if stage >= 2 else 0.5 * h), xn, vn, yn, un)
        cn = second_acceleration(world, p, w, pull(world, xn, vn, yn, un), un)
        weight = 2.0 if stage < 2 else 1.0
        sum_v, sum_a = sum_v + weight * vn, sum_a + weight * an
        sum_u, sum_c = sum_u + weight * un, sum_c + weight * cn
    error_x = sixth * (abs(v4 - vn) + abs(u4 - un))
    error_v = sixth * (abs(a4 - an) + abs(c4 - cn))
    return xn, vn, an, yn, un, cn, error_x, error_v


@lean
def step5(phase, t, h, start):
    """(state, error of position [m], of velocity [m/s]) of the step by Dormand and Prince."""
    world, spring, drive, _, s = phase
    cart, p, w, k = world
    piece = spring.elastic
    x, v, a, y, u, c = start
    second = cart.m2 > 0.0
    k[0, 0], k[1, 0], k[2, 0], k[3, 0] = v, a, u, c
    xn, vn, yn, un = x, v, y, u
    for n in range(1, 7):
        dx, dv = 0.0, 0.0
        for j in range(n):
            dx += _A[n, j] * k[0, j]
            dv += _A[n, j] * k[1, j]
        xn, vn = x + h * dx, v + h * dv
        if second:
            dx, dv = 0.0, 0.0
            for j in range(n):
                dx += _A[n, j] * k[2, j]
                dv += _A[n, j] * k[3, j]
            yn, un = y + h * dx, u + h * dv
            k[2, n], k[3, n] = un, second_acceleration(cart, p, w, pull(cart, xn, vn, yn, un), un)
        at = t + _C[n] * h
        k[0, n] = vn
        k[1, n] = acceleration(cart, p, w, piece, drive, outer(cart, p, w, drive, at), s, at, xn, vn, yn, un)
    error_x, error_v = _difference(k[0], k[1], h)
    if second:
        error_y, error_u = _difference(k[2], k[3], h)
        error_x, error_v = error_x + error_y, error_v + error_u
    return State(xn, vn, k[1, 6], yn, un, k[3, 6] if second else 0.0), error_x, error_v


@inlined
def _difference(speeds, accelerations, h):
    """What the embedded fourth-order result differs by, in position and velocity."""
    error_x, error_v = 0.0, 0.0
    for j in range(7):
        error_x += _E[j] * speeds[j]
        error_v += _E[j] * accelerations[j]
    return h * abs(error_x), h * abs(error_v)
