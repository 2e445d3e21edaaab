"""Estimate of the missing force at each instant, with its band.

The unknown force d joins the state (x, v, d) of

    m x'' + b x' + k x + d = F,      d a random walk,

and a Kalman filter with a Bryson–Frazier smoother estimates it from the readings; how fast d may walk is what
makes the readings likeliest. Nothing is differentiated. (Kalman 1960; Bryson and Frazier 1963; Bierman 1977.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy.optimize
from numba import njit

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.tuning import fixed

#: Range of the walk's strength that is searched, in decades either side of its natural size: a force squared.
_DECADES = 2.0 * math.log10(NATURAL_RANGE)
_SETTLED = fixed(
    1e-9,
    "accuracy",
    "relative change of the covariance below which the filter's gain is settled (regular sampling only)",
)


@dataclass(frozen=True)
class DisturbanceEstimate:
    """The smoothed missing force of one record; all arrays are (n,).

    Attributes:
        time: [s].
        position: smoothed [m].
        velocity: smoothed [m/s].
        applied: force of the record [N].
        force: missing force [N]. It stands on the left-hand side of the equation, so friction has the sign of the
            velocity.
        std: standard deviation of ``force`` [N].
        walk: likeliest strength of the random walk [N²/s].
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


class _Readings(NamedTuple):
    """Steps of time (n − 1,) [s], readings (n,) [m], mean force (n − 1,) [N] between them."""

    steps: FloatArray
    position: FloatArray
    applied: FloatArray


class _Law(NamedTuple):
    """The equation of the filter: m, b, k of the plant, variance of a reading [m²], strength of the walk [N²/s]."""

    m: float
    b: float
    k: float
    variance: float
    walk: float


def lacking_force(
    record: Record, residual: FloatArray, plant: tuple[float, float, float], noise: float
) -> DisturbanceEstimate:
    """Missing force of a simulation: smoothed from its residual, which moves like the plant without effects.

    Args:
        record: the measurement.
        residual: simulated reading − data (n,) [m].
        plant: mass [kg], damping [N·s/m], stiffness [N/m] of the simulation.
        noise: standard deviation of a reading [m].
    """
    error = replace(record, position=-residual, force_time=record.time[:1], force=np.zeros(1), upsampled=1)
    whole = missing_force(record, plant, noise)
    found = missing_force(error, plant, noise)
    return replace(found, position=record.position, velocity=whole.velocity, applied=whole.applied)


