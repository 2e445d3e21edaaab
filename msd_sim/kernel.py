"""The rig's equation of motion and its integrator: tight tolerances, every event located.

    m x'' = F(t) - b x' - spring(x) - ... - dry friction,    and x' = 0 while the cart sticks.

Between two events the right-hand side is smooth: the direction of motion, the side of every position edge (dead zone,
end stops, ...) and the side of every instant at which something changes are frozen in ``Mode``, and stay frozen even
where a trial step looks beyond them. So an eighth-order Runge-Kutta step (DOP853: Hairer, Norsett & Wanner, "Solving
Ordinary Differential Equations I", II.5, with SciPy's tableau) keeps its order, and an event is a root in the length of
the step: reversal (v = 0), edge (x = edge), breakaway (|other forces| = static friction).

The actuator's lag and the Bouc-Wen variable are not integrated at all: between two force values the lag has a closed
form in t, and between two reversals Bouc-Wen has one in x.

All compiled code stands in this one file: numba's cache looks only at the file of the function that it compiled.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.integrate import DOP853

FloatArray = npt.NDArray[np.float64]

#: Truth as the compiled code sees it; an absent effect has strength 0. Meaning and units: ``effects.py``. No step may
#: go further than ``longest_move`` [m] or take longer than ``longest_step`` [s], lest it leaps over a force unseen.
_NAMES = [
    *("mass", "damping", "stiffness", "coulomb_force", "static_force"),
    *("stribeck_coulomb", "stribeck_static", "stribeck_velocity", "position_coulomb", "position_slope"),
    *("eccentric_coulomb", "eccentric_ratio", "eccentric_pitch", "early_coulomb", "late_coulomb", "change_time"),
    *("fading_coulomb", "fading_time", "drag_coefficient", "cubic_stiffness", "quadratic_stiffness"),
    *("backlash_half_width", "stop_position", "stop_stiffness", "offset_force", "lag_time"),
    *("hysteresis_force", "hysteresis_length", "disturbance_amplitude", "disturbance_frequency", "disturbance_phase"),
    *("cogging_amplitude", "cogging_pitch", "cogging_phase", "stiffness_drift_rate"),
    *("second_mass", "second_stiffness", "second_damping", "creep_stiffness", "creep_time"),
    *("dropped_mass", "drop_time", "magnet_strength", "magnet_position", "magnet_gap"),
    *("cable_damping", "cable_start", "cable_end", "rational_coulomb", "rational_static", "rational_velocity"),
    *("exponential_coulomb", "exponential_static", "exponential_velocity", "load_coulomb", "load_ratio"),
    *("one_stop_position", "one_stop_stiffness", "soft_stop_position", "soft_stop_stiffness", "soft_stop_damping"),
    *("power_drag", "up_damping", "driven_damping", "slow_brake_damping", "slow_brake_time"),
    *("bend_position", "bend_stiffness", "gain_drift_rate"),
    *("settling_ratio", "settling_time", "low_tone_amplitude", "low_tone_frequency"),
    *("high_tone_amplitude", "high_tone_frequency", "longest_move", "longest_step"),
]
PARAMETERS = np.dtype([(name, np.float64) for name in _NAMES])
_FLOATS = ["t", "step", "direction", "x_side", "t_side", "anchor_x", "anchor_z"]
MODE = np.dtype([(name, np.float64) for name in _FLOATS] + [(name, np.int64) for name in ("zone", "epoch", "segment")])

#: Local error of a step, relative to the largest position and velocity so far.
TOLERANCE = 1e-12
SHORTEST_STEP = 1e-13
MOST_IDLE_EVENTS = 1000
#: Beyond this the cart has left the laboratory [m].
FARTHEST = 1e4
RUNS_AWAY, CHATTERS = 1, 2

_STAGES, _STATES = 12, 6
_A, _B, _C = (np.ascontiguousarray(table) for table in (DOP853.A, DOP853.B, DOP853.C))
_E3, _E5 = np.ascontiguousarray(DOP853.E3), np.ascontiguousarray(DOP853.E5)
_REVERSAL, _EDGE, _SLOWEST, _BREAKAWAY = 0, 1, 2, 3


class Parameters(Protocol):
    """One element of a ``PARAMETERS`` array."""

    def __getattr__(self, name: str) -> float: ...


class Mode(Protocol):
    """One element of a ``MODE`` array: the clock, and what is frozen during a step."""

    t: float
    step: float  # length to try next
    direction: float  # -1, 0 (sticks) or +1
    x_side: float  # a point between the two position edges around the cart
    t_side: float  # a point between the two instants of change around t
    anchor_x: float  # place at which the Bouc-Wen z is known
    anchor_z: float
    zone: int  # position edges below the cart
    epoch: int  # instants of change that have passed
    segment: int  # row of ``segments`` in force


class World(NamedTuple):
    """Everything that a step needs. y = (x, v, x2, v2, creep force, slow brake's force), ``reach`` its largest
    values so far, ``segments`` (s, 4) = (start, value, slope, lagged force at start) of the commands; ``k`` and ``out``
    are room.
    """

    p: Parameters
    m: Mode
    y: FloatArray
    reach: FloatArray
    segments: FloatArray
    edges: FloatArray
    instants: FloatArray
    k: FloatArray
    out: FloatArray


@njit(cache=True)
def applied_force(p: Parameters, segment: FloatArray, t: float) -> float:
    """Force of the actuator at ``t``. Lag: tau f' + f = u with u = value + slope (t - start)."""
    start, value, slope, lagged = segment[0], segment[1], segment[2], segment[3]
    u = value + slope * (t - start)
    if p.lag_time == 0.0:
        return float(u)
    behind = slope * p.lag_time
    return float(u - behind + (lagged - value + behind) * math.exp(-(t - start) / p.lag_time))


@njit(cache=True)
def lag(parameters: npt.NDArray[Any], segments: FloatArray) -> None:
    """Fill the last column of ``segments``: the lagged force at the start of each but the first."""
    for i in range(1, segments.shape[0]):
        segments[i, 3] = applied_force(parameters[0], segments[i - 1], segments[i, 0])


@njit(cache=True)
def _spring(p: Parameters, m: Mode, t: float, x: float) -> float:
    stretch = x
    gap = p.backlash_half_width
    if gap > 0.0:
        stretch = x - gap if m.x_side > gap else (x + gap if m.x_side < -gap else 0.0)
    drift = p.stiffness_drift_rate * t
    if p.settling_ratio != 0.0:
        drift += p.settling_ratio * math.exp(-t / p.settling_time)
    force = p.stiffness * (1.0 + drift) * stretch
    force += (p.quadratic_stiffness + p.cubic_stiffness * x) * x * x
    if m.x_side > p.stop_position:
        force += p.stop_stiffness * (x - p.stop_position)
    elif m.x_side < -p.stop_position:
        force += p.stop_stiffness * (x + p.stop_position)
    if m.x_side > p.one_stop_position:
        force += p.one_stop_stiffness * (x - p.one_stop_position)
    if m.x_side > p.bend_position:
        force += p.bend_stiffness * (x - p.bend_position)
    return force


@njit(cache=True)
def _driven(w: World) -> bool:
    """Whether a force is commanded."""
    return bool(w.segments[w.m.segment, 1] != 0.0 or w.segments[w.m.segment, 2] != 0.0)


@njit(cache=True)
def _variant_losses(w: World, t: float, x: float, v: float) -> float:
    """Damping of other laws, stops with losses, two tones [N]: on the left-hand side."""
    p, m = w.p, w.m
    force = 0.0
    if m.x_side > p.soft_stop_position:
        force += p.soft_stop_stiffness * (x - p.soft_stop_position) * (1.0 + p.soft_stop_damping * v)
    elif m.x_side < -p.soft_stop_position:
        force += p.soft_stop_stiffness * (x + p.soft_stop_position) * (1.0 - p.soft_stop_damping * v)
    if p.power_drag != 0.0:
        force += p.power_drag * m.direction * abs(v) ** 1.5
    if m.direction > 0.0:
        force += p.up_damping * v
    if p.driven_damping != 0.0 and _driven(w):
        force += p.driven_damping * v
    if p.low_tone_amplitude != 0.0:
        force += p.low_tone_amplitude * math.sin(p.low_tone_frequency * t)
    if p.high_tone_amplitude != 0.0:
        force += p.high_tone_amplitude * math.sin(p.high_tone_frequency * t)
    return force


@njit(cache=True)
def _bouc_wen(p: Parameters, m: Mode, x: float) -> float:
    """z(x) while the direction d lasts: z' = (v/L)(1 - d z)."""
    d = m.direction
    if d == 0.0:
        return m.anchor_z
    return d + (m.anchor_z - d) * math.exp(-d * (x - m.anchor_x) / p.hysteresis_length)


@njit(cache=True)
def other_forces(w: World, t: float, y: FloatArray) -> float:
    """Sum of all forces on the cart except dry friction [N]."""
    p, m, x, v = w.p, w.m, y[0], y[1]
    force = applied_force(p, w.segments[m.segment], t) * (1.0 + p.gain_drift_rate * t) - p.offset_force - y[4]
    if p.slow_brake_damping != 0.0 and _driven(w):
        force -= y[5]
    force -= p.damping * v + _spring(p, m, t, x) + p.drag_coefficient * m.direction * v * v
    force -= _variant_losses(w, t, x, v)
    if p.hysteresis_force != 0.0:
        force -= p.hysteresis_force * _bouc_wen(p, m, x)
    if p.disturbance_amplitude != 0.0:
        force -= p.disturbance_amplitude * math.sin(p.disturbance_frequency * t + p.disturbance_phase)
    if p.cogging_amplitude != 0.0:
        force -= p.cogging_amplitude * math.sin(2.0 * math.pi * x / p.cogging_pitch + p.cogging_phase)
    if p.second_mass > 0.0:
        force -= p.second_stiffness * (x - y[2]) + p.second_damping * (v - y[3])
    if p.magnet_strength != 0.0:
        force += p.magnet_strength / ((p.magnet_position - x) ** 2 + p.magnet_gap**2)
    if m.direction > 0.0 and p.cable_start < m.x_side < p.cable_end:
        force -= p.cable_damping * v
    return float(force)


@njit(cache=True)
def _uneven_friction(p: Parameters, m: Mode, t: float, x: float) -> float:
    """Dry friction that depends on place or time: the same at rest and sliding."""
    force = p.early_coulomb if m.t_side < p.change_time else p.late_coulomb
    if p.position_coulomb > 0.0 and 1.0 + p.position_slope * m.x_side > 0.0:
        force += p.position_coulomb * (1.0 + p.position_slope * x)
    if p.eccentric_coulomb > 0.0:
        force += p.eccentric_coulomb * (1.0 + p.eccentric_ratio * math.sin(2.0 * math.pi * x / p.eccentric_pitch))
    if p.fading_coulomb > 0.0:
        force += p.fading_coulomb * math.exp(-t / p.fading_time)
    force += p.load_coulomb
    if p.load_ratio > 0.0:
        force += p.load_ratio * p.stiffness * (x if m.x_side > 0.0 else -x)
    return force


@njit(cache=True)
def _sliding_friction(p: Parameters, m: Mode, t: float, x: float, v: float) -> float:
    force = p.coulomb_force + p.stribeck_coulomb + _uneven_friction(p, m, t, x)
    if p.stribeck_static > 0.0:
        force += (p.stribeck_static - p.stribeck_coulomb) * math.exp(-((v / p.stribeck_velocity) ** 2))
    force += p.rational_coulomb + p.exponential_coulomb
    if p.rational_static > 0.0:
        force += (p.rational_static - p.rational_coulomb) / (1.0 + (v / p.rational_velocity) ** 2)
    if p.exponential_static > 0.0:
        force += (p.exponential_static - p.exponential_coulomb) * math.exp(-abs(v) / p.exponential_velocity)
    return force


@njit(cache=True)
def _static_friction(p: Parameters, m: Mode, t: float, x: float) -> float:
    """Largest force that dry friction can hold at rest [N]."""
    return p.static_force + p.stribeck_static + p.rational_static + p.exponential_static + _uneven_friction(p, m, t, x)


@njit(cache=True)
def _slope(w: World, t: float, y: FloatArray, dy: FloatArray) -> None:
    """Time derivative of y."""
    p, m = w.p, w.m
    dy[0] = dy[1] = dy[2] = dy[3] = dy[4] = dy[5] = 0.0
    if m.direction != 0.0:
        mass = p.mass if m.t_side < p.drop_time else p.mass - p.dropped_mass
        dy[0] = y[1]
        dy[1] = (other_forces(w, t, y) - m.direction * _sliding_friction(p, m, t, y[0], y[1])) / mass
    if p.second_mass > 0.0:
        dy[2] = y[3]
        dy[3] = (p.second_stiffness * (y[0] - y[2]) + p.second_damping * (y[1] - y[3])) / p.second_mass
    if p.creep_stiffness > 0.0:
        dy[4] = p.creep_stiffness * y[1] - y[4] / p.creep_time
    if p.slow_brake_damping != 0.0:
        dy[5] = (p.slow_brake_damping * y[1] - y[5]) / p.slow_brake_time


@njit(cache=True)
def _trial(w: World, h: float) -> None:
    """One step of length h from the present into ``w.out``; its stages stay in ``w.k``."""
    y, k, out = w.y, w.k, w.out
    _slope(w, w.m.t, y, k[0])
    for stage in range(1, _STAGES):
        for i in range(_STATES):
            total = 0.0
            for j in range(stage):
                total += _A[stage, j] * k[j, i]
            out[i] = y[i] + h * total
        _slope(w, w.m.t + _C[stage] * h, out, k[stage])
    for i in range(_STATES):
        total = 0.0
        for j in range(_STAGES):
            total += _B[j] * k[j, i]
        out[i] = y[i] + h * total
    _slope(w, w.m.t + h, out, k[_STAGES])


@njit(cache=True)
def _error(w: World, h: float) -> float:
    """Error of the trial step in units of what is allowed (<= 1: accept): DOP853's blend of two estimates.

    It grows as h^8, and so does what it makes of a step that goes too far.
    """
    leap = (abs(w.out[0] - w.y[0]) / w.p.longest_move) ** 8
    fifth = third = 0.0
    for i in range(_STATES):
        e3 = e5 = 0.0
        for j in range(_STAGES + 1):
            e3 += _E3[j] * w.k[j, i]
            e5 += _E5[j] * w.k[j, i]
        scale = TOLERANCE * max(w.reach[i], abs(w.out[i])) + 1e-150
        third += (e3 / scale) ** 2
        fifth += (e5 / scale) ** 2
    if fifth == 0.0:
        return float(leap)
    blend = h * fifth / math.sqrt((fifth + 0.01 * third) * _STATES)
    return float(leap if blend < leap else blend)  # NaN stays NaN


@njit(cache=True)
def _probe(w: World, kind: int, edge: float, h: float) -> float:
    """Value whose root in h is the event of this kind."""
    p = w.p
    moves = p.second_mass > 0.0 or p.creep_stiffness > 0.0 or p.slow_brake_damping != 0.0
    if kind != _BREAKAWAY or moves:  # else nothing moves while it sticks
        _trial(w, h)
    if kind == _REVERSAL:
        return float(w.out[1] / h)  # v/h, not v: the root at h = 0 of a cart that starts from rest is none
    if kind == _EDGE:
        return float(w.out[0] - edge)
    if kind == _SLOWEST:
        return float(w.k[_STAGES, 1])
    return abs(other_forces(w, w.m.t + h, w.out)) - _static_friction(w.p, w.m, w.m.t + h, w.out[0])


@njit(cache=True)
def _locate(w: World, kind: int, edge: float, a: float, ga: float, b: float, gb: float) -> float:
    """Step length in (a, b] just beyond the event, where the value goes from ga to gb: regula falsi (Illinois)."""
    side = 0
    for _ in range(100):
        if b - a <= 4e-16 * max(b, abs(w.m.t)) or gb == 0.0:
            break
        c = b - gb * (b - a) / (gb - ga)
        if not a < c < b:
            c = 0.5 * (a + b)
        gc = _probe(w, kind, edge, c)
        if (gc < 0.0) == (gb < 0.0):
            b, gb = c, gc
            ga = 0.5 * ga if side == 1 else ga
            side = 1
        else:
            a, ga = c, gc
            gb = 0.5 * gb if side == -1 else gb
            side = -1
    return b


@njit(cache=True)
def _settle(w: World) -> None:
    """Mode of a cart whose velocity is 0: sticks, or the direction in which it leaves."""
    m = w.m
    push = other_forces(w, m.t, w.y)
    hold = _static_friction(w.p, m, m.t, w.y[0])
    if hold > 0.0 and abs(push) <= hold:
        m.direction = 0.0
    elif push != 0.0:
        m.direction = 1.0 if push > 0.0 else -1.0
    elif m.direction == 0.0:
        m.direction = 1.0


@njit(cache=True)
def _accept(w: World, h: float, end: float) -> None:
    """Take the trial step of length h; ``end`` is its exact end where rounding alone parts the two."""
    w.m.anchor_z = _bouc_wen(w.p, w.m, w.out[0])
    w.m.anchor_x = w.out[0]
    w.m.t = end if w.m.t + h >= end - 1e-14 else w.m.t + h
    for i in range(_STATES):
        w.y[i] = w.out[i]
        w.reach[i] = max(w.reach[i], abs(w.out[i]))


@njit(cache=True)
def _controlled(w: World, end: float) -> float:
    """Try the longest step towards ``end`` within the tolerance; returns its length, or -1 when there is none."""
    m = w.m
    h = min(m.step, end - m.t, w.p.longest_step)
    while m.step >= SHORTEST_STEP:
        _trial(w, h)
        error = _error(w, h)
        if error <= 1.0:
            growth = 5.0 if error == 0.0 else min(5.0, 0.9 * error**-0.125)
            if h >= m.step or growth < 1.0:
                m.step = h * growth
            return h
        h *= max(0.1, 0.9 * error**-0.125) if error < 1e30 else 0.1
        m.step = h
    return -1.0


@njit(cache=True)
def _peak(w: World, a: float, b: float) -> float:
    """Where the push comes nearest to the static friction between two step lengths: golden section."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    c, d = b - ratio * (b - a), a + ratio * (b - a)
    gc, gd = _probe(w, _BREAKAWAY, 0.0, c), _probe(w, _BREAKAWAY, 0.0, d)
    for _ in range(40):
        if gc > gd:
            b, d, gd = d, c, gc
            c = b - ratio * (b - a)
            gc = _probe(w, _BREAKAWAY, 0.0, c)
        else:
            a, c, gc = c, d, gd
            d = a + ratio * (b - a)
            gd = _probe(w, _BREAKAWAY, 0.0, d)
    return 0.5 * (a + b)


@njit(cache=True)
def _breakaway(w: World, h: float) -> float:
    """Length to the first breakaway within h, or -1; sees a push that rises and falls again within the step, too."""
    a, ga = 0.0, -1.0
    for quarter in range(1, 5):
        end = 0.25 * quarter * h
        g_end = _probe(w, _BREAKAWAY, 0.0, end)
        b, gb = end, g_end
        near = 1e-4 * (end - a)
        falls = gb <= 0.0 and _probe(w, _BREAKAWAY, 0.0, end - near) > g_end
        if falls and _probe(w, _BREAKAWAY, 0.0, a + near) > _probe(w, _BREAKAWAY, 0.0, a):
            b = _peak(w, a, end)
            gb = _probe(w, _BREAKAWAY, 0.0, b)
        if gb > 0.0:
            return _locate(w, _BREAKAWAY, 0.0, a, min(ga, -1e-300), b, gb)
        a, ga = end, g_end
    return -1.0


@njit(cache=True)
def _stick(w: World, end: float) -> int:
    """Stay at rest until ``end`` or until the cart breaks away."""
    if abs(other_forces(w, w.m.t, w.y)) > _static_friction(w.p, w.m, w.m.t, w.y[0]):
        _settle(w)
        return 0
    h = _controlled(w, end)
    if h < 0.0:
        return RUNS_AWAY
    leaves = _breakaway(w, h)
    _trial(w, h if leaves < 0.0 else leaves)
    _accept(w, h if leaves < 0.0 else leaves, end)
    if leaves >= 0.0:  # whatever rounding makes of a push that equals the friction now
        w.m.direction = math.copysign(1.0, other_forces(w, w.m.t, w.y))
    return 0


@njit(cache=True)
def _place(w: World) -> None:
    """Refresh the point that tells on which side of every edge the cart is."""
    below = w.edges[w.m.zone - 1] if w.m.zone > 0 else -math.inf
    above = w.edges[w.m.zone] if w.m.zone < w.edges.size else math.inf
    if math.isinf(below) and math.isinf(above):
        w.m.x_side = 0.0
    elif math.isinf(below):
        w.m.x_side = above - 1.0 - abs(above)
    elif math.isinf(above):
        w.m.x_side = below + 1.0 + abs(below)
    else:
        w.m.x_side = 0.5 * (below + above)


@njit(cache=True)
def _reversal(w: World, h: float) -> float:
    """Length to the first reversal within the trial step of length h, or -1 when the direction lasts."""
    d, v, v_end, a, a_end = w.m.direction, w.y[1], w.out[1], w.k[0, 1], w.k[_STAGES, 1]
    start = a if v == 0.0 else d
    if d * v_end < 0.0:
        return _locate(w, _REVERSAL, 0.0, 0.0, start, h, v_end / h)
    if d * v > 0.0 and d * a < 0.0 < d * a_end:  # slowed down, then sped up: did it stop in between?
        slowest = _locate(w, _SLOWEST, 0.0, 0.0, a, h, a_end)
        g = _probe(w, _REVERSAL, 0.0, slowest)
        if d * g < 0.0:
            return _locate(w, _REVERSAL, 0.0, 0.0, start, slowest, g)
    return -1.0


@njit(cache=True)
def _next_edge(w: World) -> float:
    if w.m.direction > 0.0:
        return float(w.edges[w.m.zone]) if w.m.zone < w.edges.size else math.inf
    return float(w.edges[w.m.zone - 1]) if w.m.zone > 0 else -math.inf


@njit(cache=True)
def _slide(w: World, end: float) -> int:
    """Move in one direction until ``end``, a reversal, or a position edge."""
    m, d, edge = w.m, w.m.direction, _next_edge(w)
    if d * (w.y[0] - edge) >= 0.0:
        m.zone += int(d)
        _place(w)
        return 0
    h = _controlled(w, end)
    if h < 0.0:
        return RUNS_AWAY
    if w.y[1] == 0.0 and d * w.out[1] < 0.0 and d * w.k[0, 1] <= 0.0:  # leaves the other way, or not at all
        _settle(w)
        if m.direction == d:
            m.direction = -d
        return 0
    reversal = _reversal(w, h)
    if reversal >= 0.0:
        h = reversal
    _trial(w, h)
    crosses = d * (w.out[0] - edge) > 0.0
    if crosses:
        h = _locate(w, _EDGE, edge, 0.0, w.y[0] - edge, h, w.out[0] - edge)
        _trial(w, h)
    if (crosses or reversal >= 0.0) and not _error(w, h) <= 1.0:  # its end first shows the force near rest; or NaN
        m.step = 0.5 * h
        return 0
    if crosses:
        w.out[0] = edge
        m.zone += int(d)
    elif reversal >= 0.0:
        w.out[1] = 0.0
    _accept(w, h, end)
    _place(w)
    if w.y[1] == 0.0 and not crosses:
        _settle(w)
    return 0


@njit(cache=True)
def _next_break(w: World, until: float) -> float:
    """First instant after the present at which the force, the rig or the asked span changes."""
    m = w.m
    while m.segment + 1 < w.segments.shape[0] and w.segments[m.segment + 1, 0] <= m.t:
        m.segment += 1
    while m.epoch < w.instants.size and w.instants[m.epoch] <= m.t:
        m.epoch += 1
        m.t_side = 0.5 * (m.t + w.instants[m.epoch]) if m.epoch < w.instants.size else m.t + 1.0
    end = until
    if m.segment + 1 < w.segments.shape[0]:
        end = min(end, w.segments[m.segment + 1, 0])
    if m.epoch < w.instants.size:
        end = min(end, w.instants[m.epoch])
    return end


@njit(cache=True)
def _advance(w: World, until: float) -> int:
    """Move the state to ``until``; returns 0, RUNS_AWAY or CHATTERS."""
    idle = 0
    end = _next_break(w, until)
    while w.m.t < until:
        before = w.m.t
        trouble = _stick(w, end) if w.m.direction == 0.0 else _slide(w, end)
        if trouble != 0:
            return trouble
        idle = 0 if w.m.t > before else idle + 1
        if idle > MOST_IDLE_EVENTS:
            return CHATTERS
        if abs(w.y[0]) > FARTHEST:
            return RUNS_AWAY
        end = _next_break(w, until)
    return 0


@njit(cache=True)
def begin(
    parameters: npt.NDArray[Any], mode: npt.NDArray[Any], y: FloatArray, reach: FloatArray, segments: FloatArray,
    edges: FloatArray, instants: FloatArray,
) -> None:  # fmt: skip
    """Find the mode that belongs to y, for a clock that is set."""
    k, out = np.zeros((_STAGES + 1, _STATES)), np.zeros(_STATES)
    w = World(parameters[0], mode[0], y, reach, segments, edges, instants, k, out)
    w.m.zone = np.searchsorted(edges, y[0])
    _place(w)
    w.m.anchor_x = y[0]
    w.m.direction = 1.0 if y[1] > 0.0 else -1.0
    if y[1] == 0.0:
        w.m.direction = 0.0 if _static_friction(w.p, w.m, w.m.t, y[0]) > 0.0 else 1.0


@njit(cache=True)
def run(
    parameters: npt.NDArray[Any], mode: npt.NDArray[Any], y: FloatArray, reach: FloatArray, segments: FloatArray,
    edges: FloatArray, instants: FloatArray, times: FloatArray, motion: FloatArray,
) -> tuple[int, int]:  # fmt: skip
    """Position, velocity and force at ``times`` (rising, none before the present) into the rows of ``motion``.

    Returns (0, RUNS_AWAY or CHATTERS; samples done); ``mode``, ``y`` and ``reach`` go on to the last instant.
    """
    k, out = np.zeros((_STAGES + 1, _STATES)), np.zeros(_STATES)
    w = World(parameters[0], mode[0], y, reach, segments, edges, instants, k, out)
    for i in range(times.size):
        trouble = _advance(w, times[i])
        if trouble != 0:
            return trouble, i
        motion[0, i] = y[0]
        motion[1, i] = y[1]
        motion[2, i] = applied_force(w.p, segments[w.m.segment], w.m.t)
    return 0, times.size
