"""The force that the model lacks at each instant, with a band.

The unknown force d joins the state (x, v, d) of

    m x'' + b x' + k x + d = F,      d a random walk,

and a Kalman filter with a Rauch–Tung–Striebel smoother estimates it from the readings; how fast d may walk is what
makes the readings likeliest. Nothing is differentiated. (Kalman 1960; Rauch, Tung, Striebel 1965.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.optimize
from numba import njit

from msd_ident.record import FloatArray, Record

#: Range of the walk's strength that is searched, in decades either side of its natural size.
_DECADES = 6.0
_EVALUATIONS = 9
#: Relative change of the covariance below which the filter's gain is taken as settled (regular sampling only).
_SETTLED = 1e-9


@dataclass(frozen=True)
class MissingForce:
    """What the smoother found for one record, each (n,): time [s], position [m], velocity [m/s], the force applied [N].

    ``force`` stands on the left-hand side of the equation, so friction has the sign of the velocity; ``std`` is the
    standard deviation of ``force``. ``walk`` is the likeliest strength of the random walk [N²/s].
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    applied: FloatArray
    force: FloatArray
    std: FloatArray
    walk: float

    @property
    def size(self) -> float:
        """Root mean square of the missing force [N]."""
        return math.sqrt(float(np.mean(self.force**2)))


def missing_force(record: Record, plant: tuple[float, float, float], noise: float, zero: float = 0.0) -> MissingForce:
    """Smooth one record.

    Args:
        record: the measurement.
        plant: mass [kg], damping [N·s/m], stiffness [N/m] of the model.
        noise: standard deviation of a reading [m].
        zero: reading at which the spring is relaxed [m].
    """
    position = np.ascontiguousarray(record.position - zero)
    steps = np.diff(record.time)
    applied = _mean_force(record)
    mass, damping, stiffness = plant
    natural = _natural_walk(record, mass, position)
    variance = max(noise, 1e-9 * float(np.ptp(position)), 1e-300) ** 2
    work = np.empty((record.samples, 9))
    states = np.empty((record.samples, 3))

    def unlikely(decade: float) -> float:
        walk = natural * 10.0**decade
        return -float(_filter(steps, position, applied, mass, damping, stiffness, variance, walk, states, work))

    found = scipy.optimize.minimize_scalar(
        unlikely, bounds=(-_DECADES, _DECADES), method="bounded", options={"maxiter": _EVALUATIONS, "xatol": 0.1}
    )
    walk = natural * 10.0 ** float(found.x)
    unlikely(float(found.x))
    spread = np.empty(record.samples)
    _smooth(steps, applied, mass, damping, stiffness, walk, states, work, spread)
    return MissingForce(
        time=record.time,
        position=states[:, 0].copy(),
        velocity=states[:, 1].copy(),
        applied=record.force_at(record.time),
        force=states[:, 2].copy(),
        std=np.sqrt(spread),
        walk=walk,
    )