def missing_force(
    record: Record, plant: tuple[float, float, float], noise: float, zero: float = 0.0
) -> DisturbanceEstimate:
    """Missing force of a record, estimated from its readings by a Kalman smoother.

    Args:
        record: the measurement.
        plant: mass [kg], damping [N·s/m], stiffness [N/m] of the model.
        noise: standard deviation of a reading [m].
        zero: reading at which the spring is relaxed [m].
    """
    position = np.ascontiguousarray(record.position - zero)
    readings = _Readings(np.diff(record.time), position, _mean_force(record))
    natural = _natural_walk(record, plant[0], position)
    variance = max(noise, 1e-9 * float(np.ptp(position)), 1e-300) ** 2
    work = np.empty((record.samples, 11))
    states = np.empty((record.samples, 3))

    def law(decade: float) -> _Law:
        mass, damping, stiffness = plant
        return _Law(mass, damping, stiffness, variance, natural * 10.0**decade)

    def unlikely(decade: float) -> float:
        return -float(_filter(readings, law(decade), states, work))

    found = scipy.optimize.minimize_scalar(
        unlikely, bounds=(-_DECADES, _DECADES), method="bounded", options={"maxiter": SHORT, "xatol": 0.1}
    )
    likeliest = law(float(found.x))
    _filter(readings, likeliest, states, work)
    spread = np.empty(record.samples)
    _smooth(readings.steps, likeliest, states, work, spread)
    return DisturbanceEstimate(
        time=record.time,
        position=states[:, 0].copy(),
        velocity=states[:, 1].copy(),
        applied=record.force_at(record.time),
        force=states[:, 2].copy(),
        std=np.sqrt(spread),
        walk=likeliest.walk,
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
def _transition(h, law, a, g):  # type: ignore[no-untyped-def]
    """Fill a (3, 3) with the transition of (x, v, d) over h and g (2,) with the effect of a held force."""
    # Taylor series of the generator [[0, 1, 0], [-k/m, -b/m, -1/m], [0, 0, 0]] on each column.
    m, b, k, _, _ = law
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
def _carried(a, c, out):  # type: ignore[no-untyped-def]
    """out = a c aᵀ."""
    for i in range(3):
        for j in range(i + 1):
            total = 0.0
            for u in range(3):
                for w in range(3):
                    total += a[i, u] * c[u, w] * a[j, w]
            out[i, j] = total
            out[j, i] = total


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _walked(h, m, walk, out):  # type: ignore[no-untyped-def]
    """out += Q, the walk's covariance over h (plant forces within one step left out)."""
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
def _filter(readings, law, states, work):  # type: ignore[no-untyped-def]
    """Log likelihood; fills the filtered states (n, 3), and (n, 11) their covariances, and variance and value of what
    each reading surprises by.
    """
    steps, y, u = readings
    m, _, k, variance, walk = law
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
    work[0, :9] = c.ravel()
    total, last, settled = 0.0, -1.0, False
    spread, g0, g1, g2 = 0.0, 0.0, 0.0, 0.0
    for i in range(1, n):
        h = steps[i - 1]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, law, a, g)
            last, settled = h, False
        if not settled:
            _carried(a, c, ahead)
            _walked(h, m, walk, ahead)
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
        work[i, 9], work[i, 10] = spread, e
        for p in range(3):
            for q in range(3):
                work[i, 3 * p + q] = c[p, q]
    return total


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _smooth(steps, law, states, work, spread):  # type: ignore[no-untyped-def]
    """Modified Bryson–Frazier smoother: states become the smoothed ones, spread (n,) the variance of d.

    It inverts no covariance. A force that hardly walks makes them all but singular, and the smoother of Rauch, Tung
    and Striebel, which inverts them, diverges there. (Bierman 1977, Factorization Methods, ch. X.)
    """
    n, variance = states.shape[0], law.variance
    a, g, gain = np.empty((3, 3)), np.empty(2), np.empty(3)
    # What the later readings say: minus the gradient of their log likelihood in the state, and its information.
    pull, known = np.zeros(3), np.zeros((3, 3))
    moved, seen = np.empty(3), np.empty((3, 3))
    last = -1.0
    for i in range(n - 1, -1, -1):
        c = work[i, :9].copy().reshape(3, 3)
        explained = 0.0
        for p in range(3):
            for q in range(3):
                states[i, p] -= c[p, q] * pull[q]
                explained += c[2, p] * known[p, q] * c[q, 2]
        spread[i] = max(c[2, 2] - explained, 0.0)
        if i == 0:
            break
        total, error = work[i, 9], work[i, 10]
        for p in range(3):
            gain[p] = c[p, 0] / variance
        # Back over the reading: C' l - h e / s, C' L C + h h' / s with C = 1 - gain h' ...
        moved[:] = pull
        moved[0] -= gain[0] * pull[0] + gain[1] * pull[1] + gain[2] * pull[2] + error / total
        _seen_through(known, gain, seen)
        seen[0, 0] += 1.0 / total
        # ... and over the step before it.
        h = steps[i - 1]
        if h < 0.999999 * last or h > 1.000001 * last:
            _transition(h, law, a, g)
            last = h
        for p in range(3):
            pull[p] = a[0, p] * moved[0] + a[1, p] * moved[1] + a[2, p] * moved[2]
            for q in range(3):
                value = 0.0
                for u in range(3):
                    for w in range(3):
                        value += a[u, p] * seen[u, w] * a[w, q]
                known[p, q] = value


@njit(nogil=True, cache=True, error_model="numpy")  # type: ignore[untyped-decorator, unused-ignore]
def _seen_through(known, gain, out):  # type: ignore[no-untyped-def]
    """out = C' known C with C = 1 - gain h', h = (1, 0, 0)."""
    row0 = np.empty(3)
    for q in range(3):
        row0[q] = known[0, q] - gain[0] * known[0, q] - gain[1] * known[1, q] - gain[2] * known[2, q]
    for p in range(3):
        for q in range(3):
            out[p, q] = row0[q] if p == 0 else known[p, q]
    for p in range(3):
        out[p, 0] -= out[p, 0] * gain[0] + out[p, 1] * gain[1] + out[p, 2] * gain[2]
