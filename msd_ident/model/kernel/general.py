"""The general path: any smooth law, integrated step by step between located events.

While nothing happens each segment is one step, or a few even ones: from the accelerations of the steps before where the
force has gone on as it was, else of fourth order or of fifth. A segment with an event in it, or one that needs still
smaller steps, is left to ``passage``. Names: see ``rk``.
"""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

from msd_ident.model.kernel import laws, places
from msd_ident.model.kernel.adams import FEWEST, PAST, step_adams
from msd_ident.model.kernel.compiled import give_up, inlined, joined, lean
from msd_ident.model.kernel.exponential import becomes_stiff, is_stiff, second_is_stiff, step_exponential
from msd_ident.model.kernel.groups import (
    Drive,
    Longest,
    Pace,
    Phase,
    Piece,
    Place,
    Progress,
    Run,
    State,
    Tolerances,
    World,
)
from msd_ident.model.kernel.passage import RETRY, calm, lets_go, near_turn, passage, piece_of
from msd_ident.model.kernel.rk import (
    acceleration_at,
    beside,
    breakaway,
    forces_at,
    pull,
    second_acceleration,
    step4,
    step5,
)
from msd_ident.model.kernel.spring import piece

#: Estimated error of a step that is accepted, relative to the scales of position and velocity. Those of the Runge-Kutta
#: steps are of an order below the step's own, so the motion is better than this by far; that of Adams' is its own.
TOLERANCE4, TOLERANCE5, TOLERANCE_ADAMS = 1e-7, 5e-8, 3e-8
#: Steps are even when their lengths differ by no more than this part; and so little that they are the same but for
#: rounding.
_EVEN, _SAME = 1e-7, 1e-11
#: Steps in which a segment is cruised along, at most; and segments, at most, after which fewer are tried again, when
#: these were too few twice. Measured: on every third sample of a disc that swings (20 samples a swing) the passage,
#: which asks for events after every step, took 1.1 µs a sample for a tone or a second mass, and this takes 0.2.
MOST_PARTS, _PATIENT = 8, 1024
#: Steps that a run may take: so many a segment, and so many on top, which matter in short records. Beyond, the motion
#: is given up as NaN. Measured: on stretches of 200 samples the simulations of a search took 365 s with 100 000 on top,
#: and 130 s with these; of 104 drawn rigs the verdicts are the same.
STEPS_A_SEGMENT, STEPS = 120, 10_000


@inlined
def _drive(segments, j):
    """Force on segment j."""
    rise = segments.slope[j] if segments.slope.size > 0 else 0.0
    fade = segments.transient[j] if segments.transient.size > 0 else 0.0
    return Drive(segments.start[j], segments.level[j], rise, fade, segments.decay)


@inlined
def _part_of(drive, t, faded):
    """Force on the rest of a segment from a time t [s] on, when its transient has faded to this part."""
    start, f, r, e, decay = drive
    return Drive(start + t, f + r * t, r, e * faded, decay)


@inlined
def _jump(segments, j):
    """Change of the force [N] as segment j begins; a lagged one has none."""
    if j == 0 or segments.transient.size > 0:
        return 0.0
    level, slope = segments.level, segments.slope
    return level[j] - (level[j - 1] + (slope[j - 1] * segments.length[j - 1] if slope.size > 0 else 0.0))


@inlined
def _goes_on(j, segments):
    """Whether the force on segment j is the same held one as on the segment before."""
    level, slope = segments.level, segments.slope
    held = slope.size == 0 or (slope[j] == 0.0 and slope[j - 1] == 0.0)
    return held and level[j] == level[j - 1]


@inlined
def _pushed(drive, t, fade):
    """What ``applied`` gives, where exp(-decay t) is known."""
    _, f, r, e, _ = drive
    return f + r * t + e * fade


# fmt: off
@inlined
def _alone(
    fifth, world, p, w, elastic, drive, half, last, s, h, x, v, a, y, u, c, longest4, longest5, tolerances, k,
):
    # fmt: on
    """(accurate, x, v, a, y, u, c, longest4): a step made from its start alone, of fourth order or else of fifth.

    It is an exponential one where friction stops the second mass at once.
    """
    phase = Phase(World(world, p, w, k), Piece(0, 0.0, 0.0, elastic), drive, h, s)
    if world.active & places.SECOND_BITS and second_is_stiff(phase, h, State(x, v, a, y, u, c)):
        end, error_x, error_v = step_exponential(phase, 0.0, h, State(x, v, a, y, u, c))
        x1, v1, a1, y1, u1, c1 = end
        return error_x <= tolerances.x4 and error_v <= tolerances.v4, x1, v1, a1, y1, u1, c1, longest4
    if not fifth:
        middle = beside(world, p, w, _pushed(drive, 0.5 * h, half), drive.start + 0.5 * h)
        x1, v1, a1, y1, u1, c1, error_x, error_v = step4(
            world, p, w, elastic, drive, middle, last, s, 0.0, h, x, v, a, y, u, c
        )
        if error_x <= tolerances.x4 and error_v <= tolerances.v4:
            return True, x1, v1, a1, y1, u1, c1, longest4
        longest4 = 0.5 * h
    if h > longest5:
        return False, x, v, a, y, u, c, longest4
    end, error_x, error_v = step5(phase, 0.0, h, State(x, v, a, y, u, c))
    x1, v1, a1, y1, u1, c1 = end
    accurate = error_x <= tolerances.x5 and error_v <= tolerances.v5
    return accurate, x1, v1, a1, y1, u1, c1, longest4 * RETRY if accurate else longest4


