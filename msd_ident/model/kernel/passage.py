"""One segment of the general path, from event to event.

It is one step of fourth order where that is accurate enough, else steps of fifth order of even lengths, or exponential
ones where damping stops the mass at once. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import laws, places
from msd_ident.model.kernel.compiled import inlined, joined, lean
from msd_ident.model.kernel.events import EASY, knee, release, rest, slowest, turn
from msd_ident.model.kernel.exponential import becomes_stiff, is_stiff, second_is_stiff
from msd_ident.model.kernel.groups import Elastic, Longest, Phase, Piece, Place, Progress, State, Step
from msd_ident.model.kernel.methods import EXPONENTIAL, FIFTH, FOURTH, step_to
from msd_ident.model.kernel.rk import acceleration_at, breakaway, forces_at, grip_at, pull, second_acceleration
from msd_ident.model.kernel.spring import piece

#: Events in one segment after which the rest of it is passed over: a motion too small to matter.
EVENTS = 200
_SHORTEST = 1e-10
#: After so much of a segment the force is looked at again that was just 0 when the cart broke away.
_SOON = 1e-6
#: Growth, each fifth-order step, of the step that fourth order may take: now and then it is worth another try.
RETRY = 1.02
_NONE, _TURN, _KNEE, _AGAIN, _RELEASE = 0, 1, 2, 3, 4


@lean
def _settle(phase, t, state):
    """Direction in which a cart at v = 0 goes on; 0 if dry friction holds it."""
    net = forces_at(phase, t, Place(state.x, 0.0, state.y, state.u))
    if abs(net) <= breakaway(phase, t, state.x):
        return 0.0
    return 1.0 if net > 0.0 else -1.0


@lean
def _leave(phase, t, state):
    """Direction in which a cart breaks away at t: of the force then, or shortly after if it is just 0."""
    place = Place(state.x, 0.0, state.y, state.u)
    net = forces_at(phase, t, place)
    if net == 0.0:
        net = forces_at(phase, t + _SOON * phase.length, place)
    return 1.0 if net > 0.0 else -1.0


@inlined
def calm(s, piece, a, end):
    """Whether a step from acceleration a to ``end`` went on in direction s on this piece without any event."""
    return s * end.v > 0.0 and piece.low <= end.x <= piece.high and (s * a >= 0.0 or s * end.a <= 0.0)


@lean
def lets_go(phase, t, h, start, end):
    """Whether another formula of a stop's force holds at the end of a step than at its start."""
    if not phase.world.cart.active & places.GRIP_BITS:
        return False
    before = grip_at(phase, t, Place(start.x, start.v, start.y, start.u))
    return (before > 0.0) != (grip_at(phase, t + h, Place(end.x, end.v, end.y, end.u)) > 0.0)


@inlined
def near_turn(left, v, a):
    """Whether the cart turns about within the segment: there a ``quick`` law asks for fifth order."""
    return abs(v) < 2.0 * abs(a) * left


@inlined
def piece_of(spring, i):
    """Piece i of the spring."""
    edges, lines = spring
    return Piece(i, edges[i], edges[i + 1], Elastic(lines[0, i], lines[1, i], lines[2, i], lines[3, i], lines[4, i]))


@lean
def _first_event(phase, step):
    """The first event in a step: (event, length, state at the event, or at the end of the step without one).

    ``_AGAIN``: the step begins at rest and ends beyond its next turn; a shorter one must be tried.
    """
    method, t, h, start, end = step
    s = phase.s
    event = _NONE
    if start.v == 0.0 and not s * end.v > 0.0:
        return _AGAIN, h, end
    edge = phase.piece.high if s > 0.0 else phase.piece.low
    beyond = s * (end.x - edge) > 0.0
    if s * end.v > 0.0 and s * start.a < 0.0 and s * end.a > 0.0:
        dip = slowest(h, s * start.v, s * start.a, s * end.v, s * end.a)
        there, _, _ = step_to(method, phase, t, dip, start)
        if s * there.v <= 0.0:
            h, end = dip, there
            beyond = s * (end.x - edge) > 0.0
    if not (s * end.v > 0.0 or beyond):
        event = _TURN
        h, there = turn(phase, Step(method, t, h, start, end))
        end = State(there.x, 0.0, there.a, there.y, there.u, there.c)
        beyond = s * (end.x - edge) > 0.0
    if beyond:
        event = _KNEE
        h, there = knee(phase, Step(method, t, h, start, end), edge)
        v = there.v if s * there.v > 0.0 else 0.0
        end = State(edge, v, there.a, there.y, there.u, there.c)
    if h > _SOON * phase.length and lets_go(phase, t, h, start, end):
        sooner, there = release(phase, Step(method, t, h, start, end))
        if sooner < h:
            event, h, end = _RELEASE, sooner, there
    return event, h, end


