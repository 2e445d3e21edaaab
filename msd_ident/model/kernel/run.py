"""One run of the solver: parameters and a plan in, positions out."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.effects.base import DELAY, LAG, PLAY, SECOND_MASS
from msd_ident.model.kernel import laws, segments
from msd_ident.model.kernel.compiled import give_up, joined, lean
from msd_ident.model.kernel.exact import exact
from msd_ident.model.kernel.general import general
from msd_ident.model.kernel.spring import characteristic

#: Radians a sample beyond which the second mass is joined to the first: its own motion is far beyond what samples show.
RIGID = 150.0

_MASS, _DAMPING, _STIFFNESS = laws.INDEX["mass"], laws.INDEX["damping"], laws.INDEX["stiffness"]
_PARAMETERS = len(laws.INDEX)
_BACKLASH, (_GAP,) = laws.structure(PLAY, 1)
_ACTUATOR_LAG, (_LAG,) = laws.structure(LAG, 1)
_TIME_OFFSET, (_SHIFT,) = laws.structure(DELAY, 1)
_SECOND_MODE, _SECOND = laws.structure(SECOND_MASS, 3)
_MEMORY = np.array(laws.MEMORY_START)


@joined
def plan(time, force_time, force, straight):
    """What a record says before any parameter is known: (segments, their force), see ``segments.merge``.

    ``pick`` is empty where the segment boundaries are the samples themselves.
    """
    start, length, kind, force_index, pick, lengths = segments.merge(time, force_time, force, straight, 0.0)
    if start.size == time.size - 1:
        pick = np.empty(0, np.int64)
    level = np.empty(start.size)
    slope = np.empty(start.size if straight else 0)
    segments.force_lines(start, force_index, force_time, 0.0, force, straight, level, slope)
    return start, length, kind, force_index, pick, lengths, level, slope


@joined
def row(bits, values, place, plan, out_x, out_v):
    """Simulate one parameter vector.

    Args:
        bits: set of the model's effects, see ``laws.BIT``.
        values: (p + 2,) the model's parameters, then position [m] and velocity [m/s] at the first sample.
        place: (p,) where each parameter stands in ``laws.INDEX``.
        plan: the record and what ``plan`` made of it, see ``simulator.Simulator``.
        out_x: (n,) readings of the positions [m]; NaN from where the motion leaves all bounds.
        out_v: (n,) velocities [m/s], or (0,) when nobody wants them.
    """
    time, force = plan[0], plan[2]
    p = np.zeros(_PARAMETERS)
    for i in range(place.size):
        p[place[i]] = values[i]
    x, v = values[place.size], values[place.size + 1]
    bits = laws.active(bits, p)
    w = _MEMORY.copy()
    m, b, k = p[_MASS], p[_DAMPING], p[_STIFFNESS]
    if not (m > 0.0 and abs(b) < math.inf and abs(k) < math.inf):
        give_up(out_x, 0)
        give_up(out_v, 0)
        return
    start, length, kind, pick, lengths, level, slope, transient, decay = _on_the_cart(bits, p, w, plan)
    gap = p[_GAP] if bits & _BACKLASH else 0.0
    edges, springs = characteristic(k, gap, laws.knees(bits, p))
    constant = laws.constant(bits, p, w)
    second = (p[_SECOND[0]], p[_SECOND[1]], p[_SECOND[2]]) if bits & _SECOND_MODE else (0.0, 0.0, 0.0)
    if bits & _SECOND_MODE and _rate_between(m, second) * (time[-1] - time[0]) > RIGID * time.size:
        m, second = m + second[0], (0.0, 0.0, 0.0)
        bits &= ~_SECOND_MODE
    direct = pick.size == 0
    path_x = out_x if direct else np.empty(start.size + 1)
    path_v = out_v if direct else np.empty(start.size + 1 if out_v.size > 0 else 0)
    if bits & ~laws.EXACT_BITS:
        general(
            bits, p, w, m, b, edges, springs, constant, second, start, length, level, slope, transient, decay,
            x, v, _scales(m, b, k, time, force, x, v), path_x, path_v,
        )  # fmt: skip
    else:
        kinetic, hold = 0.0, 0.0
        if bits & laws.DRY_BITS:
            kinetic, hold = laws.friction(bits, p, w, 0.0, 0.0, 0.0), laws.breakaway(bits, p, w, 0.0, 0.0)
        exact(
            (m, b, constant, kinetic, hold), edges, springs[0], springs[1],
            length, kind, lengths, level, slope, transient, decay, x, v, path_x, path_v,
        )  # fmt: skip
    _read(bits, p, w, time, pick, path_x, path_v, out_x, out_v)


@joined
def _on_the_cart(bits, p, w, plan):
    """Segments and the force on them that arrives at the cart: shifted, mapped and lagged where effects do so.

    Returns (start, length, kind, pick, lengths, level, slope, transient, decay), see ``segments.merge`` and ``exact``.
    """
    time, force_time, force, straight, start, length, kind, force_index, pick, lengths, level, slope = plan
    shift = p[_SHIFT] if bits & _TIME_OFFSET else 0.0
    if shift != 0.0:
        start, length, kind, force_index, pick, lengths = segments.merge(time, force_time, force, straight, shift)
    if bits & laws.MAP_BITS:
        commanded, force = force, np.empty(force.size)
        for i in range(force.size):
            force[i] = laws.input_map(bits, p, w, commanded[i])
    if bits & (laws.MAP_BITS | _TIME_OFFSET | _ACTUATOR_LAG):
        level = np.empty(start.size)
        slope = np.empty(start.size if straight else 0)
        segments.force_lines(start, force_index, force_time, shift, force, straight, level, slope)
    transient, decay = np.empty(0), 0.0
    if bits & _ACTUATOR_LAG:
        transient, decay = np.empty(start.size), 1.0 / p[_LAG]
        at_start = segments.lagged_start(time[0], force_time, shift, force, straight, p[_LAG])
        segments.lag(length, p[_LAG], at_start, level, slope, transient)
    return start, length, kind, pick, lengths, level, slope, transient, decay


@lean
def _read(bits, p, w, time, pick, path_x, path_v, out_x, out_v):
    """What the sensor says at the samples; without ``pick`` the path is the output itself."""
    if pick.size > 0:
        for i in range(out_x.size):
            out_x[i] = path_x[pick[i]]
        for i in range(out_v.size):
            out_v[i] = path_v[pick[i]]
    if bits & laws.READING_BITS:
        for i in range(out_x.size):
            out_x[i] = laws.reading(bits, p, w, time[i], out_x[i])


@lean
def _rate_between(m, second):
    """Largest rate [1/s] of the motion of the two masses against each other."""
    m2, k2, b2 = second
    lightness = 1.0 / m + 1.0 / m2
    return max(math.sqrt(k2 * lightness), b2 * lightness)


@lean
def _scales(m, b, k, time, force, x, v):
    """Sizes of position [m] and velocity [m/s] that errors are compared with: of the linear plant's response."""
    slowest = 2.0 * math.pi / (time[-1] - time[0])
    rate = max(math.sqrt(abs(k) / m), b / m, slowest)
    largest = 0.0
    for f in force:
        largest = max(largest, abs(f))
    far = largest / (m * rate * rate)
    if k > 0.0:
        far = max(far, abs(x))
    far = max(far, abs(v) / rate)
    if far == 0.0:
        far = max(abs(x), 1e-12)
    return far, far * rate
