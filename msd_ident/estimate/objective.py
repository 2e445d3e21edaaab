"""The sum of squares over all records, accumulated record by record so that memory holds one Jacobian at a time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.least_squares import Normal
from msd_ident.estimate.problem import Problem
from msd_ident.tuning import fixed

Loss = Literal["linear", "soft_l1"]
_BLOCK = fixed(65_536, "resources", "samples of a Jacobian that are multiplied at once")


@dataclass
class SquaredError:
    """Half the (weighted) sum of squares of a problem, plain or robust.

    It keeps the finite-difference steps that follow from the last Gauss–Newton matrix.

    Attributes:
        problem: model and records.
        weights: for each record the (n,) weights of its samples; none at all means 1 each.
        soft: residual [m] beyond which soft-L1 loss takes over from squares; 0 means plain squares.
        coarse: factor on the finite-difference steps. Wide steps average over the kinks that sticking makes in the
            error.
    """

    problem: Problem
    weights: tuple[FloatArray, ...] = ()
    soft: float = 0.0
    coarse: float = 1.0
    _steps: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self._steps = self.coarse * self.problem.first_steps()

    def cost(self, point: FloatArray) -> float:
        """Half the sum of squares (of the soft-L1 loss) at the point."""
        total = sum(self._cost(self.problem.residual(point, r), r) for r in range(len(self.problem.records)))
        for balance in self.problem.balances:
            total += 0.5 * balance.weight * self.problem.imbalance(point, balance)[0] ** 2
        return total

    def linearise(self, point: FloatArray) -> Normal:
        """Normal equations at the point; robust loss by weights (iteratively reweighted least squares)."""
        problem = self.problem
        cost, gradient, matrix = 0.0, np.zeros(problem.size), np.zeros((problem.size, problem.size))
        for r in range(len(problem.records)):
            residual, jacobian = problem.linearised(point, r, self._inside(point))
            cost += self._cost(residual, r)
            entries = problem.entries(r)
            weight = self._weight(residual, r)
            gradient[entries] += jacobian @ (residual if weight is None else weight * residual)
            matrix[np.ix_(entries, entries)] += gram(jacobian, weight)
        self._steps = self.coarse * problem.steps(matrix)
        for balance in problem.balances:
            value, slope = problem.imbalance(point, balance)
            cost += 0.5 * balance.weight * value**2
            gradient += balance.weight * value * slope
            matrix += balance.weight * np.outer(slope, slope)
        return Normal(cost, gradient, matrix)

    def _weight(self, residual: FloatArray, record: int) -> FloatArray | None:
        weight = self.weights[record] if self.weights else None
        if self.soft <= 0.0:
            return weight
        robust = 1.0 / np.sqrt(1.0 + (residual / self.soft) ** 2)
        return robust if weight is None else robust * weight

    def _cost(self, residual: FloatArray, record: int) -> float:
        loss = residual**2
        if self.soft > 0.0:
            loss = 2.0 * self.soft**2 * (np.sqrt(1.0 + loss / self.soft**2) - 1.0)
        return 0.5 * float(loss @ self.weights[record] if self.weights else loss.sum())

    def _inside(self, point: FloatArray) -> FloatArray:
        """The steps, with their sign changed where they would leave the bounds."""
        return np.where(point + self._steps > self.problem.upper, -self._steps, self._steps)


def gram(jacobian: FloatArray, weight: FloatArray | None = None) -> FloatArray:
    """Weighted Gram matrix J W Jᵀ, computed in blocks of samples so that no second Jacobian is in memory.

    Args:
        jacobian: (p, n), one row for each parameter.
        weight: (n,) diagonal of W; None for 1.

    Returns:
        (p, p).
    """
    total = np.zeros((jacobian.shape[0], jacobian.shape[0]))
    for start in range(0, jacobian.shape[1], _BLOCK):
        block = jacobian[:, start : start + _BLOCK]
        total += (block if weight is None else block * weight[start : start + _BLOCK]) @ block.T
    return total


def motion_weights(position: FloatArray, step: float, block: int) -> FloatArray:
    """Weights (n,) of samples that give a rest phase the weight of one short block, however long it lasts.

    A thousand samples at rest hold little more information than one. With full weight they pull the fit to the place
    where the cart stops, which gives the error a local minimum for every number of half-swings.

    Args:
        position: (n,) measured positions [m].
        step: encoder step [m], 0 if unknown.
        block: length [samples] of a short part of a swing, the shortest stretch in which rest can be detected.

    Returns:
        1 in motion; ``block`` divided by the length of the phase at rest.
    """
    weights = np.ones(position.size)
    for start, stop in _rests(position, block, step):
        weights[start:stop] = block / (stop - start)
    return weights


def _rests(position: FloatArray, block: int, step: float) -> list[tuple[int, int]]:
    """Spans (start, stop) of at least five blocks in which the mean of the readings does not move."""
    count = position.size // block
    if count < 5:
        return []
    blocks = position[: count * block].reshape(count, block)
    noise = float(np.median(np.std(np.diff(blocks, axis=1), axis=1))) / np.sqrt(2.0)
    quiet = np.std(blocks, axis=1) < 2.0 * noise + 0.6 * step
    level = np.abs(np.diff(blocks.mean(axis=1))) < 4.0 * noise * np.sqrt(2.0 / block) + 0.6 * step
    still = quiet & np.append(level, True) & np.insert(level, 0, True)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.astype(np.int8), [0]))))
    spans = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    last = count * block
    return [(a * block, position.size if b * block == last else b * block) for a, b in spans if b - a >= 5]