@joined
def _attempt(run, phase, t, longest, start):
    """(step towards the end of the segment, its error in parts of what is allowed)."""
    left, allowed = phase.length - t, run.tolerances
    method, h = FOURTH, left
    if is_stiff(run.world.cart, left) or second_is_stiff(phase, left, start):
        method = EXPONENTIAL
    elif left > longest.fourth or (run.quick and near_turn(left, start.v, start.a)):
        method = EXPONENTIAL if becomes_stiff(phase, t, left, start) else FIFTH
    if method != FOURTH and left > longest.fifth:
        h = left / math.ceil(left / longest.fifth)
    end, error_x, error_v = step_to(method, phase, t, h, start)
    step = Step(method, t, h, start, end)
    if method == FIFTH:
        return step, max(error_x / allowed.x5, error_v / allowed.v5)
    return step, max(error_x / allowed.x4, error_v / allowed.v4)


@joined
def _adapt(step, error, longest):
    """The longest steps that either method may take next; exponential ones are limited as those of fifth order."""
    fourth, fifth = longest
    if not error <= 1.0:
        shorter = step.h * (max(0.2, 0.9 * error**-0.2) if error < 1e12 else 0.2)
        return Longest(shorter, fifth) if step.method == FOURTH else Longest(fourth, shorter)
    if step.method != FOURTH:
        fourth *= RETRY
        if error < EASY:
            fifth = max(fifth, 2.0 * step.h)
    return Longest(fourth, fifth)


@joined
def _after(event, run, phase, t, state):
    """(direction, piece of the spring, state with its accelerations) after a turn or at a knee."""
    world, came, drive, length, s = phase
    i, (cart, p, w, _) = came.i, world
    x, v, _, y, u, _ = state
    if event == _TURN:
        laws.remember(cart.active, p, w, x, s)
        s = _settle(Phase(world, came, drive, length, 0.0), t, state)
        i = piece(run.spring.edges, x, s)
    else:
        i += 1 if s > 0.0 else -1
    a = 0.0
    if s != 0.0:
        a = acceleration_at(Phase(world, piece_of(run.spring, i), drive, length, s), t, Place(x, v, y, u))
    return s, i, State(x, v, a, y, u, second_acceleration(cart, p, w, pull(cart, x, v, y, u), u))


@joined
def _stay(run, phase, t, longest, state):
    """A stretch of rest: (time when it ends, whether the cart leaves, direction, piece, state, longest)."""
    world, held_by, drive, length, _ = phase
    wait, leaves, there, longest = rest(run, phase, t, longest, state)
    x, y, u, c = there.x, there.y, there.u, there.c
    t = length if wait >= length - t else t + wait
    if not leaves:
        return t, False, 0.0, held_by.i, State(x, state.v, 0.0, y, u, c), longest
    s = _leave(phase, t, there)
    i = piece(run.spring.edges, x, s)
    a = acceleration_at(Phase(world, piece_of(run.spring, i), drive, length, s), t, Place(x, 0.0, y, u))
    return t, True, s, i, State(x, state.v, a, y, u, c), longest


@lean
def passage(run, drive, length, progress):
    """The progress at the end of one segment; position NaN where the motion runs away."""
    state, s, i, longest, budget = progress
    t, events = 0.0, 0
    while t < length and events <= EVENTS and budget > 0:
        budget -= 1
        phase = Phase(run.world, piece_of(run.spring, i), drive, length, s)
        if run.eventful and s == 0.0:
            t, leaves, s, i, state, fifth = _stay(run, phase, t, longest.fifth, state)
            longest = Longest(longest.fourth, fifth)
            events += leaves
            continue
        left = length - t
        step, error = _attempt(run, phase, t, longest, state)
        h = step.h
        longest = _adapt(step, error, longest)
        if not error <= 1.0:
            if h < _SHORTEST * length:
                budget = 0
            continue
        event, end = _NONE, step.end
        if run.eventful and not (calm(s, phase.piece, state.a, end) and not lets_go(phase, t, h, state, end)):
            event, h, end = _first_event(phase, step)
            events += event != _NONE
            if event == _AGAIN:
                if h > 1e-6 * length and events < EVENTS:
                    longest = Longest(min(longest.fourth, 0.5 * h), 0.5 * h)
                    continue
                event, end = _TURN, State(end.x, 0.0, end.a, end.y, end.u, end.c)
        state = end
        t = length if h >= left else t + h
        if event in (_TURN, _KNEE):
            s, i, state = _after(event, run, phase, t, state)
            if event == _KNEE:  # beyond it the motion may be slower
                longest = Longest(2.0 * length, longest.fifth)
    if budget <= 0:
        state = State(math.nan, state.v, state.a, state.y, state.u, state.c)
    return Progress(state, s, i, longest, budget)
