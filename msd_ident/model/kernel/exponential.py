"""Exponential steps, for a mass so small that damping, or friction on a second mass, stops it well within a segment.

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

from msd_ident.model.kernel import places
from msd_ident.model.kernel.compiled import inlined, lean
from msd_ident.model.kernel.groups import Place, State
from msd_ident.model.kernel.rk import acceleration_at, pull, second_acceleration

#: A segment is stiff where it lasts longer than this many m/b: an explicit step of fifth order grows beyond 3.3.
STIFF = 3.0
#: The same beside laws that depend on the speed, whose forces change within m/b after a jump of the force: until the
#: cart creeps again, the steps are short by either method.
STIFF_BESIDE = 50.0
#: A cart creeps where its acceleration is less than this part of what the rate takes from its velocity.
_CREEPING = 0.1
#: Change of the velocity by which the rate is told, in parts of it.
_SLIGHT = 1e-4
#: The same in parts of what all forces would bring, at least: as a cart breaks away its acceleration is the rounding of
#: these forces, and a rate from that would be anything. Measured: of 180 runs with Stribeck friction and 24 to 64
#: samples a second 16 were off by more than 1e-5 of the motion without it, none with it.
_ROUNDED = 1e-8
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
    least = STIFF_BESIDE if cart.active & places.SPEED_BITS or cart.m2 > 0.0 else STIFF
    return cart.b * cart.lightness * length > least


@lean
def becomes_stiff(phase, t, left, start):
    """The same by what other laws, and a second mass, add to the damping, where any does.

    Much sooner while the cart creeps: then what stops it and what drives it are all but equal.
    """
    cart = phase.world.cart
    if not (cart.active & places.SPEED_BITS or cart.m2 > 0.0):
        return False
    rate = _rate(phase, t, start)
    creeps = abs(start.a) < _CREEPING * rate * abs(start.v)
    return rate * left > (STIFF if creeps else STIFF_BESIDE)


@lean
def second_is_stiff(phase, left, start):
    """Whether a force on the second mass alone stops it well within a time [s]."""
    return _second_rate(phase, start) * left > STIFF


@inlined
def _pushing(phase, x):
    """Size of the forces [N] whose rounding an acceleration holds: of the drive, the spring and a constant one."""
    _, f, r, e, _ = phase.drive
    elastic = phase.piece.elastic
    driven = abs(f) + abs(r) * phase.length + abs(e)
    return driven + abs(elastic.slope * x + elastic.intercept) + abs(phase.world.cart.constant)


@lean
def _rate(phase, t, start):
    """Rate r [1/s] at which the velocity of the cart fades as the step begins."""
    cart = phase.world.cart
    plain = cart.b * cart.lightness
    if not (cart.active & places.SPEED_BITS or cart.m2 > 0.0):
        return plain
    lasts = min(phase.length, 1.0 / plain if plain > 0.0 else phase.length)
    slight = _SLIGHT * max(abs(start.v), abs(start.a) * lasts)
    slight = max(slight, _ROUNDED * _pushing(phase, start.x) * cart.lightness * lasts)
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
    if z == 0.0:
        return 1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0
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
def _second_rate(phase, start):
    """The same of the second mass, by a force that acts on it alone; 0 without one."""
    cart, p, w, _ = phase.world
    if not cart.active & places.SECOND_BITS:
        return 0.0
    x, v, _, y, u, c = start
    slight = _SLIGHT * max(abs(u), abs(c) * phase.length)
    if slight == 0.0:
        return 0.0
    if u < 0.0:
        slight = -slight
    return max((c - second_acceleration(cart, p, w, pull(cart, x, v, y, u + slight), u + slight)) / slight, 0.0)


@inlined
def _moved(motion, acceleration, h, decays):
    """(x, v) a time h later, where g + slope·s + bend·s²/2 acts on a velocity that fades; s goes from 0 to 1."""
    (x, v), (g, slope, bend), (e, p1, p2, p3, p4) = motion, acceleration, decays
    return x + h * (p1 * v + h * (p2 * g + p3 * slope + p4 * bend)), e * v + h * (p1 * g + p2 * slope + p3 * bend)


@inlined
def _through(first, middle, last):
    """The parabola through three accelerations: (g, slope, bend) of ``_moved``."""
    return first, 4.0 * middle - 3.0 * first - last, 4.0 * (first + last) - 8.0 * middle


@inlined
def _errors(end, line, amiss, step):
    """Errors of position and velocity: of the parabola, and of an acceleration at the end that is foreseen amiss.

    ``step``: its length, the functions phi of it, and which part of the parabola's error counts.
    """
    h, (_, _, p2, p3, p4), better = step
    error_x = better * abs(end[0] - line[0]) + h * h * abs(4.0 * p4 - p3) * amiss
    error_v = better * abs(end[1] - line[1]) + h * abs(4.0 * p3 - p2) * amiss
    return error_x, error_v


@inlined
def _fading(z):
    """Factor by which an error of the velocity may be larger after a step of z times 1/r."""
    return min(max(z, 1.0), _FADED)


@lean
def step_exponential(phase, t, h, start):
    """(state, error of position [m], of velocity [m/s]) of one exponential step of both masses.

    An error of a velocity fades within 1/r, so that only a part of it is one of the motion.
    """
    x, v, _, y, u, c = start
    cart, p, w, _ = phase.world
    decay, half, second = phase.drive.decay, 0.5 * h, cart.m2 > 0.0
    rate, rate2 = _rate(phase, t, start), _second_rate(phase, start)
    lagged = _transient(phase, t, rate)
    g0, k0 = start.a + rate * v - lagged, c + rate2 * u
    phi, phi2 = _decays(rate * half), _decays(rate2 * half)
    fade_x, fade_v = _faded(lagged, decay, rate, half)
    left = lagged * math.exp(-decay * half)
    gm, km, yn, un = g0, k0, y, u
    for _ in range(2):  # straight to the middle, as at the beginning and then as there
        xn, vn = _moved((x, v), (g0, gm - g0, 0.0), half, phi)
        xn, vn = xn + fade_x, vn + fade_v
        if second:
            yn, un = _moved((y, u), (k0, km - k0, 0.0), half, phi2)
            km = second_acceleration(cart, p, w, pull(cart, xn, vn, yn, un), un) + rate2 * un
        gm = acceleration_at(phase, t + half, Place(xn, vn, yn, un)) + rate * vn - left
    phi, phi2 = _decays(rate * h), _decays(rate2 * h)
    fade_x, fade_v = _faded(lagged, decay, rate, h)
    left = lagged * math.exp(-decay * h)
    xn, vn = _moved((x, v), (g0, 2.0 * (gm - g0), 0.0), h, phi)
    xn, vn = xn + fade_x, vn + fade_v
    y1, u1, c1, error_y, error_u = y, u, c, 0.0, 0.0
    if second:
        yn, un = _moved((y, u), (k0, 2.0 * (km - k0), 0.0), h, phi2)
        k1 = second_acceleration(cart, p, w, pull(cart, xn, vn, yn, un), un) + rate2 * un
        y1, u1 = _moved((y, u), _through(k0, km, k1), h, phi2)
    g1 = acceleration_at(phase, t + h, Place(xn, vn, yn, un)) + rate * vn - left
    x1, v1 = _moved((x, v), _through(g0, gm, g1), h, phi)
    x1, v1 = x1 + fade_x, v1 + fade_v
    a1 = acceleration_at(phase, t + h, Place(x1, v1, y1, u1))
    better = _BETTER * (1.0 - phi[0])  # a cart that hardly slows down has a step of fourth order
    error_x, error_v = _errors((x1, v1), (xn, vn), abs(a1 + rate * v1 - left - g1), (h, phi, better))
    if second:
        c1 = second_acceleration(cart, p, w, pull(cart, x1, v1, y1, u1), u1)
        error_y, error_u = _errors((y1, u1), (yn, un), abs(c1 + rate2 * u1 - k1), (h, phi2, _BETTER))
    error_v, error_u = error_v / _fading(rate * h), error_u / _fading(rate2 * h)
    return State(x1, v1, a1, y1, u1, c1), error_x + error_y, error_v + error_u
