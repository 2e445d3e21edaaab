"""The methods of the general path, by number: one function that steps with any of them. Names: see ``rk``."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

from msd_ident.model.kernel.compiled import lean
from msd_ident.model.kernel.exponential import step_exponential
from msd_ident.model.kernel.groups import State
from msd_ident.model.kernel.rk import outer, step4, step5

FOURTH, FIFTH, EXPONENTIAL = 0, 1, 2


@lean
def step_to(method, phase, t, h, start):
    """(state, error of position [m], of velocity [m/s]) of a step by this method."""
    if method == EXPONENTIAL:
        return step_exponential(phase, t, h, start)
    if method == FIFTH:
        return step5(phase, t, h, start)
    world, spring, drive, _, s = phase
    cart, p, w, _ = world
    x, v, a, y, u, c = start
    middle, last = outer(cart, p, w, drive, t + 0.5 * h), outer(cart, p, w, drive, t + h)
    x, v, a, y, u, c, error_x, error_v = step4(
        cart, p, w, spring.elastic, drive, middle, last, s, t, h, x, v, a, y, u, c
    )
    return State(x, v, a, y, u, c), error_x, error_v
