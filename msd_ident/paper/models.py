"""Models compared with the six numbers of the paper's Table 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.data.record import FloatArray, Record, from_samples
from msd_ident.features import equations
from msd_ident.model import Effect, Model, Simulator, Trajectory
from msd_ident.model.base_model import FRICTION_FORCE, DryFriction
from msd_ident.model.effects import LIBRARY
from msd_ident.paper.tables import Table1, derive, plant

LENGTHS, TIMES = ("first_peak", "second_peak", "steady_state"), ("first_time", "second_time")
#: The table's times are multiples of 8 ms, so a peak may lie 4 ms beside the time printed [s].
HALF_SAMPLE = 4e-3
#: A model reproduces the table when peaks and rest value are within the last digit printed, twice [m].
REPRODUCED = 2e-5
#: Weights of a fit: what a sample 4 ms beside a peak is lower than the peak [m], and the scatter of such a time [s].
_LENGTH_SPREAD, _TIME_SPREAD = 5e-5, HALF_SAMPLE / np.sqrt(3.0)
#: Most parameters that the five numbers of a response can decide about.
_MOST_PARAMETERS = len(LENGTHS) + len(TIMES)
#: Starting values tried for an effect.
_STARTS = 8
_PERIOD, _DURATION = 4e-3, 3.0
#: What a model without two peaks is said to be off by, in units of the spread.
_NO_PEAKS = 1e4


@dataclass(frozen=True)
class Response:
    """Step response in the terms of Table 1.

    Attributes:
        first_peak, second_peak: [m].
        first_time, second_time: of the peaks [s].
        steady_state: rest value [m].
    """

    first_peak: float
    second_peak: float
    first_time: float
    second_time: float
    steady_state: float

    def distance(self, table: Table1) -> float:
        """Largest distance of peaks and rest value from the table [m]."""
        return float(np.max(np.abs(self._off(table, LENGTHS))))

    def lateness(self, table: Table1) -> float:
        """Largest distance of the peaks' times from the table [s]."""
        return float(np.max(np.abs(self._off(table, TIMES))))

    def misfit(self, table: Table1) -> FloatArray:
        """Differences (5,) to the table, in units of the table's resolution."""
        return np.concatenate((self.lengths_off(table) / _LENGTH_SPREAD, self._off(table, TIMES) / _TIME_SPREAD))

    def lengths_off(self, table: Table1) -> FloatArray:
        """Differences (3,) of peaks and rest value to the table [m]."""
        return self._off(table, LENGTHS)

    def _off(self, table: Table1, names: Sequence[str]) -> FloatArray:
        return np.array([getattr(self, name) - getattr(table, name) for name in names])


@dataclass(frozen=True)
class Closest:
    """How near one model structure comes to the table.

    Attributes:
        cause: effect beside m, b and k.
        model: with its best parameters.
        response: of the model.
        distance: largest difference of peaks and rest value to the table [m].
        lateness: largest difference of the peaks' times to the table [s].
    """

    cause: str
    model: Model
    response: Response
    distance: float
    lateness: float

    @property
    def reproduces(self) -> bool:
        """Whether peaks and rest value agree to the digits printed, and their times to half a sample."""
        return self.distance <= REPRODUCED and self.lateness <= HALF_SAMPLE


def step_record(table: Table1) -> Record:
    """The paper's experiment without its data: the force step, for 3 s."""
    time = np.arange(0.0, _DURATION, _PERIOD)
    force = np.full(time.size, equations.step_force(table.amplitude, table.newtons_per_unit))
    return from_samples(time, force, np.zeros(time.size), name="Table 1")


def respond(model: Model, simulator: Simulator) -> Response | None:
    """Step response of a model in the terms of Table 1.

    Args:
        model: the model.
        simulator: of the same structure, on ``step_record``.

    Returns:
        None if the response has no two peaks.
    """
    path = simulator.trajectory(model.values)
    if not np.all(np.isfinite(path.position)):
        return None
    tops = np.flatnonzero((path.velocity[:-1] > 0.0) & (path.velocity[1:] <= 0.0))[:2]
    if tops.size < 2:
        return None
    (first_time, first_peak), (second_time, second_peak) = (_top(path, int(i)) for i in tops)
    return Response(first_peak, second_peak, first_time, second_time, float(path.position[-1]))


