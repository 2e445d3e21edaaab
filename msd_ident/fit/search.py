"""Where to start, and which of several valleys to believe.

Starts come from the linear regression (which has no local minima), from the values that the model was given, and from
whatever else the caller offers (an effect's guesses, a grid over a delay). All are simulated once; the best are
refined. Where even the best fits poorly, the horizon is grown: over the first few swings a wrong frequency cannot yet
slip by a whole cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.fit.objective import SquaredError
from msd_ident.fit.problem import Problem
from msd_ident.fit.solver import Limits, Outcome, minimise
from msd_ident.record import FloatArray

#: A fit that leaves less than this part of the motion's spread is in the right valley.
_GOOD = 0.02
_REFINED = 3
_SHORT = 12
_HORIZONS = (0.03, 0.06, 0.12, 0.25, 0.5)


def limits(problem: Problem, iterations: int = 60) -> Limits:
    """Bounds and sizes of a problem for the solver."""
    lower, upper = problem.bounds
    return Limits(lower, upper, problem.scale, iterations)


def search(problem: Problem, starts: Sequence[FloatArray]) -> Outcome:
    """The deepest valley found from any of the starts (vectors of the problem)."""
    objective = SquaredError(problem)
    costs = np.array([objective.cost(start) for start in starts])
    order = np.argsort(costs)
    best = minimise(objective, starts[order[0]], limits(problem))
    if _relative(problem, best) < _GOOD or len(starts) == 0:
        return best
    for index in order[1:_REFINED]:
        best = _better(best, minimise(objective, starts[index], limits(problem, _SHORT)))
    if _relative(problem, best) > 5.0 * _GOOD:
        for index in order[:_REFINED]:
            best = _better(best, _growing(problem, starts[index]))
    return minimise(objective, best.point, limits(problem))


def robust(problem: Problem, start: Outcome, softness: float) -> Outcome:
    """Refine with soft-L1 loss: residuals beyond ``softness`` [m] count by their size, not its square."""
    return minimise(SquaredError(problem, soft=softness), start.point, limits(problem))


def _growing(problem: Problem, start: FloatArray) -> Outcome:
    point = start
    for horizon in _HORIZONS:
        point = minimise(SquaredError(problem, horizon=horizon), point, limits(problem, _SHORT)).point
    return minimise(SquaredError(problem), point, limits(problem, _SHORT))


def _better(one: Outcome, other: Outcome) -> Outcome:
    return one if one.cost <= other.cost else replace(other, iterations=one.iterations + other.iterations)


def _relative(problem: Problem, outcome: Outcome) -> float:
    """Root mean square residual as a part of the motion's spread."""
    samples = sum(record.samples for record in problem.records)
    return float(np.sqrt(2.0 * outcome.cost / samples)) / problem.typical.length
