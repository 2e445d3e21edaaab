"""Characteristic curves: spring force over position and damping force over velocity, measured without assuming a law.

    m x'' + D(x') + S(x) = F

with S and D piecewise linear between knots, D with a jump at rest (dry friction, told apart from a steep line only as
finely as the samples allow), all fitted by simulation error. No law is assumed: where no cause of the library fits,
this is what can be said of the rig.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from msd_ident.compiled import Library
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import Initial, see
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.least_squares import Normal, SolverOptions, minimise
from msd_ident.estimate.levels import KNOTS, NATURAL_RANGE, RELATIVE_STEP
from msd_ident.model import Model
from msd_ident.model.base_model import friction_force
from msd_ident.residuals.noise_model import Readings

LIBRARY = Library(__name__, f"{__name__}_loops")
_TABLE = ("f8[:]", "f8[:]")
_simulate = LIBRARY.function("simulate", "f8[:]", "f8[:]", ("f8", _TABLE, _TABLE), "f8[:]", "f8[:]")


@dataclass(frozen=True)
class Curve:
    """A characteristic curve; all arrays are (k,).

    Attributes:
        over: knots, position [m] or velocity [m/s].
        force: [N] at the knots.
        std: standard deviation of ``force`` [N].
    """

    over: FloatArray
    force: FloatArray
    std: FloatArray

    def to_json_dict(self) -> dict[str, list[float]]:
        """Plain lists."""
        return {"over": self.over.tolist(), "force": self.force.tolist(), "std": self.std.tolist()}


@dataclass(frozen=True)
class Characteristics:
    """Both curves, fitted together.

    Attributes:
        spring: spring force over position.
        damper: damping force over velocity.
        mass: [kg].
        see: SEE of the fit [m], eq. 14.
        see_reduction_percent: SEE reduction over the base model [%], eq. 15.
    """

    spring: Curve
    damper: Curve
    mass: float
    see: float
    see_reduction_percent: float

    def to_json_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "spring_force_over_position": self.spring.to_json_dict(),
            "damping_force_over_velocity": self.damper.to_json_dict(),
            "mass": self.mass,
            "see_m": self.see,
            "see_reduction_percent": self.see_reduction_percent,
        }


class _Table(NamedTuple):
    """Values (k,) at rising knots (k,)."""

    knots: FloatArray
    values: FloatArray


class _Plant(NamedTuple):
    """Mass [kg], force of the spring [N] over the position [m], of the damper [N] over the speed [m/s]."""

    m: float
    spring: _Table
    damper: _Table


@dataclass(frozen=True)
class _Curves:
    """The fitting problem: vector = mass, spring forces, damping forces, then position and velocity of each record."""

    readings: tuple[Readings, ...]
    places: FloatArray
    speeds: FloatArray
    scale: FloatArray
    applied: tuple[FloatArray, ...]

    def residual(self, point: FloatArray, record: int) -> FloatArray:
        """Model − data (n,) [m] of one record; bounded where the simulation diverges.

        Args:
            point: vector of the fitting problem.
            record: index of the record.
        """
        own = 1 + self.places.size + self.speeds.size
        spring, damper = point[1 : 1 + self.places.size], point[1 + self.places.size : own]
        data = self.readings[record].record
        out = np.empty(data.samples)
        start = point[own + 2 * record : own + 2 * record + 2]
        plant = _Plant(point[0], _Table(self.places, spring), _Table(self.speeds, damper))
        _simulate(data.time, self.applied[record], plant, start, out)
        reach = 100.0 * float(np.ptp(data.position))
        return np.clip(np.nan_to_num(out - data.position, nan=reach, posinf=reach, neginf=-reach), -reach, reach)

    def cost(self, point: FloatArray) -> float:
        """Half the weighted sum of squares."""
        error = sum(part.chi(self.residual(point, r)) for r, part in enumerate(self.readings))
        return 0.5 * error

    def linearise(self, point: FloatArray) -> Normal:
        """Normal equations by forward differences."""
        size = point.size
        cost, gradient, matrix = 0.0, np.zeros(size), np.zeros((size, size))
        for r, part in enumerate(self.readings):
            residual = self.residual(point, r)
            jacobian = np.empty((size, residual.size))
            for i in range(size):
                moved = point.copy()
                moved[i] += RELATIVE_STEP * self.scale[i]
                jacobian[i] = (self.residual(moved, r) - residual) / (RELATIVE_STEP * self.scale[i])
            weighted = jacobian * part.factor
            cost += 0.5 * part.chi(residual)
            gradient += weighted @ residual
            matrix += weighted @ jacobian.T
        return Normal(cost, gradient, matrix)


def measure(
    readings: Sequence[Readings], model: Model, initial: Sequence[Initial], see_base: float
) -> Characteristics | None:
    """Fit both curves to all records by simulation error.

    Positions are counted from the zero of the first record; those of the others are shifted to it.

    Args:
        readings: the records with their noise.
        model, initial: where the fit starts: the best set of causes, and how each record began under it.
        see_base: SEE of the base model [m], to which the gain refers.

    Returns:
        None where they leave no less than the base model: then they are no measurement of the rig.
    """
    readings = [_shifted(part, initial[0].zero - began.zero) for part, began in zip(readings, initial, strict=True)]
    records = tuple(part.record for part in readings)
    problem, start = _pose(tuple(readings), records, model, initial)
    lower = np.full(start.size, -np.inf)
    lower[0] = start[0] / NATURAL_RANGE
    limits = SolverOptions(lower, np.full(start.size, np.inf), problem.scale, SHORT, 1e-4, 1e-6)
    point = minimise(problem, start, limits).point
    normal = problem.linearise(point)
    inflation = max(2.0 * normal.cost / sum(part.evidence for part in readings), 1.0)
    seen = np.diag(normal.matrix) > 0.0
    covariance = np.linalg.pinv(normal.matrix * np.outer(problem.scale, problem.scale), rcond=1e-12)
    std = np.where(seen, np.sqrt(np.maximum(np.diag(covariance), 0.0) * inflation) * problem.scale, math.nan)
    found = see([problem.residual(point, r) for r in range(len(records))])
    if not found < see_base:
        return None
    knots = 1 + problem.places.size
    end = knots + problem.speeds.size
    return Characteristics(
        Curve(problem.places, point[1:knots], std[1:knots]),
        Curve(problem.speeds, point[knots:end], std[knots:end]),
        float(point[0]),
        found,
        100.0 * (see_base - found) / see_base,
    )


def _shifted(readings: Readings, by: float) -> Readings:
    """The readings as if the encoder's zero were elsewhere; ``by`` in metres."""
    record = readings.record
    return replace(readings, record=replace(record, position=record.position + by)) if by else readings


