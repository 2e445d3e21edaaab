"""Joint fits of several groups: parameters that they share have one value, the others one for each group."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.comparison.estimates import Estimate
from msd_ident.data.record import FloatArray
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.least_squares import Normal, SolverOptions, minimise
from msd_ident.estimate.objective import SquaredError

#: Records of a group that a joint fit is made of, at most: the numbers come from all, the fit checks them.
MOST = 8
_ITERATIONS = 40


@dataclass(frozen=True)
class JointFit:
    """A joint fit.

    Attributes:
        differing: parameters with a value for each group.
        values: (g, p) parameters of each group.
        chi2: what it leaves, each record's residual counted as its independent pieces of evidence.
        converged: whether the solver settled.
    """

    differing: tuple[str, ...]
    values: FloatArray
    chi2: float
    converged: bool


class _Groups:
    """The sum of squares of all groups, each group's vector taken out of one common vector."""

    def __init__(self, parts: Sequence[SquaredError], places: Sequence[npt.NDArray[np.intp]], size: int) -> None:
        self._parts, self._places, self._size = parts, places, size

    def cost(self, point: FloatArray) -> float:
        return sum(part.cost(point[places]) for part, places in zip(self._parts, self._places, strict=True))

    def linearise(self, point: FloatArray) -> Normal:
        """Cost, gradient and normal matrix of all records, in the joint vector."""
        cost, gradient, matrix = 0.0, np.zeros(self._size), np.zeros((self._size, self._size))
        for part, places in zip(self._parts, self._places, strict=True):
            own = part.linearise(point[places])
            cost += own.cost
            gradient[places] += own.gradient
            matrix[np.ix_(places, places)] += own.matrix
        return Normal(cost, gradient, matrix)


def joint_fit(estimates: Sequence[Estimate], groups: Sequence[str], differing: Collection[str]) -> JointFit:
    """Fit all groups together.

    Args:
        estimates: of all records, with the same free parameters; they give the start and the weights.
        groups: names of the groups.
        differing: parameters that every group has its own value of.
    """
    free = estimates[0].fit.free
    parts, starts = [], []
    for group in groups:
        of_group = [one for one in estimates if one.source.group == group][:MOST]
        part, start = _part(of_group)
        parts.append(part)
        starts.append(start)
    places, size = _places(free, frozenset(differing), parts)
    point, count = np.zeros(size), np.zeros(size)
    lower, upper, scale = np.full(size, -np.inf), np.full(size, np.inf), np.zeros(size)
    for part, start, place in zip(parts, starts, places, strict=True):
        point[place] += start
        count[place] += 1.0
        lower[place] = np.maximum(lower[place], part.problem.lower)
        upper[place] = np.minimum(upper[place], part.problem.upper)
        scale[place] = np.maximum(scale[place], part.problem.scale)
    objective = _Groups(parts, places, size)
    outcome = minimise(objective, point / count, SolverOptions(lower, upper, scale, _ITERATIONS))
    values = np.array([outcome.point[place[: len(free)]] for place in places])
    kept = tuple(name for name in free if name in set(differing))
    return JointFit(kept, values, 2.0 * outcome.cost, outcome.converged)


def _part(estimates: Sequence[Estimate]) -> tuple[SquaredError, FloatArray]:
    """One group's sum of squares, and its vector where each record's own fit ended."""
    first = estimates[0].fit
    fixed = {name: first.model[name] for name in first.model.names if name not in first.free}
    problem = formulate(first.model, tuple(one.used for one in estimates), fixed)
    weights = []
    for one in estimates:
        left = one.fit.residuals[0]
        variance = max(float(np.mean(left**2)), 1e-300)
        part = min(one.fit.effective_samples / left.size, 1.0)
        weights.append(np.full(left.size, part / variance))
    mean = np.mean([one.values for one in estimates], axis=0)
    values = {**fixed, **dict(zip(first.free, mean.tolist(), strict=True))}
    start = problem.vector(values, [one.fit.initial[0] for one in estimates])
    return SquaredError(problem, weights=tuple(weights)), start


def _places(
    free: Sequence[str], differing: frozenset[str], parts: Sequence[SquaredError]
) -> tuple[list[npt.NDArray[np.intp]], int]:
    """For each group, where the entries of its vector stand in the common one."""
    shared = {name: place for place, name in enumerate(name for name in free if name not in differing)}
    at, found = len(shared), []
    for part in parts:
        own = part.problem.size - sum(name in shared for name in free)
        fresh = iter(range(at, at + own))
        entries = [shared[name] if name in shared else next(fresh) for name in free]
        entries += [next(fresh) for _ in range(part.problem.size - len(free))]
        found.append(np.array(entries, dtype=np.intp))
        at += own
    return found, at