def _top(path: Trajectory, i: int) -> tuple[float, float]:
    """Time and height of the peak between samples i and i + 1: where v is 0, on the cubic through x and v."""
    h = float(path.time[i + 1] - path.time[i])
    x0, x1 = path.position[i : i + 2].tolist()
    v0, v1 = path.velocity[i : i + 2].tolist()
    s = v0 / (v0 - v1)
    bump = s * (1.0 - s) * h * ((1.0 - s) * v0 - s * v1)
    return float(path.time[i]) + s * h, x0 + (x1 - x0) * s * s * (3.0 - 2.0 * s) + bump


class _Search:
    """One structure's free parameters, scaled by their starting values, against the table."""

    def __init__(self, start: Model, simulator: Simulator, table: Table1) -> None:
        self.start, self.simulator, self.table = start, simulator, table
        self.free = np.isfinite(start.values)
        values = start.values[self.free]
        self.scale = np.where(values != 0.0, np.abs(values), 1.0)
        bounds = np.array([(parameter.lower, parameter.upper) for parameter in start.parameters])[self.free]
        self.lower, self.upper = bounds[:, 0] / self.scale, bounds[:, 1] / self.scale
        self.lower[0] = 1e-3  # A mass of 0 has no response.
        self.first = np.clip(values / self.scale, self.lower, self.upper)

    def model(self, point: FloatArray) -> Model:
        """The model at a point (k,), which is clipped to the bounds."""
        values = self.start.values.copy()
        values[self.free] = np.clip(point, self.lower, self.upper) * self.scale
        return self.start.with_values(values)

    def response(self, point: FloatArray) -> Response | None:
        """Its step response; ``None`` without two peaks."""
        return respond(self.model(point), self.simulator)

    def misfit(self, point: FloatArray) -> FloatArray:
        """Differences (5,) to the table in units of what the table can tell; large without two peaks."""
        response = self.response(point)
        return response.misfit(self.table) if response is not None else np.full(5, _NO_PEAKS)

    def least_squares(self) -> FloatArray:
        """The point (k,) of least squares from the start, within the bounds: parameters in units of ``scale``."""
        found = scipy.optimize.least_squares(
            self.misfit,
            self.first,
            bounds=(self.lower, self.upper),
            diff_step=np.full(self.first.size, 1e-6),
            x_scale=np.maximum(np.abs(self.first), 0.1),
            max_nfev=80,
        )
        return np.asarray(found.x, dtype=np.float64)

    def evenly(self, point: FloatArray) -> FloatArray:
        """The point near ``point`` whose largest length difference is least, the times left to themselves.

        The bound that holds the differences is one more unknown (SLSQP on the epigraph). The mass stays: with it
        every other parameter can follow, and times change while lengths do not.
        """

        def off(extended: FloatArray) -> FloatArray:
            response = self.response(extended[:-1])
            lengths = response.lengths_off(self.table) if response is not None else np.full(3, _LENGTH_SPREAD * 1e3)
            return np.concatenate((extended[-1] - lengths / _LENGTH_SPREAD, extended[-1] + lengths / _LENGTH_SPREAD))

        def bound(extended: FloatArray) -> float:
            return float(extended[-1])

        first = np.append(point, float(np.max(np.abs(self.misfit(point)[:3]))))
        lower, upper = np.append(self.lower, 0.0), np.append(self.upper, np.inf)
        lower[0] = upper[0] = point[0]
        found = scipy.optimize.minimize(
            bound,
            first,
            method="SLSQP",
            bounds=scipy.optimize.Bounds(lower, upper),
            constraints=scipy.optimize.NonlinearConstraint(off, 0.0, np.inf),
            options={"maxiter": 80, "ftol": 1e-6, "eps": 1e-6},
        )
        return np.asarray(found.x[:-1], dtype=np.float64)

    def closest(self, point: FloatArray) -> Closest | None:
        """How near the point comes; ``None`` without two peaks."""
        response = self.response(point)
        if response is None:
            return None
        name = "+".join(self.start.effect_names)
        return Closest(name, self.model(point), response, response.distance(self.table), response.lateness(self.table))


