"""One run of the solver: parameters and a plan in, positions out."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.effects.law import COMMAND_LOOP, DELAY, LAG, PLAY, SECOND_MASS
from msd_ident.model.kernel import laws, places, segments
from msd_ident.model.kernel.compiled import give_up, inlined, joined, lean, plain
from msd_ident.model.kernel.exact import exact, longest_glide
from msd_ident.model.kernel.exponential import STIFF
from msd_ident.model.kernel.general import general, run_of
from msd_ident.model.kernel.groups import Axis, Cart, Command, Linear, Motion, Path, Segments, Spring, World
from msd_ident.model.kernel.rk import STAGES
from msd_ident.model.kernel.spring import characteristic

#: Radians a sample beyond which the second mass is joined to the first, unless a force acts on it alone: its own
#: motion is far beyond what samples show.
RIGID = 150.0
#: Damping [N·s/m] between the cart and a second mass, too light to be felt, that has the lagged velocity.
_WEIGHTLESS = 1e-60

_MASS, _DAMPING, _STIFFNESS = places.INDEX["mass"], places.INDEX["damping"], places.INDEX["stiffness"]
_PARAMETERS = len(places.INDEX)
_BACKLASH, (_GAP,) = places.structure(PLAY)
_ACTUATOR_LAG, (_LAG,) = places.structure(LAG)
_TIME_OFFSET, (_SHIFT,) = places.structure(DELAY)
_SECOND_MODE, _SECOND = places.structure(SECOND_MASS)
_HYSTERETIC, (_REMANENT, _CROSSED) = places.structure(COMMAND_LOOP)
_MEMORY = np.array(places.MEMORY_START)

#: Scale of the position where damping stops the mass at once, in parts of the way of a sample: that of the plant,
#: F·m/b², would vanish with the mass.
WAY = 0.3


@joined
def plan(time, force_time, force, straight):
    """What a record says before any parameter is known: (segments, their force, the largest force), see
    ``segments.merge``.

    ``pick`` is empty where the segment boundaries are the samples themselves.
    """
    command = Command(force_time, force, straight, 0.0)
    start, length, kind, force_index, pick, lengths = segments.merge(time, command)
    if start.size == time.size - 1:
        pick = np.empty(0, np.int64)
    level = np.empty(start.size)
    slope = np.empty(start.size if straight else 0)
    segments.force_lines(start, force_index, command, level, slope)
    largest = 0.0
    for f in force:
        largest = max(largest, abs(f))
    return start, length, kind, force_index, pick, lengths, level, slope, largest


@joined
def row(model, values, plan, allowed, out):
    """Simulate one parameter vector.

    Args:
        model: set of its effects, see ``places.BIT``, and (p,) where each of its parameters stands in ``places.INDEX``.
        values: (p + 3,) the model's parameters, then position [m] and velocity [m/s] at the first sample, and the zero.
        plan: the record and what ``plan`` made of it, see ``simulator.Simulator``.
        allowed: distance [m] from where it begins at which the general path gives the motion up, and factor on the
            errors that its steps may have.
        out: ``Path`` for the readings of the positions, NaN from where the motion leaves all bounds, and velocities.
    """
    bits, place = model
    time, largest = plan[0], plan[-1]
    p = np.zeros(_PARAMETERS)
    for i in range(place.size):
        p[place[i]] = values[i]
    motion = Motion(values[place.size], values[place.size + 1])
    bits = laws.active(bits, p)
    w = _MEMORY.copy()
    plant = Linear(p[_MASS], p[_DAMPING], p[_STIFFNESS])
    m, b, k = plant
    if not (m > 0.0 and abs(b) < math.inf and abs(k) < math.inf):
        give_up(out.x, 0)
        give_up(out.v, 0)
        return
    cut, pick = _on_the_cart(bits, p, w, plan)
    gap = p[_GAP] if bits & _BACKLASH else 0.0
    edges, lines = characteristic(k, gap, laws.knees(bits, p))
    spring = Spring(edges, lines)
    constant = laws.constant(bits, p, w)
    m2, k2, b2 = (p[_SECOND[0]], p[_SECOND[1]], p[_SECOND[2]]) if bits & _SECOND_MODE else (0.0, 0.0, 0.0)
    hangs = bits & _SECOND_MODE and not bits & places.SECOND_BITS
    if hangs and _rate_between(m, m2, k2, b2) * (time[-1] - time[0]) > RIGID * time.size:
        m, m2, k2, b2 = m + m2, 0.0, 0.0, 0.0
        bits &= ~_SECOND_MODE
    if bits & places.LAGGED_BITS and RIGID * time.size * p[places.RELAXATION_TIME] > time[-1] - time[0]:
        m2, b2 = _WEIGHTLESS * p[places.RELAXATION_TIME], _WEIGHTLESS
    world = World(Cart(bits, 1.0 / m, b, constant, m2, k2, b2), p, w, np.zeros(STAGES))
    path = _path(out, cut.start.size, pick)
    arriving = cut
    if bits & ~places.EXACT_BITS:
        scales = _scales(Linear(m, b, k), time, largest, motion)
        general(run_of(world, spring, scales, allowed), cut, motion, path)
    else:
        kinetic, hold = 0.0, 0.0
        if bits & places.DRY_BITS:
            kinetic, hold = laws.friction(bits, p, w, 0.0, 0.0, 0.0, 0.0), laws.breakaway(bits, p, w, 0.0, 0.0, 0.0)
        eventful = kinetic > 0.0 or hold > 0.0 or edges.size > 2
        axis = Axis(m, b, constant, kinetic, hold, spring, eventful)
        if eventful:
            cut = segments.walked_where_long(cut, longest_glide(axis))
        exact(axis, cut, motion, path)
    _sampled(pick, path, out)
    if bits & places.READING_BITS:
        _read(world, time, pick, arriving, out.x)


@plain
def compare(values, measured, readings):
    """Turn simulated readings into residuals (model + zero − measured) times a weight's root, if any are measured.

    Args:
        values: (p + 3,) of ``row``; the last one is the zero [m].
        measured: positions (n,) [m] or (0,), roots (n,) of the weights or (0,) for 1 each, the largest size of an
            error [m]: a simulation that diverges counts as this, and what ``row`` is ``allowed``.
        readings: (n,) [m], changed in place.
    """
    position, root, worst, _, _ = measured
    zero = values[-1]
    for j in range(position.size):
        error = readings[j] - position[j]
        if zero != 0.0:
            error += zero
        if not abs(error) <= worst:
            error = -worst if error < 0.0 else worst
        readings[j] = error * root[j] if root.size > 0 else error


@joined
def _path(out, segments, pick):
    """Room for the motion at the segment boundaries: the output itself where these are the samples (no ``pick``)."""
    if pick.size == 0:
        return out
    return Path(np.empty(segments + 1), np.empty(segments + 1 if out.v.size > 0 else 0))


@joined
def _on_the_cart(bits, p, w, plan):
    """Segments and the force on them that arrives at the cart: shifted, mapped and lagged where effects do so.

    Returns (segments, pick), see ``segments.merge``.
    """
    time, force_time, force, straight, start, length, kind, force_index, pick, lengths, level, slope, _ = plan
    shift = p[_SHIFT] if bits & _TIME_OFFSET else 0.0
    if shift != 0.0:
        moved = segments.merge(time, Command(force_time, force, straight, shift))
        start, length, kind, force_index, pick, lengths = moved
    timed = bits & places.TIMED_MAP_BITS
    if bits & places.MAP_BITS & ~places.TIMED_MAP_BITS:
        commanded, force = force, np.empty(force.size)
        for i in range(force.size):
            force[i] = laws.input_map(bits & ~places.TIMED_MAP_BITS, p, w, 0.0, commanded[i])
    if bits & _HYSTERETIC:
        force = _behind_loop(force, p[_REMANENT], p[_CROSSED])
    command = Command(force_time, force, straight, shift)
    if bits & (places.MAP_BITS | _TIME_OFFSET | _ACTUATOR_LAG | _HYSTERETIC):
        level = np.empty(start.size)
        slope = np.zeros(start.size if straight or timed else 0)
        segments.force_lines(start, force_index, command, level, slope)
    if timed:
        _drifted(timed, p, w, start, length, level, slope)
    transient, decay = np.empty(0), 0.0
    if bits & _ACTUATOR_LAG:
        transient, decay = np.empty(start.size), 1.0 / p[_LAG]
    cut = Segments(start, length, kind, lengths, level, slope, transient, decay)
    if bits & _ACTUATOR_LAG:
        segments.lag(cut, p[_LAG], segments.lagged_start(time[0], command, p[_LAG]))
    return cut, pick


@lean
def _drifted(timed, p, w, start, length, level, slope):
    """Force lines as laws that know the time make them: through their ends, a ramp's with the impulse that it has.

    A ramp times a gain that drifts is a parabola. The line with its impulse also has its first moment: beyond the
    segment only the third moment is lost.
    """
    for j in range(start.size):
        first = laws.input_map(timed, p, w, start[j], level[j])
        last = laws.input_map(timed, p, w, start[j] + length[j], level[j] + slope[j] * length[j])
        bend = 0.0
        if slope[j] != 0.0:
            half = 0.5 * length[j]
            bend = (first + last - 2.0 * laws.input_map(timed, p, w, start[j] + half, level[j] + slope[j] * half)) / 3.0
        level[j] = first - bend
        slope[j] = (last - first) / length[j]


@joined
def _behind_loop(commanded, half, crossed):
    """Commands [N] less what a drive with hysteresis keeps back: it begins in the middle of its loop."""
    made = np.empty(commanded.size)
    last, kept = 0.0, 0.0
    for i in range(commanded.size):
        change = commanded[i] - last
        if change != 0.0:
            side = 1.0 if change > 0.0 else -1.0
            kept = side + (kept - side) * math.exp(-abs(change) / crossed)
        last = commanded[i]
        made[i] = last - half * kept
    return made


@lean
def _sampled(pick, path, out):
    """The motion at the samples; without ``pick`` the path is the output itself."""
    if pick.size > 0:
        for i in range(out.x.size):
            out.x[i] = path.x[pick[i]]
        for i in range(out.v.size):
            out.v[i] = path.v[pick[i]]


@lean
def _read(world, time, pick, arriving, x):
    """Turn positions (n,) [m] at the samples into what the sensor says there.

    ``arriving`` are the segments with the force on the cart: at a jump the sensor hears the new one.
    """
    for i in range(x.size):
        force = _begins_with(arriving, pick[i] if pick.size > 0 else i)
        x[i] = laws.reading(world.cart.active, world.p, world.w, time[i], x[i], force)


@inlined
def _begins_with(cut, j):
    """Force [N] at the beginning of segment j, or at the end of the last one."""
    last = cut.start.size - 1
    after = 0.0
    if j > last:
        j, after = last, cut.length[last]
    force = cut.level[j]
    if cut.slope.size > 0:
        force += cut.slope[j] * after
    if cut.transient.size > 0:
        force += cut.transient[j] * math.exp(-cut.decay * after)
    return force


@lean
def _rate_between(m, m2, k2, b2):
    """Largest rate [1/s] of the motion of the two masses against each other."""
    lightness = 1.0 / m + 1.0 / m2
    return max(math.sqrt(k2 * lightness), b2 * lightness)


@lean
def _scales(plant, time, largest, motion):
    """Sizes of position [m] and velocity [m/s] that errors are compared with: of the linear plant's response to the
    largest force [N].
    """
    m, b, k = plant
    x, v = motion
    slowest = 2.0 * math.pi / (time[-1] - time[0])
    rate = max(math.sqrt(abs(k) / m), b / m, slowest)
    far = largest / (m * rate * rate)
    if k > 0.0:
        far = max(far, abs(x))
    far = max(far, abs(v) / rate)
    if far == 0.0:
        far = max(abs(x), 1e-12)
    fast, sample = far * rate, (time[-1] - time[0]) / (time.size - 1)
    if b / m * sample > STIFF:  # it goes on by a part of a sample's way
        far = max(far, WAY * fast * sample)
    return Motion(far, fast)
