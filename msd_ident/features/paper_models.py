"""Models against the paper's Table 1: which come how near to its six numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.features import equations
from msd_ident.features.paper_tables import Table1, derive, plant
from msd_ident.features.swings import extremes
from msd_ident.model import Effect, Model, Simulator
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.record import FloatArray, Record, from_samples

#: A model reproduces the table when peaks and rest value are within this distance [m]: the last digit printed, twice.
REPRODUCED = 2e-5
LENGTHS, TIMES = ("first_peak", "second_peak", "steady_state"), ("first_time", "second_time")
#: Lengths count by the last digit printed [m]; times by a few ms [s], as t1 and t2 − t1 disagree by 4 ms.
_LENGTH_RESOLUTION, _TIME_RESOLUTION = 1e-5, 2e-3
#: Most parameters that five numbers of a response can decide about.
_MOST_PARAMETERS = 6
_PERIOD, _DURATION = 1e-3, 3.0


@dataclass(frozen=True)
class Response:
    """Peaks, their times, and rest value of a step response. SI units."""

    first_peak: float
    second_peak: float
    first_time: float
    second_time: float
    steady_state: float

    def distance(self, table: Table1) -> float:
        """Largest distance of peaks and rest value from the table [m]."""
        return max(abs(float(getattr(self, key)) - float(getattr(table, key))) for key in LENGTHS)


@dataclass(frozen=True)
class Closest:
    """How near one model structure comes to the table: its best parameters and their response."""

    cause: str
    model: Model
    response: Response
    distance: float

    @property
    def reproduces(self) -> bool:
        """Whether peaks and rest value agree with the table to the digits printed."""
        return self.distance <= REPRODUCED


def step_record(table: Table1) -> Record:
    """The paper's experiment without its data: the force step, for 3 s."""
    time = np.arange(0.0, _DURATION, _PERIOD)
    force = np.full(time.size, equations.step_force(table.amplitude, table.newtons_per_unit))
    return from_samples(time, force, np.zeros(time.size), name="Table 1")


def respond(model: Model, simulator: Simulator) -> Response | None:
    """Step response of the model in the table's terms; ``None`` when it has no two peaks."""
    position = simulator.positions(model.values, 0.0, 0.0)
    if not np.all(np.isfinite(position)):
        return None
    first_second = simulator.record.time < 1.0
    turns = extremes(simulator.record.time[first_second], position[first_second], 1e-9)
    highs = [turn for turn in turns if turn.side > 0]
    if len(highs) < 2:
        return None
    one, two = highs[:2]
    return Response(one.value, two.value, one.time, two.time, float(position[-1]))


def closest(structure: Model, starts: Sequence[Model], table: Table1) -> Closest | None:
    """The parameters of ``structure`` whose response is nearest to the table, from several starts.

    Peaks and rest value weigh by their last digit, the times by 2 ms.
    """
    simulator = Simulator(structure, step_record(table))
    best: Closest | None = None
    for start in starts:
        model = _nearest(start, simulator, table)
        response = respond(model, simulator)
        if response is None:
            continue
        found = Closest("+".join(structure.effect_names), model, response, response.distance(table))
        if best is None or found.distance < best.distance:
            best = found
    return best


def _nearest(start: Model, simulator: Simulator, table: Table1) -> Model:
    values, free = start.values, np.isfinite(start.values)
    scale = np.where(values[free] != 0.0, np.abs(values[free]), 1.0)
    lower = np.array([parameter.lower for parameter in start.parameters])[free] / scale
    upper = np.array([parameter.upper for parameter in start.parameters])[free] / scale
    lower[0] = 1e-3  # A mass of 0 has no response.

    def model(point: FloatArray) -> Model:
        moved = values.copy()
        moved[free] = point * scale
        return start.with_values(moved)

    def residual(point: FloatArray) -> FloatArray:
        response = respond(model(point), simulator)
        return _misfit(response, table) if response is not None else np.full(5, 1e4)

    first = np.clip(values[free] / scale, lower, upper)
    found = scipy.optimize.least_squares(
        residual,
        first,
        bounds=(lower, upper),
        diff_step=np.full(first.size, 1e-5),
        x_scale=np.maximum(np.abs(first), 0.1),
        max_nfev=60,
    )
    return model(found.x)


def _misfit(response: Response, table: Table1) -> FloatArray:
    """Differences (5,) to the table in units of its resolution."""
    lengths = [getattr(response, key) - getattr(table, key) for key in LENGTHS]
    times = [getattr(response, key) - getattr(table, key) for key in TIMES]
    return np.concatenate((np.array(lengths) / _LENGTH_RESOLUTION, np.array(times) / _TIME_RESOLUTION))


def best_coulomb(table: Table1) -> Closest | None:
    """The viscous + Coulomb model, m, b, k and Fc all free, that comes nearest to the table."""
    derived = derive(table)
    starts = [plant(derived) + CoulombFriction(share * derived.force) for share in (0.0, 0.003, 0.01, 0.03)]
    starts += [start.with_values({"damping": 1.5 * derived.damping}) for start in starts]
    return closest(starts[0], starts, table)


def single_causes(table: Table1) -> tuple[Closest, ...]:
    """Every effect of the library that five numbers can decide about, alone beside m, b, k: nearest first."""
    base = plant(derive(table))
    record = step_record(table)
    position = Simulator(base, record).positions(base.values, 0.0, 0.0)
    pretended = from_samples(record.time, record.force, position, name=record.name)
    found = [_with_effect(effect, base, pretended, table) for effect in LIBRARY]
    return tuple(sorted((one for one in found if one is not None), key=lambda one: one.distance))


def _with_effect(effect: type[Effect], base: Model, record: Record, table: Table1) -> Closest | None:
    if len(base.names) + len(effect.parameters) > _MOST_PARAMETERS or not effect.steady or effect.acts_on == "sensor":
        return None
    starts = [base + guess for guess in effect.guess(record, base)[:2]]
    return closest(starts[0], starts, table) if starts else None
