"""Bounded Levenberg–Marquardt on the normal equations.

``scipy.optimize.least_squares`` solves the same problem, and a test holds this solver to its answer. It is not used for
the fit itself because it keeps several copies of the Jacobian (430 MB more at a million samples and seven parameters)
and takes twice the time at 3 000 samples. The normal equations are only p × p, whatever the length of the records.

Reference: Nielsen, IMM-REP-1999-05 (damping update); those of the step stand in ``damped_step``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.damped_step import damped_step
from msd_ident.estimate.levels import DAMPING, NULL, STUCK, TENTH


@dataclass(frozen=True)
class Normal:
    """Normal equations at a point.

    Attributes:
        cost: half the sum of squares.
        gradient: (p,) gradient of the cost.
        matrix: (p, p) Gauss–Newton matrix.
    """

    cost: float
    gradient: FloatArray
    matrix: FloatArray


class Objective(Protocol):
    """What the solver needs: the cost, and the normal equations at a point (finite everywhere)."""

    def cost(self, point: FloatArray) -> float:
        """Half the (weighted) sum of squared residuals."""

    def linearise(self, point: FloatArray) -> Normal:
        """The normal equations at the point."""


@dataclass(frozen=True)
class Solution:
    """Where the solver ended. A search that does not converge is a result too: ``converged`` is False.

    Attributes:
        point: (p,) last point.
        cost: half the sum of squares there.
        iterations: number of iterations.
        converged: whether a stopping rule was met before the iterations ran out.
        message: one sentence on how the search ended.
        matrix: (p, p) last Gauss–Newton matrix, at the point or one small step before it.
    """

    point: FloatArray
    cost: float
    iterations: int
    converged: bool
    message: str
    matrix: FloatArray | None = None


@dataclass(frozen=True)
class SolverOptions:
    """Bounds, sizes and stopping rules of the solver.

    Attributes:
        lower, upper: (p,) bounds of the point.
        scale: (p,) typical size of its entries.
        iterations: largest number of iterations.
        cost_tolerance: relative decrease of the cost below which the search ends.
        step_tolerance: relative step below which the search ends.
    """

    lower: FloatArray
    upper: FloatArray
    scale: FloatArray
    iterations: int = 60
    cost_tolerance: float = 1e-9
    step_tolerance: float = 1e-8


#: Damping at which the plain solver begins: less than a search, as its Jacobian is exact at every step.
_DAMPING_START = TENTH * DAMPING
_NO_STEP = "Converged: no step would lower the error."
_NO_SMALLER = "Converged: no smaller step lowers the error."
_SETTLED = "Converged: the error settled."


def minimise(objective: Objective, start: FloatArray, limits: SolverOptions) -> Solution:
    """Bounded nonlinear least squares by Levenberg–Marquardt.

    Args:
        objective: cost and normal equations, finite at every point inside the bounds.
        start: (p,) first point; it is moved to the bounds if it lies outside.
        limits: bounds, sizes of the entries and stopping rules.

    Returns:
        Where the iterations ended; ``converged`` is False if their number ran out.
    """
    point = np.clip(start, limits.lower, limits.upper)
    normal = objective.linearise(point)
    damping, growth = _DAMPING_START, 2.0
    for iteration in range(1, limits.iterations + 1):
        lowest, highest = limits.lower - point, limits.upper - point
        step, promised = damped_step(normal.matrix, normal.gradient, damping, lowest, highest)
        step = np.clip(point + step, limits.lower, limits.upper) - point
        expected = 0.5 * promised
        if expected <= limits.cost_tolerance * 1e-2 * normal.cost:
            return _release(objective, normal, Solution(point, normal.cost, iteration, True, _NO_STEP), limits)
        cost = objective.cost(point + step)
        gain = normal.cost - cost
        if not gain > 0.0:
            damping, growth = damping * growth, growth * 2.0
            if damping > STUCK or _small(step, point, limits):
                return _release(objective, normal, Solution(point, normal.cost, iteration, True, _NO_SMALLER), limits)
            continue
        done = gain <= limits.cost_tolerance * normal.cost and damping < 1.0
        done = done or _small(step, point, limits)
        point = np.clip(point + step, limits.lower, limits.upper)  # rounding may lie beyond
        damping, growth = damping * max(1.0 / 10.0, 1.0 - (2.0 * gain / expected - 1.0) ** 3), 2.0
        if done:
            normal = Normal(cost, normal.gradient + normal.matrix @ step, normal.matrix)
            return _release(objective, normal, Solution(point, cost, iteration, True, _SETTLED), limits)
        normal = objective.linearise(point)
    return Solution(point, normal.cost, limits.iterations, False, _not_settled(limits), normal.matrix)


def _expected_gain(normal: Normal, step: FloatArray) -> float:
    return -float(normal.gradient @ step) - 0.5 * float(step @ normal.matrix @ step)


def _release(objective: Objective, normal: Normal, outcome: Solution, limits: SolverOptions) -> Solution:
    """The outcome after one undamped step.

    Damping holds back along directions that the data tells faintly, such as the scale of a single step; the last step
    is free of it. Directions that the data does not tell at all are left alone.
    """
    diagonal = np.diag(normal.matrix)
    size = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    values, vectors = np.linalg.eigh(normal.matrix / np.outer(size, size))
    told = vectors[:, values > NULL * max(float(values[-1]), 1e-300)] / size[:, None]
    strength = values[values > NULL * max(float(values[-1]), 1e-300)]
    step = -told @ ((told.T @ normal.gradient) / strength)
    point = np.clip(outcome.point + step, limits.lower, limits.upper)
    if _expected_gain(normal, point - outcome.point) > limits.cost_tolerance * normal.cost:
        cost = objective.cost(point)
        if cost < outcome.cost:
            return replace(outcome, point=point, cost=cost, matrix=normal.matrix)
    return replace(outcome, matrix=normal.matrix)


def _not_settled(limits: SolverOptions) -> str:
    return f"Not converged: the error still fell after {limits.iterations} iterations; give a better start."


def _small(step: FloatArray, point: FloatArray, limits: SolverOptions) -> bool:
    return bool(np.all(np.abs(step) <= limits.step_tolerance * (np.abs(point) + 1e-3 * limits.scale)))
