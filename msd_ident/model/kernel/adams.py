"""A step from the accelerations of the steps before: one or two evaluations of the laws where Runge-Kutta takes four.

Adams' method (Bashforth & Adams 1883; Hairer, Nørsett & Wanner 1993, Solving Ordinary Differential Equations I,
section III.1) for x'' = a: the polynomial through the last accelerations at even times is integrated once for the
velocity and twice for the position. What the acceleration found at the end is beyond that polynomial, the seventh
difference, puts both right, as if it had gone through that one too. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

from fractions import Fraction
from math import prod

from msd_ident.model.kernel.compiled import inlined
from msd_ident.model.kernel.rk import acceleration, pull, second_acceleration

#: Accelerations before the present one that a step needs: six to be made from, one more for its error.
PAST = 7
#: Error of the velocity in parts of the eighth difference of the accelerations, times the length of the step; and part
#: of the seventh that the eighth is taken for at least: a difference may pass through zero.
_ERROR, _LEAST = 33953 / 3628800, 0.3
#: Velocity that turns out other than foreseen, in tolerances, from which on the acceleration is found once more: a step
#: is short beside what the acceleration takes to answer, so that by far less of it remains.
_AMISS = 8.0


def _weights(nodes: tuple[int, ...]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Weights of values at these times, in steps: for the integral over (0, 1), and for the double one.

    The integral of L(s) ds and of (1 - s) L(s) ds, L being Lagrange's polynomial of each node.
    """
    once, twice = [], []
    for node in nodes:
        others = [n for n in nodes if n != node]
        powers = [Fraction(1)]
        for n in others:  # times (s - n)
            powers = [a - n * b for a, b in zip([Fraction(0), *powers], [*powers, Fraction(0)], strict=True)]
        scale = Fraction(prod(node - n for n in others))
        once.append(float(sum(c / (i + 1) for i, c in enumerate(powers)) / scale))
        twice.append(float(sum(c / ((i + 1) * (i + 2)) for i, c in enumerate(powers)) / scale))
    return tuple(once), tuple(twice)


_V0, _X0 = _weights(tuple(range(0, -PAST, -1)))
#: Weights of the acceleration at the end, in the polynomial through it as well; and what the one before it foresees.
_V1, _X1 = (weights[0] for weights in _weights(tuple(range(1, -PAST, -1))))
_ONWARD = (7.0, -21.0, 35.0, -35.0, 21.0, -7.0, 1.0)


@inlined
def _sum(weights, a, past):
    """Weighted sum of the present acceleration and the six before it."""
    late = (weights[0] * a + weights[1] * past[0]) + (weights[2] * past[1] + weights[3] * past[2])
    return late + ((weights[4] * past[3] + weights[5] * past[4]) + weights[6] * past[5])


@inlined
def _differences(a1, a, past):
    """Seventh difference of the accelerations up to the one at the end, and what the error is a multiple of."""
    seventh = a1 - _sum(_ONWARD, a, past)
    eighth = seventh - (a - _sum(_ONWARD, past[0], past[1:]))
    return seventh, max(abs(eighth), _LEAST * abs(seventh))


@inlined
def step_adams(world, p, w, piece, drive, last, s, h, x, v, a, y, u, c, past, past_c, tolerance):
    """(x, v, a, y, u, c) a time h after the segment began, and the error of velocity [m/s].

    last: what ``outer`` gives then. past, past_c: accelerations of both masses one step ago and before, the steps being
    of length h. Where the velocity turns out as foreseen, within ``_AMISS`` tolerances [m/s], so did the acceleration.
    """
    second = world[4] > 0.0
    square = h * h
    xp, vp = x + h * v + square * _sum(_X0, a, past), v + h * _sum(_V0, a, past)
    yp, up, cp = y, u, c
    if second:
        yp, up = y + h * u + square * _sum(_X0, c, past_c), u + h * _sum(_V0, c, past_c)
        cp = second_acceleration(world, p, w, pull(world, xp, vp, yp, up), up)
    ap = acceleration(world, p, w, piece, drive, last, s, h, xp, vp, yp, up)
    seventh, rough = _differences(ap, a, past)
    x1, v1, a1 = xp + square * _X1 * seventh, vp + h * _V1 * seventh, ap
    y1, u1, c1 = yp, up, cp
    amiss = abs(seventh)
    if second:
        seventh, rough_c = _differences(cp, c, past_c)
        y1, u1 = yp + square * _X1 * seventh, up + h * _V1 * seventh
        rough, amiss = rough + rough_c, amiss + abs(seventh)
    error = _ERROR * h * rough
    if error <= tolerance and h * _V1 * amiss > _AMISS * tolerance:
        a1 = acceleration(world, p, w, piece, drive, last, s, h, x1, v1, y1, u1)
        if second:
            c1 = second_acceleration(world, p, w, pull(world, x1, v1, y1, u1), u1)
    return x1, v1, a1, y1, u1, c1, error
