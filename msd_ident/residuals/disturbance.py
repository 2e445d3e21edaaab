"""Estimate of the missing force at each instant, with its band.

The unknown force d joins the state (x, v, d) of

    m x'' + b x' + k x + d = F,      d a random walk,

and a Kalman filter with a Bryson–Frazier smoother (``force_smoother``) estimates it from the readings; how fast d may
walk is what makes the readings likeliest. Nothing is differentiated.

What a model leaves of the readings need not be a force: to move a mass by a millimetre at many times the frequency of
its motion takes a force that no rig has, while a sensor errs by it easily. So there the sensor may have a smooth error
besides its noise, whose size and memory are the likeliest ones too; Bayes' information criterion (Schwarz 1978) decides
whether it does. And a missing force walks no faster than through all forces at work in the motion's own time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import scipy.optimize

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import SHORT, THOROUGH
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.residuals.force_smoother import STATES, WORK, Law, Readings, filtered, smoothed

#: Range of the walk's strength that is searched, in decades either side of its natural size: a force squared.
_DECADES = 2.0 * math.log10(NATURAL_RANGE)


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
        plant: mass [kg], damping [N·s/m] and stiffness [N/m] with which it was smoothed.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    applied: FloatArray
    force: FloatArray
    std: FloatArray
    walk: float
    plant: tuple[float, float, float]

    @property
    def size(self) -> float:
        """Root mean square of the missing force [N]."""
        return math.sqrt(float(np.mean(self.force**2)))


def lacking_force(
    record: Record, residual: FloatArray, plant: tuple[float, float, float], noise: float, *, only_noise: bool = False
) -> DisturbanceEstimate:
    """Missing force of a simulation: smoothed from its residual, which may be a smooth error of the sensor instead.

    A small error of the motion moves like the plant that is equivalent to the simulated one over this motion: damping
    and stiffness are those of the linear force next to all that act in the simulation, in least squares (Krylov and
    Bogoliubov 1943).

    Args:
        record: the measurement.
        residual: simulated reading − data (n,) [m].
        plant: mass [kg], damping [N·s/m], stiffness [N/m] of the simulation.
        noise: standard deviation of a reading [m].
        only_noise: whether the residual is known to be noise: then no smooth error of the sensor is looked for.
    """
    mass, damping, stiffness = plant
    modelled = missing_force(replace(record, position=record.position + residual), plant, noise)
    further = equivalent(modelled)
    equal = mass, damping + further[0], stiffness + further[1]
    error = replace(record, position=-residual, force_time=record.time[:1], force=np.zeros(1), upsampled=1)
    found = _smoothed(error, equal, noise, _natural_walk(record, mass, record.position), smooth=not only_noise)
    velocity = modelled.velocity + found.velocity
    return replace(found, position=record.position, velocity=velocity, applied=modelled.applied)


def equivalent(beyond: DisturbanceEstimate) -> tuple[float, float]:
    """Damping [N·s/m] and stiffness [N/m] of the linear force next to a force beyond the plant, in least squares."""
    signals = np.column_stack([beyond.velocity, beyond.position, np.ones(beyond.time.size)])
    size = np.maximum(np.max(np.abs(signals), axis=0), 1e-300)
    slopes = np.linalg.lstsq(signals / size, beyond.force, rcond=None)[0] / size
    return float(slopes[0]), float(slopes[1])


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
    return _smoothed(replace(record, position=record.position - zero), plant, noise)


def _smoothed(
    record: Record,
    plant: tuple[float, float, float],
    noise: float,
    most: float = math.inf,
    *,
    smooth: bool = False,
) -> DisturbanceEstimate:
    """What ``missing_force`` gives, with a walk of at most ``most`` [N²/s]; the sensor may err smoothly too."""
    position = np.array(record.position)  # the compiled filter knows arrays that can be written to
    readings = Readings(np.diff(record.time), position, _mean_force(record))
    variance = max(noise, 1e-9 * float(np.ptp(position)), 1e-300) ** 2
    work, states = np.empty((record.samples, WORK)), np.empty((record.samples, STATES))

    def unlikely(law: Law) -> float:
        return -float(filtered(readings, law, states[:0], work[:0]))

    natural = Law(*plant, variance, _natural_walk(record, plant[0], position), 0.0, 1.0)
    likeliest = _likeliest(natural, unlikely, most)
    if smooth:
        likeliest = _with_smooth_error(likeliest, readings, unlikely, most)
    filtered(readings, likeliest, states, work)
    spread = np.empty(record.samples)
    smoothed(readings.steps, likeliest, states, work, spread)
    return DisturbanceEstimate(
        time=record.time,
        position=states[:, 0].copy(),
        velocity=states[:, 1].copy(),
        applied=record.force_at(record.time),
        force=states[:, 2].copy(),
        std=np.sqrt(spread),
        walk=likeliest.walk,
        plant=plant,
    )


def _likeliest(natural: Law, unlikely: Callable[[Law], float], most: float) -> Law:
    """The law with the walk, of at most ``most`` [N²/s], that makes the readings likeliest."""
    highest = min(_DECADES, math.log10(most / natural.walk))
    found = scipy.optimize.minimize_scalar(
        lambda decade: unlikely(natural._replace(walk=natural.walk * 10.0**decade)),
        bounds=(min(-_DECADES, highest - 1.0), highest),
        method="bounded",
        options={"maxiter": SHORT, "xatol": 0.1},
    )
    return natural._replace(walk=natural.walk * 10.0 ** float(found.x))


def _with_smooth_error(plain: Law, readings: Readings, unlikely: Callable[[Law], float], most: float) -> Law:
    """The law with a smooth error of the sensor, if that makes the readings likelier by more than its two numbers cost.

    Args:
        plain: the likeliest law without one.
        readings: of the record.
        unlikely: minus the log likelihood of a law [nats].
        most: largest walk [N²/s].
    """
    step, span = float(np.median(readings.steps)), float(np.sum(readings.steps))
    whole = max(float(np.mean(readings.position**2)), plain.variance)

    def law(point: FloatArray) -> Law:
        walk, smooth, memory = 10.0 ** np.clip(point, lowest, highest)
        return plain._replace(walk=float(walk), smooth=float(smooth), memory=float(memory))

    lowest = np.log10([most * 10.0**-_DECADES, plain.variance / NATURAL_RANGE, step])
    highest = np.log10([most, whole * NATURAL_RANGE, span])
    share = np.linspace(0.2, 0.8, 3)
    starts = [lowest + np.array(one) * (highest - lowest) for one in product(share, repeat=3)]
    best = min(starts, key=lambda point: unlikely(law(point)))

    def cost(point: Any) -> float:
        return unlikely(law(np.asarray(point)))

    ends: Any = {"maxfev": 2 * THOROUGH, "xatol": 0.1, "fatol": 0.1}
    found = scipy.optimize.minimize(cost, best, method="Nelder-Mead", options=ends)
    gain = unlikely(plain) - float(found.fun)
    return law(found.x) if gain > math.log(readings.position.size) else plain


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