@inlined
def _meets_event(s, piece, h, start):
    """Whether the cart seems to turn or to leave its piece of the spring within a time h: a parabola does."""
    ahead = start.x + h * (start.v + 0.5 * h * start.a)
    return not (s * (start.v + h * start.a) > 0.0 and piece.low <= ahead <= piece.high)


@inlined
def _later(value, past):
    """The past values one step later."""
    return value, past[0], past[1], past[2], past[3], past[4], past[5]


@inlined
def _jumped(run, segments, j, progress):
    """The state as segment j begins, of which only the acceleration may have jumped."""
    x, v, a, y, u, c = progress.state
    a += _jump(segments, j) * run.world.cart.lightness
    if run.world.cart.active & places.JUMPING_BITS:
        phase = Phase(run.world, piece_of(run.spring, progress.i), _drive(segments, j), segments.length[j], progress.s)
        a = acceleration_at(phase, 0.0, Place(x, v, y, u))
    return State(x, v, a, y, u, c)


@inlined
def _shorter(pace):
    """Segments in twice as many parts, after a step that was not accurate enough."""
    patience = pace.patience
    if pace.fewer:
        patience = min(2 * patience, _PATIENT) if pace.since <= patience else 1
    return Pace(2 * pace.parts, 0, 0, patience, False)


@inlined
def _was_cut(pace):
    """Whether segments are cut, or were but lately."""
    return pace.parts > 1 or (pace.fewer and pace.since <= pace.patience)


@inlined
def _onward(pace):
    """The part after one that is done; with the last of a segment, half as many are tried now and then."""
    parts, part, since, patience, fewer = pace
    if part + 1 < parts:
        return Pace(parts, part + 1, since, patience, fewer)
    if parts > 1 and since + 1 >= patience:
        return Pace(parts // 2, 0, 0, patience, True)
    return Pace(parts, 0, since + 1, patience, fewer)


@lean
def _cruise(run, j, segments, progress, path):
    """Segment after segment in one step each, or a few even ones, while nothing happens and the steps are accurate.

    Returns (j, progress) in front of the first segment of another kind.
    """
    state, s, i, (longest4, longest5), budget = progress
    (world, p, w, k), spring = run.world, piece_of(run.spring, i)
    elastic, length, decay = spring.elastic, segments.length, segments.decay
    tolerances, second = run.tolerances, world.m2 > 0.0
    most = 1 if world.active & places.SECOND_BITS else MOST_PARTS
    known, before, even, half, faded = 0, 0.0, 0.0, 1.0, 1.0
    past = past_c = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    pace, begun, first = Pace(1, 0, 0, 1, False), state, j
    while j < length.size:
        left = length[j] / pace.parts
        if decay > 0.0 and abs(left - even) > _SAME * left:
            even, half = left, math.exp(-0.5 * decay * left)
        here = state
        if pace.part == 0:
            begun, faded, here = state, 1.0, _jumped(run, segments, j, Progress(state, s, i, progress.longest, budget))
        drive = _part_of(_drive(segments, j), pace.part * left, faded)
        last = beside(world, p, w, _pushed(drive, left, half * half), drive.start + left)
        x, v, a, y, u, c = here
        turns = run.speedy and near_turn(length[j], v, a)  # where a law of the speed may change within a step
        if (run.eventful and _meets_event(s, spring, left, here)) or (turns and pace.parts > 1):
            break
        turning = run.quick and near_turn(left, v, a)
        fifth = turning or left > longest4
        goes_on = abs(left - before) <= _EVEN * left and (pace.part > 0 or _goes_on(j, segments))
        accurate, known, before = False, known if goes_on else 0, left
        if known >= FEWEST and not turning:
            x1, v1, a1, y1, u1, c1, error = step_adams(
                known, world, p, w, elastic, drive, last, s, left, x, v, a, y, u, c, past, past_c, tolerances.adams
            )
            accurate = error <= tolerances.adams
            if accurate:
                longest4 *= RETRY
            elif known == PAST and not fifth:
                known = 1
        if not accurate:
            accurate, x1, v1, a1, y1, u1, c1, longest4 = _alone(
                fifth, world, p, w, elastic, drive, half, last, s, left, x, v, a, y, u, c,
                longest4, longest5, tolerances, k,
            )  # fmt: skip
        end = State(x1, v1, a1, y1, u1, c1)
        phase = Phase(run.world, spring, drive, left, s)
        again = pace.parts < most and left > longest5 and (j == first or _was_cut(pace))
        if not (accurate or turns) and again and not becomes_stiff(phase, 0.0, left, here):
            pace, state = _shorter(pace), begun
            continue
        if not accurate or (run.eventful and not calm(s, spring, a, end)) or lets_go(phase, 0.0, left, here, end):
            break
        past, past_c = _later(a, past), _later(c, past_c) if second else past_c
        known, state, pace, faded = min(known + 1, PAST), end, _onward(pace), faded * half * half
        if pace.part == 0:
            j += 1
            path.x[j] = state.x
            if path.v.size > 0:
                path.v[j] = state.v
    return j, Progress(begun if pace.part > 0 else state, s, i, Longest(longest4, longest5), budget)


@joined
def _begin(run, drive, length, motion):
    """(state, direction, piece of the spring) of the first instant; at rest until a force says otherwise."""
    x, v = motion
    world, cart = run.world, run.world.cart
    laws.remember(cart.active, world.p, world.w, x, 0.0)
    s = (1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)) if run.eventful else 0.0
    i = piece(run.spring.edges, x, s)
    u = 0.0 if cart.active & places.LAGGED_BITS else v
    place = Place(x, v, x, u)
    a = 0.0
    if not run.eventful or s != 0.0:
        a = acceleration_at(Phase(world, piece_of(run.spring, i), drive, length, s), 0.0, place)
    return State(x, v, a, x, u, second_acceleration(cart, world.p, world.w, pull(cart, x, v, x, u), u)), s, i


