"""The general path: any smooth law, integrated step by step between located events.

While nothing happens each segment is one step: from the accelerations of the steps before where the force has gone on
as it was, else of fourth order or of fifth. A segment with an event in it, or one that needs smaller steps, is left to
``passage``. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel import laws
from msd_ident.model.kernel.adams import PAST, step_adams
from msd_ident.model.kernel.compiled import give_up, inlined, joined, lean, making
from msd_ident.model.kernel.passage import RETRY, calm, near_turn, passage, place_of
from msd_ident.model.kernel.rk import STAGES, acceleration_at, beside, second_acceleration, step4, step5
from msd_ident.model.kernel.spring import piece

#: Estimated error of a step that is accepted, relative to the scales of position and velocity. Those of the Runge-Kutta
#: steps are of an order below the step's own, so the motion is better than this by far; that of Adams' is its own.
TOLERANCE4, TOLERANCE5, TOLERANCE_ADAMS = 2e-7, 2e-8, 3e-8
#: Steps are even when their lengths differ by no more than this part; and so little that they are the same but for
#: rounding.
_EVEN, _SAME = 1e-7, 1e-11
#: Steps that a run may take: so many a segment, and so many on top. Beyond, the motion is given up as NaN.
STEPS_A_SEGMENT, STEPS = 120, 100_000


@inlined
def _drive(start, level, slope, transient, decay, j):
    """Force on segment j, see ``rk``."""
    rise = slope[j] if slope.size > 0 else 0.0
    return start[j], level[j], rise, transient[j] if transient.size > 0 else 0.0, decay


@inlined
def _jump(length, level, slope, transient, j):
    """Change of the force [N] as segment j begins; a lagged one has none."""
    if j == 0 or transient.size > 0:
        return 0.0
    return level[j] - (level[j - 1] + (slope[j - 1] * length[j - 1] if slope.size > 0 else 0.0))


@inlined
def _goes_on(j, length, level, slope):
    """Whether segment j is as long as the one before, and the force on it the same held one."""
    held = slope.size == 0 or (slope[j] == 0.0 and slope[j - 1] == 0.0)
    return held and level[j] == level[j - 1] and abs(length[j] - length[j - 1]) <= _EVEN * length[j]


@inlined
def _outside(world, p, w, drive, t, fade):
    """What ``outer`` gives, where exp(-decay t) is known."""
    start, f, r, e, _ = drive
    return beside(world, p, w, f + r * t + e * fade, start + t)


# fmt: off
@inlined
def _alone(
    fifth, world, p, w, place, drive, half, last, s, h, x, v, a, y, u, c, longest4, longest5, tolerances, k,
):
    # fmt: on
    """(accurate, x, v, a, y, u, c, longest4): a step made from its start alone, of fourth order or else of fifth."""
    if not fifth:
        middle = _outside(world, p, w, drive, 0.5 * h, half)
        x1, v1, a1, y1, u1, c1, error_x, error_v = step4(
            world, p, w, place, drive, middle, last, s, 0.0, h, x, v, a, y, u, c
        )
        if error_x <= tolerances[0] and error_v <= tolerances[1]:
            return True, x1, v1, a1, y1, u1, c1, longest4
        longest4 = 0.5 * h
    if h > longest5:
        return False, x, v, a, y, u, c, longest4
    x1, v1, a1, y1, u1, c1, error_x, error_v = step5(world, p, w, place, drive, s, 0.0, h, x, v, a, y, u, c, k)
    accurate = error_x <= tolerances[2] and error_v <= tolerances[3]
    return accurate, x1, v1, a1, y1, u1, c1, longest4 * RETRY if accurate else longest4


@inlined
def _later(value, past):
    """The past values one step later."""
    return value, past[0], past[1], past[2], past[3], past[4], past[5]


# fmt: off
@lean
def _cruise(
    j, world, p, w, place, low, high, eventful, quick, start, length, level, slope, transient, decay,
    x, v, a, y, u, c, s, longest4, longest5, tolerances, k, out_x, out_v,
):
    # fmt: on
    """Segment after segment in one step each, while nothing happens and the step is accurate.

    Returns (j, x, v, a, y, u, c, longest4) in front of the first segment of another kind.
    """
    keep, second = out_v.size > 0, world[4] > 0.0
    known, even, half = 0, 0.0, 1.0
    past = past_c = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    while j < length.size:
        left = length[j]
        drive = _drive(start, level, slope, transient, decay, j)
        if decay > 0.0 and abs(left - even) > _SAME * left:
            even, half = left, math.exp(-0.5 * decay * left)
        last = _outside(world, p, w, drive, left, half * half)
        # Position and velocity go on smoothly, so only the force can have jumped.
        a0 = a + _jump(length, level, slope, transient, j) * world[1]
        if world[0] & laws.DRIVEN_BITS:  # the drive may go on or off as the segment begins
            a0 = acceleration_at(world, p, w, place, drive, s, 0.0, x, v, y, u)
        turning = quick and near_turn(left, v, a0)
        fifth = turning or left > longest4
        known = known if known > 0 and _goes_on(j, length, level, slope) else 0
        accurate = False
        if known == PAST and not turning:
            x1, v1, a1, y1, u1, c1, error = step_adams(
                world, p, w, place, drive, last, s, left, x, v, a0, y, u, c, past, past_c, tolerances[4]
            )
            accurate = error <= tolerances[4]
            if accurate:
                longest4 *= RETRY
            elif not fifth:
                known = PAST - 3
        if not accurate:
            accurate, x1, v1, a1, y1, u1, c1, longest4 = _alone(
                fifth, world, p, w, place, drive, half, last, s, left, x, v, a0, y, u, c,
                longest4, longest5, tolerances, k,
            )  # fmt: skip
        if not accurate:
            break
        if eventful and not calm(s, low, high, a0, x1, v1, a1):
            break
        past = _later(a0, past)
        if second:
            past_c = _later(c, past_c)
        known = min(known + 1, PAST)
        x, v, a, y, u, c = x1, v1, a1, y1, u1, c1
        j += 1
        out_x[j] = x
        if keep:
            out_v[j] = v
    return j, x, v, a, y, u, c, longest4


@joined
def _begin(world, p, w, edges, springs, drive, eventful, x, v):
    """(direction, piece of the spring, acceleration) of the first instant; at rest until a force says otherwise."""
    laws.remember(world[0], p, w, x, 0.0)
    s = (1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)) if eventful else 0.0
    i = piece(edges, x, s)
    if eventful and s == 0.0:
        return s, i, 0.0
    return s, i, acceleration_at(world, p, w, place_of(springs, i), drive, s, 0.0, x, v, x, v)


@making
def general(
    active, p, w, m, b, edges, springs, constant, second, start, length, level, slope, transient, decay,
    x, v, scales, out_x, out_v,
):  # fmt: skip
    """Positions (and velocities) at all segment boundaries.

    Args:
        active, p, w: set of effects, parameters, memory.
        edges, springs: knees of the spring and its pieces, see ``spring.characteristic``.
        constant: force [N] against +x.
        second: (m2, k2, b2) of the second mass; m2 = 0 without one.
        start, length: of each segment [s].
        level, slope, transient, decay: force on each, see ``exact``.
        scales: sizes [m] and [m/s] that errors are compared with.
    """
    keep = out_v.size > 0
    eventful = (active & (laws.DRY_BITS | laws.TURNING_BITS)) != 0 or edges.size > 2
    restless = (active & laws.RESTLESS_BITS) != 0 or second[0] > 0.0
    quick = (active & laws.QUICK_BITS) != 0
    world = (active, 1.0 / m, b, constant, second[0], second[1], second[2])
    held = (active, 0.0, b, constant, second[0], second[1], second[2])
    tolerances = (
        TOLERANCE4 * scales[0], TOLERANCE4 * scales[1], TOLERANCE5 * scales[0], TOLERANCE5 * scales[1],
        TOLERANCE_ADAMS * scales[1],
    )  # fmt: skip
    k = np.zeros(STAGES)
    out_x[0] = x
    if keep:
        out_v[0] = v
    j = 0 * length.size  # not the constant 0, for which numba would compile all that takes j once more
    drive = _drive(start, level, slope, transient, decay, j)
    s, i, a = _begin(world, p, w, edges, springs, drive, eventful, x, v)
    y, u, c = x, v, second_acceleration(world, x, v, x, v)
    longest4, longest5, budget = 2.0 * length[0], 2.0 * length[0], STEPS + STEPS_A_SEGMENT * length.size
    while True:
        if s != 0.0 or not eventful:
            j, x, v, a, y, u, c, longest4 = _cruise(
                j, world, p, w, place_of(springs, i), edges[i], edges[i + 1], eventful, quick,
                start, length, level, slope, transient, decay,
                x, v, a, y, u, c, s, longest4, longest5, tolerances, k, out_x, out_v,
            )  # fmt: skip
        if j == length.size:
            break
        drive = _drive(start, level, slope, transient, decay, j)
        if s != 0.0 or not eventful:
            a += _jump(length, level, slope, transient, j) / m
            if active & laws.DRIVEN_BITS:
                a = acceleration_at(world, p, w, place_of(springs, i), drive, s, 0.0, x, v, y, u)
        x, v, a, y, u, c, s, i, longest4, longest5, budget = passage(
            world, held, p, w, edges, springs, drive, length[j], eventful, restless, quick,
            (x, v, a, y, u, c, s, i, longest4, longest5, budget), tolerances, k,
        )  # fmt: skip
        j += 1
        out_x[j] = x
        if keep:
            out_v[j] = v
        if not abs(x) < 1e12 * scales[0]:
            give_up(out_x, j)
            give_up(out_v, j)
            break
