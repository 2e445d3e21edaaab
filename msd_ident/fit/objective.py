"""The sum of squares over all records, accumulated record by record so that memory holds one Jacobian at a time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from msd_ident.fit.problem import Problem
from msd_ident.fit.solver import Normal
from msd_ident.record import FloatArray

Loss = Literal["linear", "soft_l1"]


@dataclass
class SquaredError:
    """Half the sum of squares of a problem, whole or up to a horizon, plain or robust.

    ``horizon`` is the share of each record that counts: a short one has no phase to lose and so no false valleys.
    ``soft`` is the residual [m] beyond which soft-L1 loss takes over from squares; 0 means plain squares.
    Remembers the finite-difference steps that the last Gauss–Newton matrix suggests.
    """

    problem: Problem
    horizon: float = 1.0
    soft: float = 0.0
    _steps: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self._steps = self.problem.first_steps()

    def cost(self, point: FloatArray) -> float:
        """Half the sum of squares (of the soft-L1 loss) at the point."""
        return sum(
            self._cost(self.problem.residual(point, r)[: self._end(r)]) for r in range(len(self.problem.records))
        )

    def linearise(self, point: FloatArray) -> Normal:
        """Normal equations at the point; robust loss by weights (iteratively reweighted least squares)."""
        problem = self.problem
        size = problem.size
        cost, gradient, matrix = 0.0, np.zeros(size), np.zeros((size, size))
        for r in range(len(problem.records)):
            residual, jacobian = problem.linearised(point, r, self._inside(point))
            residual, jacobian = residual[: self._end(r)], jacobian[:, : self._end(r)]
            cost += self._cost(residual)
            entries = problem.entries(r)
            if self.soft > 0.0:
                weight = 1.0 / np.sqrt(1.0 + (residual / self.soft) ** 2)
                gradient[entries] += jacobian @ (weight * residual)
                matrix[np.ix_(entries, entries)] += (jacobian * weight) @ jacobian.T
            else:
                gradient[entries] += jacobian @ residual
                matrix[np.ix_(entries, entries)] += jacobian @ jacobian.T
        self._steps = problem.steps(matrix)
        return Normal(cost, gradient, matrix)

    def _inside(self, point: FloatArray) -> FloatArray:
        """The steps, turned round where they would leave the bounds."""
        _, upper = self.problem.bounds
        return np.where(point + self._steps > upper, -self._steps, self._steps)

    def _end(self, record: int) -> int:
        return max(int(self.horizon * self.problem.records[record].samples), 1)

    def _cost(self, residual: FloatArray) -> float:
        if self.soft > 0.0:
            scaled = np.sqrt(1.0 + (residual / self.soft) ** 2) - 1.0
            return float(self.soft**2 * scaled.sum())
        return 0.5 * float(residual @ residual)
