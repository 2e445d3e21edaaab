"""A step from the accelerations of the steps before: one or two evaluations of the laws where Runge-Kutta takes four.

Adams' method (Bashforth & Adams 1883; Hairer, Nørsett & Wanner 1993, Solving Ordinary Differential Equations I,
section III.1) for x'' = a: the polynomial through the last accelerations at even times is integrated once for the
velocity and twice for the position; then once more with the acceleration that was found at the end. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

from fractions import Fraction
from math import prod

from msd_ident.model.kernel.compiled import inlined
from msd_ident.model.kernel.rk import acceleration, outer, second_acceleration

#: Accelerations before the present one that a step needs: six to be made from, one more for its error.
PAST = 7
#: Error of the velocity in parts of the eighth difference of the accelerations, times the length of the step; and part
#: of the seventh that the eighth is taken for at least: a difference may pass through zero.
_ERROR, _LEAST = 33953 / 3628800, 0.3


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
_V1, _X1 = _weights(tuple(range(1, -PAST, -1)))


@inlined
def _sum(weights, first, second, past):
    """Weighted sum of two accelerations and the five before them."""
    late = (weights[0] * first + weights[1] * second) + (weights[2] * past[0] + weights[3] * past[1])
    return late + (weights[4] * past[2] + weights[5] * past[3]) + weights[6] * past[4]


@inlined
def _foreseen(weights, a, past):
    """Of the present acceleration and the six past ones."""
    return _sum(weights, a, past[0], past[1:])


@inlined
def _found(weights, a1, a, past):
    """Of the acceleration at the end, the present one and the six past ones."""
    return _sum(weights, a1, a, past) + weights[7] * past[5]


@inlined
def _roughness(a1, a, past):
    """Of the accelerations up to the one at the end: what the error of a step is a multiple of."""
    p0, p1, p2, p3, p4, p5, p6 = past
    seventh = (a1 - p5) - 7.0 * (a - p4) + 21.0 * (p0 - p3) - 35.0 * (p1 - p2)
    eighth = (a1 + p6) - 8.0 * (a + p5) + 28.0 * (p0 + p4) - 56.0 * (p1 + p3) + 70.0 * p2
    return max(abs(eighth), _LEAST * abs(seventh))


@inlined
def step_adams(world, p, w, piece, drive, s, h, x, v, a, y, u, c, past, past_c, tolerance):
    """(x, v, a, y, u, c) a time h after the segment began, and the error of velocity [m/s].

    past, past_c: accelerations of both masses one step ago and before, the steps being of length h. Where the velocity
    turns out as foreseen within the tolerance [m/s], so did the acceleration.
    """
    outside = outer(world, p, w, drive, h)
    second = world[4] > 0.0
    square = h * h
    xp, vp = x + h * v + square * _foreseen(_X0, a, past), v + h * _foreseen(_V0, a, past)
    yp, up, cp = y, u, c
    if second:
        yp, up = y + h * u + square * _foreseen(_X0, c, past_c), u + h * _foreseen(_V0, c, past_c)
        cp = second_acceleration(world, xp, vp, yp, up)
    ap = acceleration(world, p, w, piece, drive, outside, s, h, xp, vp, yp, up)
    x1, v1 = x + h * v + square * _found(_X1, ap, a, past), v + h * _found(_V1, ap, a, past)
    rough, amiss = _roughness(ap, a, past), abs(v1 - vp)
    y1, u1, a1, c1 = y, u, ap, cp
    if second:
        y1, u1 = y + h * u + square * _found(_X1, cp, c, past_c), u + h * _found(_V1, cp, c, past_c)
        rough, amiss = rough + _roughness(cp, c, past_c), amiss + abs(u1 - up)
    error = _ERROR * h * rough
    if error <= tolerance < amiss:
        a1 = acceleration(world, p, w, piece, drive, outside, s, h, x1, v1, y1, u1)
        if second:
            c1 = second_acceleration(world, x1, v1, y1, u1)
    return x1, v1, a1, y1, u1, c1, error