def _natural_walk(record: Record, mass: float, position: FloatArray) -> float:
    """Walk [N²/s] that covers the largest inertial force at work within the record's own time scale."""
    length = max(float(np.std(position)), 1e-12)
    span = max(1, record.samples // 300)
    speed = float(np.sqrt(np.mean((position[span:] - position[:-span]) ** 2))) / (span * record.period)
    time = length / max(speed, 1e-12)
    force = max(float(np.max(np.abs(record.force))), mass * length / time**2)
    return force**2 / time


def _mean_force(record: Record) -> FloatArray:
    """Mean force (n − 1,) between consecutive position samples: exact for a held force, whatever its stamps."""
    knots = np.union1d(record.time, record.force_time)
    knots = knots[(knots >= record.time[0]) & (knots <= record.time[-1])]
    middle = record.force_at(0.5 * (knots[1:] + knots[:-1]))
    impulse = np.concatenate(([0.0], np.cumsum(middle * np.diff(knots))))
    return np.asarray(np.diff(np.interp(record.time, knots, impulse)) / np.diff(record.time))


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _transition(h, m, b, k, a, g):  # type: ignore[no-untyped-def]
    """Fill a (3, 3) with the transition of (x, v, d) over h and g (2,) with the effect of a held force."""
    # Taylor series of the generator [[0, 1, 0], [-k/m, -b/m, -1/m], [0, 0, 0]] on each column.
    p, r = -k / m, -b / m
    for column in range(3):
        x = 1.0 if column == 0 else 0.0
        v = 1.0 if column == 1 else 0.0
        d = 1.0 if column == 2 else 0.0
        sx, sv = x, v
        for n in range(1, 13):
            x, v, d = v * h / n, (p * x + r * v - d / m) * h / n, 0.0
            sx += x
            sv += v
        a[0, column], a[1, column] = sx, sv
    a[2, 0] = a[2, 1] = 0.0
    a[2, 2] = 1.0
    g[0], g[1] = -a[0, 2], -a[1, 2]


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _predicted(a, c, h, m, walk, out):  # type: ignore[no-untyped-def]
    """out = a c aᵀ + Q with the walk's covariance over h (plant forces within one step left out of Q)."""
    for i in range(3):
        for j in range(i + 1):
            total = 0.0
            for u in range(3):
                for w in range(3):
                    total += a[i, u] * c[u, w] * a[j, w]
            out[i, j] = total
            out[j, i] = total
    out[0, 0] += walk * h**5 / (20.0 * m * m)
    out[1, 1] += walk * h**3 / (3.0 * m * m)
    out[2, 2] += walk * h
    cross = walk * h**4 / (8.0 * m * m), -walk * h**3 / (6.0 * m), -walk * h**2 / (2.0 * m)
    out[0, 1] += cross[0]
    out[1, 0] += cross[0]
    out[0, 2] += cross[1]
    out[2, 0] += cross[1]
    out[1, 2] += cross[2]
    out[2, 1] += cross[2]


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _filter(steps, y, u, m, b, k, variance, walk, states, work):  # type: ignore[no-untyped-def]
    """Log likelihood; fills the filtered states (n, 3) and covariances (n, 9)."""
    n = y.size
    a, g = np.empty((3, 3)), np.empty(2)
    c, ahead = np.zeros((3, 3)), np.zeros((3, 3))
    reach = np.max(y) - np.min(y)
    h = np.median(steps)
    c[0, 0] = variance
    c[1, 1] = max(reach / h, 1e-12) ** 2 * 1e-2
    c[2, 2] = max(np.max(np.abs(u)), k * reach, m * reach) ** 2 + walk
    x, v, d = y[0], 0.0, 0.0
    states[0] = x, v, d
    work[0] = c.ravel()
    total, last, settled = 0.0, -1.0, False
    spread, g0, g1, g2 = 0.0, 0.0, 0.0, 0.0
    for i in range(1, n):
        h = steps[i - 1]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, m, b, k, a, g)
            last, settled = h, False
        if not settled:
            _predicted(a, c, h, m, walk, ahead)
            before = spread
            spread = ahead[0, 0] + variance
            g0, g1, g2 = ahead[0, 0] / spread, ahead[1, 0] / spread, ahead[2, 0] / spread
            for p in range(3):
                for q in range(3):
                    c[p, q] = ahead[p, q] - ahead[p, 0] * ahead[0, q] / spread
            settled = abs(spread - before) < _SETTLED * spread and i > 50
        nx = a[0, 0] * x + a[0, 1] * v + a[0, 2] * d + g[0] * u[i - 1]
        nv = a[1, 0] * x + a[1, 1] * v + a[1, 2] * d + g[1] * u[i - 1]
        e = y[i] - nx
        x, v, d = nx + g0 * e, nv + g1 * e, d + g2 * e
        total -= 0.5 * (e * e / spread + np.log(spread))
        states[i, 0], states[i, 1], states[i, 2] = x, v, d
        for p in range(3):
            for q in range(3):
                work[i, 3 * p + q] = c[p, q]
    return total


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _smooth(steps, u, m, b, k, walk, states, work, spread):  # type: ignore[no-untyped-def]
    """Rauch–Tung–Striebel: states become the smoothed ones, spread (n,) the variance of d."""
    n = states.shape[0]
    a, g = np.empty((3, 3)), np.empty(2)
    ahead, gain, c = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    later = work[n - 1].copy().reshape(3, 3)
    spread[n - 1] = later[2, 2]
    last = -1.0
    for i in range(n - 2, -1, -1):
        h = steps[i]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, m, b, k, a, g)
            last = h
        for p in range(3):
            for q in range(3):
                c[p, q] = work[i, 3 * p + q]
        _predicted(a, c, h, m, walk, ahead)
        _gain(a, c, ahead, gain)
        x, v, d = states[i, 0], states[i, 1], states[i, 2]
        e0 = states[i + 1, 0] - (a[0, 0] * x + a[0, 1] * v + a[0, 2] * d + g[0] * u[i])
        e1 = states[i + 1, 1] - (a[1, 0] * x + a[1, 1] * v + a[1, 2] * d + g[1] * u[i])
        e2 = states[i + 1, 2] - d
        for p in range(3):
            states[i, p] += gain[p, 0] * e0 + gain[p, 1] * e1 + gain[p, 2] * e2
        ahead[:] = later - ahead
        for p in range(3):
            for q in range(3):
                total = c[p, q]
                for w in range(3):
                    for z in range(3):
                        total += gain[p, w] * ahead[w, z] * gain[q, z]
                later[p, q] = total
        spread[i] = max(later[2, 2], 0.0)


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _gain(a, c, ahead, gain):  # type: ignore[no-untyped-def]
    """gain = c aᵀ ahead⁻¹, by the inverse of a scaled symmetric 3 × 3 matrix."""
    s0, s1, s2 = np.sqrt(ahead[0, 0]), np.sqrt(ahead[1, 1]), np.sqrt(ahead[2, 2])
    r01 = ahead[0, 1] / (s0 * s1)
    r02 = ahead[0, 2] / (s0 * s2)
    r12 = ahead[1, 2] / (s1 * s2)
    determinant = 1.0 + 2.0 * r01 * r02 * r12 - r01**2 - r02**2 - r12**2
    determinant = max(determinant, 1e-14)
    inverse = np.empty((3, 3))
    inverse[0, 0] = (1.0 - r12**2) / (determinant * s0 * s0)
    inverse[1, 1] = (1.0 - r02**2) / (determinant * s1 * s1)
    inverse[2, 2] = (1.0 - r01**2) / (determinant * s2 * s2)
    inverse[0, 1] = inverse[1, 0] = (r02 * r12 - r01) / (determinant * s0 * s1)
    inverse[0, 2] = inverse[2, 0] = (r01 * r12 - r02) / (determinant * s0 * s2)
    inverse[1, 2] = inverse[2, 1] = (r01 * r02 - r12) / (determinant * s1 * s2)
    for p in range(3):
        row0 = c[p, 0] * a[0, 0] + c[p, 1] * a[0, 1] + c[p, 2] * a[0, 2]
        row1 = c[p, 0] * a[1, 0] + c[p, 1] * a[1, 1] + c[p, 2] * a[1, 2]
        row2 = c[p, 2]
        for q in range(3):
            gain[p, q] = row0 * inverse[0, q] + row1 * inverse[1, q] + row2 * inverse[2, q]
