"""The paper's refinement: m, b, k stay, dry friction is raised from 0 to the least SEE (eqs. 2, 14, 15)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import UsageError
from msd_ident.estimate.formulation import starts_at_rest
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.regression_init import starting_state
from msd_ident.estimate.see import see, see_reduction
from msd_ident.model import Model, Simulator
from msd_ident.model.base_model import FRICTION_FORCE, DryFriction

#: Standard gravity [m/s²].
GRAVITY = 9.81
#: Forces that are tried before the search homes in on the best.
_COARSE = 25


@dataclass(frozen=True)
class PaperRefinement:
    """The paper's two models and what the friction gained.

    Attributes:
        original: the model without friction.
        refined: the same with the dry friction of least SEE.
        initial: state and zero that both simulations start from; nothing of it is fitted.
        friction_coefficient: µ = Fc/(m g).
        see_original, see_refined: SEE of both [m], eq. 14.
        residual_original, residual_refined: (n,) model − data of both [m].
    """

    original: Model
    refined: Model
    initial: Initial
    friction_coefficient: float
    see_original: float
    see_refined: float
    residual_original: FloatArray
    residual_refined: FloatArray

    @property
    def reduction_percent(self) -> float:
        """Eq. 15."""
        return see_reduction(self.see_original, self.see_refined)


def paper_refine(model: Model, record: Record, initial: Initial | None = None) -> PaperRefinement:
    """Raise Coulomb friction from 0 to the least SEE with m, b and k kept (eqs. 2, 14, 15).

    Args:
        model: the plant that the features gave; its effects, if any, stay as they are.
        record: the measurement.
        initial: where the simulation starts; by default at the first reading, at rest if the record starts so, with the
            zero at the level before the first force.

    Raises:
        UsageError: the model has dry friction already.
    """
    if FRICTION_FORCE in model.names:
        raise UsageError(
            "the model has dry friction already; expected the plant alone: the paper starts from no friction"
        )
    start = initial if initial is not None else record_start(record)
    rubbing = model + DryFriction(0.0)
    simulator = Simulator(rubbing, record)
    place = rubbing.names.index(FRICTION_FORCE)

    def residual(force: float) -> FloatArray:
        values = rubbing.values.copy()
        values[place] = force
        rest = simulator.positions(values, start.position, start.velocity) + (start.zero - record.position)
        return np.nan_to_num(rest, nan=1e6, posinf=1e6, neginf=-1e6)

    force = _least(lambda value: see(residual(value)), _ceiling(model, record))
    before, after = residual(0.0), residual(force)
    return PaperRefinement(
        original=model,
        refined=rubbing.with_values({FRICTION_FORCE: force}),
        initial=start,
        friction_coefficient=force / (model["mass"] * GRAVITY),
        see_original=see(before),
        see_refined=see(after),
        residual_original=before,
        residual_refined=after,
    )


def record_start(record: Record) -> Initial:
    """State and zero at the first sample: the zero is the level while no force acts, or the first reading's 0."""
    position, velocity = starting_state(record)
    if starts_at_rest(record):
        velocity = 0.0
        quiet = record.position[record.time < _first_push(record)]
        level = float(np.mean(quiet)) if quiet.size > 3 else position
        return Initial(0.0, 0.0, level)
    return Initial(position, velocity, 0.0)


def _first_push(record: Record) -> float:
    pushes = np.flatnonzero(record.force)
    return float(record.force_time[pushes[0]]) if pushes.size else math.inf


def _ceiling(model: Model, record: Record) -> float:
    """More friction than this and nothing would move."""
    spring = model["stiffness"] * float(np.ptp(record.position))
    return max(float(np.max(np.abs(record.force))), spring)


def _least(error: Callable[[float], float], ceiling: float) -> float:
    """Raise the force on a coarse scale that grows from 0, then home in on the least error."""
    grid = np.concatenate(([0.0], ceiling * np.geomspace(1e-4, 1.0, _COARSE)))
    values = [error(force) for force in grid]
    best = int(np.argmin(values))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    found = scipy.optimize.minimize_scalar(error, bounds=(low, high), method="bounded", options={"xatol": 1e-7 * high})
    return float(found.x) if found.fun < values[best] else float(grid[best])