def _pose(
    readings: tuple[Readings, ...], records: tuple[Record, ...], model: Model, initial: Sequence[Initial]
) -> tuple[_Curves, FloatArray]:
    low, high = min(float(r.position.min()) for r in records), max(float(r.position.max()) for r in records)
    places = np.linspace(low, high, 2 * KNOTS - 1)
    top = max(_top_speed(record) for record in records)
    friction = friction_force(model)
    step = max(record.period for record in records)
    # Dry friction as a steep line: no steeper than the integration step can follow.
    rest = max(0.003 * top, 2.0 * friction * step / model.mass)
    positive = np.concatenate(([rest], np.linspace(max(0.1 * top, 2.0 * rest), top, KNOTS)))
    speeds = np.concatenate((-positive[::-1], positive))
    zero = initial[0].zero
    spring = model.stiffness * (places - zero)
    damper = model.damping * speeds + friction * np.sign(speeds)
    size = max(float(np.ptp(spring)), max(float(np.max(np.abs(r.force))) for r in records), 1e-9)
    starts = [value for s in initial for value in (s.position + zero, s.velocity)]
    span = high - low
    scale = np.concatenate(([model.mass], np.full(places.size + speeds.size, size), np.tile([span, top], len(records))))
    applied = tuple(_mean_force(record) for record in records)
    return _Curves(readings, places, speeds, scale, applied), np.concatenate(([model.mass], spring, damper, starts))


def _mean_force(record: Record) -> FloatArray:
    middle = 0.5 * (record.time[1:] + record.time[:-1])
    return record.force_at(middle)


def _top_speed(record: Record) -> float:
    stretch = max(record.samples // 300, 1)
    rise = np.abs(record.position[stretch:] - record.position[:-stretch])
    return float(np.max(rise / (record.time[stretch:] - record.time[:-stretch])))
