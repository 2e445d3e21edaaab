"""A step from the accelerations of the steps before: one or two evaluations of the laws where Runge-Kutta takes four.

Adams' method (Bashforth & Adams 1883; Hairer, Nørsett & Wanner 1993, Solving Ordinary Differential Equations I,
section III.1) for x'' = a: the polynomial through the last accelerations at even times is integrated once for the
velocity and twice for the position. What the acceleration found at the end is beyond that polynomial, the next
difference, puts both right, as if it had gone through that one too. The order grows with the number of accelerations
that are known, up to the eighth. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

from fractions import Fraction
from math import comb, prod

import numpy as np

from msd_ident.model.kernel.compiled import inlined
from msd_ident.model.kernel.groups import FloatArray
from msd_ident.model.kernel.rk import acceleration, pull, second_acceleration

#: Accelerations before the present one that a step takes at most, and at least; the oldest serves for its error only.
PAST, FEWEST = 7, 4
#: The difference that tells the error counts as at least this part of the one before it: it may pass through zero.
_LEAST = 0.3
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


def _table() -> tuple[FloatArray, ...]:
    """What a step is made of, in row n if it takes n accelerations before the present one.

    Returns:
        Weights (PAST + 1, PAST) of the present acceleration and those before it, newest first: for the velocity, for
        the position, and for the acceleration that they foresee at the end. Weights (PAST + 1,) of the n-th difference,
        between that and the one found, for velocity and position. And the error (PAST + 1,) of the velocity in parts of
        the difference after it, which is the weight that the next order would give it.
    """
    velocity, position, onward = (np.zeros((PAST + 1, PAST)) for _ in range(3))
    right_v, right_x, error = (np.zeros(PAST + 1) for _ in range(3))
    for n in range(FEWEST, PAST + 1):
        velocity[n, :n], position[n, :n] = _weights(tuple(range(0, -n, -1)))
        right_v[n], right_x[n] = (weights[0] for weights in _weights(tuple(range(1, -n, -1))))
        onward[n, :n] = [(-1) ** i * comb(n, i + 1) for i in range(n)]
        error[n] = abs(_weights(tuple(range(1, -n - 1, -1)))[0][0] - right_v[n])
    return velocity, position, onward, right_v, right_x, error


_V0, _X0, _ONWARD, _V1, _X1, _ERROR = _table()


@inlined
def _sum(weights, n, a, past):
    """Weighted sum of the present acceleration and the n - 1 before it."""
    late = (weights[n, 0] * a + weights[n, 1] * past[0]) + (weights[n, 2] * past[1] + weights[n, 3] * past[2])
    return late + ((weights[n, 4] * past[3] + weights[n, 5] * past[4]) + weights[n, 6] * past[5])


@inlined
def _differences(n, a1, a, past):
    """n-th difference of the accelerations up to the one at the end, and what the error is a multiple of."""
    last = a1 - _sum(_ONWARD, n, a, past)
    beyond = last - (a - _sum(_ONWARD, n, past[0], past[1:]))
    return last, max(abs(beyond), _LEAST * abs(last))


@inlined
def step_adams(n, world, p, w, piece, drive, last, s, h, x, v, a, y, u, c, past, past_c, tolerance):
    """(x, v, a, y, u, c) a time h after the segment began, and the error of velocity [m/s].

    last: what ``outer`` gives then. past, past_c: accelerations of both masses one step ago and before, of which the
    newest n are used (``FEWEST`` to ``PAST``), all h apart. Where the velocity turns out as foreseen, within ``_AMISS``
    tolerances [m/s], so did the acceleration.
    """
    second = world[4] > 0.0
    square = h * h
    xp, vp = x + h * v + square * _sum(_X0, n, a, past), v + h * _sum(_V0, n, a, past)
    yp, up, cp = y, u, c
    if second:
        yp, up = y + h * u + square * _sum(_X0, n, c, past_c), u + h * _sum(_V0, n, c, past_c)
        cp = second_acceleration(world, p, w, pull(world, xp, vp, yp, up), up)
    ap = acceleration(world, p, w, piece, drive, last, s, h, xp, vp, yp, up)
    beyond, rough = _differences(n, ap, a, past)
    x1, v1, a1 = xp + square * _X1[n] * beyond, vp + h * _V1[n] * beyond, ap
    y1, u1, c1 = yp, up, cp
    amiss = abs(beyond)
    if second:
        beyond, rough_c = _differences(n, cp, c, past_c)
        y1, u1 = yp + square * _X1[n] * beyond, up + h * _V1[n] * beyond
        rough, amiss = rough + rough_c, amiss + abs(beyond)
    error = _ERROR[n] * h * rough
    if error <= tolerance and h * _V1[n] * amiss > _AMISS * tolerance:
        a1 = acceleration(world, p, w, piece, drive, last, s, h, x1, v1, y1, u1)
        if second:
            c1 = second_acceleration(world, p, w, pull(world, x1, v1, y1, u1), u1)
    return x1, v1, a1, y1, u1, c1, error