@lean
def _held(run, j, segments, progress, path):
    """Segment after segment at rest, while friction holds the cart against a force that only the command changes.

    Returns (j, progress) in front of the first segment of another kind.
    """
    state, s, i, longest, budget = progress
    length, level = segments.length, segments.level
    out_x, out_v = path.x, path.v
    x, y, u = state.x, state.y, state.u
    piece, place, begun = piece_of(run.spring, i), Place(x, 0.0, y, u), j
    while j < length.size and budget > 1:
        drive = _drive(segments, j)
        if drive.r != 0.0 or drive.e != 0.0:
            break
        if j == begun or level[j] != level[j - 1]:
            phase = Phase(run.world, piece, drive, length[j], s)
            if not abs(forces_at(phase, 0.0, place)) <= breakaway(phase, 0.0, x):
                break
        budget -= 1
        j += 1
        out_x[j] = x
        if out_v.size > 0:
            out_v[j] = state.v
    if j > begun:
        state = State(x, state.v, 0.0, y, u, state.c)
    return j, Progress(state, s, i, longest, budget)


@inlined
def _tolerances(far, fast):
    """Accepted errors of steps beside a motion of this size [m], [m/s]."""
    return Tolerances(TOLERANCE4 * far, TOLERANCE4 * fast, TOLERANCE5 * far, TOLERANCE5 * fast, TOLERANCE_ADAMS * fast)


@joined
def run_of(world, spring, scales, allowed):
    """What stays the same during a run.

    ``scales``: sizes of the motion that errors are compared with; ``allowed``: see ``run.row``.
    """
    reach, slack = allowed
    active, far, fast = world.cart.active, scales.x, scales.v
    return Run(
        world,
        spring,
        (active & (places.DRY_BITS | places.TURNING_BITS)) != 0 or spring.edges.size > 2,
        (active & places.RESTLESS_BITS) != 0 or world.cart.m2 > 0.0,
        (active & places.QUICK_BITS) != 0,
        (active & (places.QUICK_BITS | places.SPEED_BITS)) != 0,
        min(1e12 * far, reach),
        _tolerances(slack * far, slack * fast),
    )


@lean
def general(run, segments, motion, path):
    """Positions (and velocities) at all segment boundaries, from ``motion`` on."""
    length = segments.length
    path.x[0] = motion.x
    if path.v.size > 0:
        path.v[0] = motion.v
    j = 0 * length.size  # not the constant 0, for which numba would compile all that takes j once more
    state, s, i = _begin(run, _drive(segments, j), length[j], motion)
    longest, budget = Longest(2.0 * length[0], 2.0 * length[0]), STEPS + STEPS_A_SEGMENT * length.size
    progress = Progress(state, s, i, longest, budget)
    while j < length.size:
        sliding = progress.s != 0.0 or not run.eventful
        if sliding and not is_stiff(run.world.cart, length[j]):
            j, progress = _cruise(run, j, segments, progress, path)
        elif not sliding and not run.restless:
            j, progress = _held(run, j, segments, progress, path)
        if j == length.size:
            break
        if sliding:
            _, s, i, longest, budget = progress
            progress = Progress(_jumped(run, segments, j, progress), s, i, longest, budget)
        progress = passage(run, _drive(segments, j), length[j], progress)
        j += 1
        x, v = progress.state.x, progress.state.v
        path.x[j] = x
        if path.v.size > 0:
            path.v[j] = v
        if not abs(x - motion.x) < run.far:
            give_up(path.x, j)
            give_up(path.v, j)
            break