def _searches(starts: Sequence[Model], table: Table1) -> list[_Search]:
    simulator = Simulator(starts[0], step_record(table))
    return [_Search(start, simulator, table) for start in starts]


def nearest(starts: Sequence[Model], table: Table1) -> Closest | None:
    """The model of one structure nearest to the five numbers of the table, by least squares from several starts.

    Args:
        starts: models of the structure.
        table: the paper's numbers.

    Returns:
        None if no model has two peaks.
    """
    return _nearest([search.closest(search.least_squares()) for search in _searches(starts, table)], table)


def _nearest(found: Sequence[Closest | None], table: Table1) -> Closest | None:
    known = [one for one in found if one is not None]
    return min(known, key=lambda one: float(np.sum(one.response.misfit(table) ** 2)), default=None)


def nearest_coulomb(table: Table1) -> tuple[Closest, Closest] | None:
    """The viscous + Coulomb model nearest by least squares, and the most even one.

    The most even one has the least largest difference of a peak or the rest value that any such model has, at any
    times. ``None`` when no such model has two peaks.
    """
    searches = _searches(coulomb_starts(table), table)
    points = [search.least_squares() for search in searches]
    near = _nearest([search.closest(point) for search, point in zip(searches, points, strict=True)], table)
    found = [search.closest(search.evenly(point)) for search, point in zip(searches, points, strict=True)]
    even = min((one for one in found if one is not None), key=lambda one: one.distance, default=None)
    return (near, even) if near is not None and even is not None else None


def coulomb_starts(table: Table1) -> list[Model]:
    """Viscous + Coulomb models around the paper's, from little to much dry friction."""
    derived = derive(table)
    base = plant(derived)
    return [
        base.with_values({"damping": part * derived.damping}) + DryFriction(share * derived.force)
        for share, part in ((0.003, 1.5), (0.01, 1.0), (0.03, 0.7), (0.06, 0.2))
    ]


def single_causes(table: Table1) -> tuple[Closest, ...]:
    """Models with one effect beside m, b and k, nearest to the table first.

    Effects with more parameters than the table can determine are left out, and those that change in time or act on the
    sensor.

    Args:
        table: the paper's numbers.
    """
    base = plant(derive(table))
    record = step_record(table)
    position = Simulator(base, record).positions(base.values)
    pretended = from_samples(record.time, record.force, position, name=record.name)
    found = [
        _with_effect(effect, base, pretended, table)
        for effect in LIBRARY
        if _shows(effect) and not effect.angular and _decidable(effect)
    ]
    return tuple(sorted((one for one in found if one is not None), key=lambda one: (not one.reproduces, one.distance)))


def undecidable() -> tuple[str, ...]:
    """Effects with more parameters than the table can determine."""
    return tuple(effect.name for effect in LIBRARY if _shows(effect) and not effect.angular and not _decidable(effect))


def _shows(effect: type[Effect]) -> bool:
    """Whether the effect is one of the plant in a single step: no drift, no disturbance from outside."""
    return effect.steady and effect.acts_on != "sensor"


def _decidable(effect: type[Effect]) -> bool:
    return 3 + len(effect.parameters) <= _MOST_PARAMETERS


def _with_effect(effect: type[Effect], base: Model, record: Record, table: Table1) -> Closest | None:
    starts = [base + guess for guess in effect.guess(record, base)[:_STARTS]]
    if starts and FRICTION_FORCE in starts[0].names:
        # A law that has Coulomb's as a special case begins there too, so its sum of squares is never larger.
        neutral = dict(effect.neutral)
        known = [dict(zip(one.names, one.values.tolist(), strict=True)) for one in coulomb_starts(table)]
        starts += [starts[0].with_values({**neutral, **values}) for values in known]
    return nearest(starts, table) if starts else None
