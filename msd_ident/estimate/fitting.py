"""fit: parameters of a model from one record or several, by simulation error."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Literal

import numpy as np

from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.estimate.effort import LONG
from msd_ident.estimate.formulation import (
    Zero,
    formulate,
    guess_vectors,
    neighbour_vectors,
    own_vectors,
    regressed,
    starting_states,
    wide_vectors,
)
from msd_ident.estimate.frequency_scan import harmonic_vectors
from msd_ident.estimate.least_squares import Solution, minimise
from msd_ident.estimate.multistart import limits, robust, valleys
from msd_ident.estimate.noise_floors import noise_floor
from msd_ident.estimate.objective import Loss, SquaredError
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.estimate.result import FitResult
from msd_ident.estimate.summary import summarise_fit
from msd_ident.model import Model
from msd_ident.quantity import MAD

Search = Literal["wide", "near"]


def fit(
    model: Model,
    records: Record | Sequence[Record],
    *,
    fixed: Mapping[str, float] | Collection[str] = (),
    zero: Zero = "free",
    loss: Loss = "linear",
    starts: Sequence[Model] = (),
    search: Search = "wide",
    initial: Sequence[Initial] = (),
    steps: int = LONG,
) -> FitResult:
    """Fit a model to all records at once: shared parameters, each record its own initial state and zero.

    Args:
        model: structure and starting values.
        records: one record or several.
        fixed: parameters to keep: a mapping gives their values, a collection of names keeps the model's.
        zero: ``free`` when the encoder's zero need not be the relaxed spring, ``known`` when it is.
        loss: ``linear`` for least squares, ``soft_l1`` for data with outliers.
        starts: further models of the same structure to start from, e.g. with an effect's guesses.
        search: ``wide`` starts from a regression, from all starts and from the effects' own guesses; ``near`` only from
            the values given, for a model that is nearly right already.
        initial: with ``near``, the state and zero of each record to start from (those of an earlier fit).
        steps: with ``near``, the most iterations.

    Returns:
        The fit; one that failed says so in ``converged`` and ``message``.

    Raises:
        UsageError: no record, an unknown name in ``fixed``, a start of another structure, nothing left to fit, or
            another number of initial states than of records.
    """
    group = (records,) if isinstance(records, Record) else tuple(records)
    problem = formulate(model, group, fixed, zero)
    floor = noise_floor(group)
    models = [model, *(_same_structure(model, other) for other in starts)]
    outcome = _near(problem, models, initial, steps) if search == "near" else _wide(problem, models, floor)
    if loss == "linear":
        return summarise_fit(problem, outcome, floor)
    for _ in range(2):  # the scale of the first round is still spoiled by what it is meant to keep out
        softness = _softness(problem, outcome, floor)
        outcome = robust(problem, outcome, softness)
    return summarise_fit(problem, outcome, floor, softness)


def _same_structure(model: Model, other: Model) -> Model:
    if other.names != model.names:
        raise UsageError(f"a start has {', '.join(other.names)}; expected the model's {', '.join(model.names)}")
    return other


def _wide(problem: Problem, models: Sequence[Model], floor: float) -> Solution:
    regressions = regressed(problem)
    return valleys(problem, floor).deepest(
        wide_vectors(problem, models, regressions),
        [own_vectors(problem, model, regressions) for model in models],
        lambda best: [*harmonic_vectors(problem, best), *guess_vectors(problem, best)],
        lambda best: neighbour_vectors(problem, best, regressions),
    )


def _near(problem: Problem, models: Sequence[Model], initial: Sequence[Initial], steps: int) -> Solution:
    if initial and len(initial) != len(problem.records):
        raise UsageError(f"{len(initial)} initial states for {len(problem.records)} records; expected one each")
    states = list(initial) or [Initial(*state) for state in starting_states(problem)]
    objective = SquaredError(problem)
    outcomes = []
    for model in models:
        values = dict(zip(model.names, model.values.tolist(), strict=True))
        outcomes.append(minimise(objective, problem.vector(values, states), limits(problem, steps)))
    return min(outcomes, key=lambda outcome: outcome.cost)


def _softness(problem: Problem, outcome: Solution, floor: float) -> float:
    """1.5 robust standard deviations of the residual, never below the noise floor."""
    residual = np.concatenate([problem.residual(outcome.point, r) for r in range(len(problem.records))])
    spread = MAD * float(np.median(np.abs(residual - np.median(residual))))
    return 1.5 * max(spread, floor if math.isfinite(floor) else 0.0, 1e-12 * problem.typical.length)
