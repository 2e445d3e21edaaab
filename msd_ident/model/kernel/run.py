"""One run of the solver: parameters and a plan in, positions out."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.model.kernel import laws, segments
from msd_ident.model.kernel.compiled import lean, making
from msd_ident.model.kernel.exact import exact
from msd_ident.model.kernel.general import general
from msd_ident.model.kernel.spring import characteristic

#: Argument lists of the entries; ``cache`` writes the entry module from them.
PLAN = "time, force_time, force, straight"
RUN = "bits, rows, plan, out_x, out_v"

_MASS, _DAMPING, _STIFFNESS = laws.INDEX["mass"], laws.INDEX["damping"], laws.INDEX["stiffness"]
_GAP = laws.INDEX.get("backlash_half_width", 0)
_STOP, _STOP_K = laws.INDEX.get("stop_position", 0), laws.INDEX.get("stop_stiffness", 0)
_LAG, _SHIFT = laws.INDEX.get("lag_time", 0), laws.INDEX.get("time_offset", 0)
_SECOND = tuple(laws.INDEX.get(name, 0) for name in ("second_mass", "second_stiffness", "second_damping"))
_SECOND_MODE = laws.bits("second_mode")
_MEMORY = np.array(laws.MEMORY_START)
_BACKLASH, _END_STOP = laws.bits("backlash"), laws.bits("end_stop")
_ACTUATOR_LAG, _TIME_OFFSET = laws.bits("actuator_lag"), laws.bits("time_offset")


@making
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


@making
def run(bits, rows, plan, out_x, out_v):
    """Simulate r parameter vectors one after the other.

    Args:
        bits: set of the model's effects, see ``laws.BIT``.
        rows: (r, len(laws.INDEX) + 2) all parameters of the library, those of other effects unused, then position [m]
            and velocity [m/s] at the first sample.
        plan: the record and what ``plan`` made of it, see ``simulator.Simulator``.
        out_x: (r, n) readings of the positions [m]; NaN from where the motion leaves all bounds.
        out_v: (r, n) velocities [m/s], or (r, 0) when nobody wants them.
    """
    for row in range(rows.shape[0]):
        _simulate(bits, rows[row], plan, rows[row, -2], rows[row, -1], out_x[row], out_v[row])


@making
def _simulate(bits, p, plan, x, v, out_x, out_v):
    """One row of ``run``."""
    time, force_time, force, straight, start, length, kind, force_index, pick, lengths, level, slope = plan
    bits = laws.active(bits, p)
    w = _MEMORY.copy()
    m, b, k = p[_MASS], p[_DAMPING], p[_STIFFNESS]
    if not (m > 0.0 and abs(b) < math.inf and abs(k) < math.inf):
        out_x[:] = math.nan
        out_v[:] = math.nan
        return
    shift = p[_SHIFT] if bits & _TIME_OFFSET else 0.0
    if shift != 0.0:
        start, length, kind, force_index, pick, lengths = segments.merge(time, force_time, force, straight, shift)
    if bits & laws.MAP_BITS:
        mapped = np.empty_like(force)
        for i in range(force.size):
            mapped[i] = laws.input_map(bits, p, w, force[i])
        force = mapped
    if bits & (laws.MAP_BITS | _TIME_OFFSET | _ACTUATOR_LAG):
        level = np.empty(start.size)
        slope = np.empty(start.size if straight else 0)
        segments.force_lines(start, force_index, force_time, shift, force, straight, level, slope)
    transient, decay = np.empty(0), 0.0
    if bits & _ACTUATOR_LAG:
        transient, decay = np.empty(start.size), 1.0 / p[_LAG]
        at_start = segments.before(time[0], force_time, shift, force, straight)
        segments.lag(length, p[_LAG], at_start, level, slope, transient)
    gap = p[_GAP] if bits & _BACKLASH else 0.0
    stop, stop_k = (p[_STOP], p[_STOP_K]) if bits & _END_STOP else (math.inf, 0.0)
    edges, springs = characteristic(k, gap, stop, stop_k)
    constant = laws.constant(bits, p, w)
    direct = pick.size == 0
    path_x = out_x if direct else np.empty(start.size + 1)
    path_v = out_v if direct else np.empty(start.size + 1 if out_v.size > 0 else 0)
    if bits & ~laws.EXACT_BITS:
        second = (p[_SECOND[0]], p[_SECOND[1]], p[_SECOND[2]]) if bits & _SECOND_MODE else (0.0, 0.0, 0.0)
        far, fast = _scales(m, b, k, time, force, x, v)
        general(
            bits, p, w, m, b, edges, springs, constant, second, start, length, level, slope, transient, decay,
            x, v, far, fast, path_x, path_v,
        )  # fmt: skip
    else:
        kinetic, hold = 0.0, 0.0
        if bits & laws.DRY_BITS:
            kinetic, hold = laws.friction(bits, p, w, 0.0, 0.0), laws.breakaway(bits, p, w, 0.0)
        exact(
            m, b, (edges, springs[0], springs[1]), constant, kinetic, hold,
            (length, kind, lengths), (level, slope, transient), decay, x, v, path_x, path_v,
        )  # fmt: skip
    if not direct:
        for i in range(out_x.size):
            out_x[i] = path_x[pick[i]]
        for i in range(out_v.size):
            out_v[i] = path_v[pick[i]]
    if bits & laws.READING_BITS:
        for i in range(out_x.size):
            out_x[i] = laws.reading(bits, p, w, time[i], out_x[i])


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
