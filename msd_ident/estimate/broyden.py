"""Levenberg–Marquardt with few simulations: the Jacobian is updated by Broyden's formula and computed anew when needed.

``fit`` computes its Jacobian at every step, which is the most reliable way to one result. The search over causes fits
some fifty models to one record, most of them wrong, and each starts from a smaller model whose Jacobian is known. The
columns of that Jacobian are reused, and later steps update them from the simulations that are made anyway (Broyden
1965). It is computed anew where a step with an updated Jacobian fails or gains little.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.estimate.damped_step import damped_step
from msd_ident.estimate.jacobian import broyden_update, safe_steps, with_rows
from msd_ident.estimate.levels import DAMPING, STUCK
from msd_ident.estimate.problem import Problem
from msd_ident.tuning import fixed

_TOGETHER = fixed(1_000_000, "resources", "readings that are simulated in one call: starts of a set, side by side")


@dataclass(frozen=True)
class State:
    """A point of the search with its residual and Jacobian.

    Attributes:
        point: (p,) vector of the problem.
        residual: (n,) weighted residual of all records, in units of the noise.
        jacobian: (p, n) derivatives of ``residual``.
        normal: Gauss–Newton matrix (p, p), the product of the Jacobian with its transpose.
        exact: whether the Jacobian was computed at this point; False after an update.
        damping: with which the next descent begins. With the first one, it would make short steps along a bent valley.
    """

    point: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    normal: FloatArray
    exact: bool
    damping: float = DAMPING

    @classmethod
    def at(cls, point: FloatArray, residual: FloatArray, jacobian: FloatArray, *, exact: bool) -> State:
        """The state with the Gauss–Newton matrix of its Jacobian."""
        return cls(point, residual, jacobian, jacobian @ jacobian.T, exact)

    @cached_property
    def chi(self) -> float:
        """Sum of squares."""
        return float(self.residual @ self.residual)

    @cached_property
    def gradient(self) -> FloatArray:
        """Half the gradient (p,) of the sum of squares."""
        return np.asarray(self.jacobian @ self.residual)


@dataclass(frozen=True)
class Weighting:
    """A problem with weighted samples.

    Attributes:
        problem: model and records.
        roots: for each record the (n,) square roots of its samples' weights [1/m]; they turn metres into units of the
            noise.
    """

    problem: Problem
    roots: tuple[FloatArray, ...]

    def residual(self, point: FloatArray) -> FloatArray:
        """Weighted residual (n,) of all records."""
        parts = [self.problem.residual(point, r, root) for r, root in enumerate(self.roots)]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def exact(self, point: FloatArray, steps: FloatArray, residual: FloatArray | None = None) -> State:
        """Residual and Jacobian at a point by forward differences.

        Args:
            point: (p,) vector of the problem.
            steps: (p,) positive finite-difference steps. A step is enlarged where rounding would swallow it, and its
                sign is changed where it would leave the upper bound.
            residual: (n,) weighted residual at the point; simulated if None.
        """
        residual = self.residual(point) if residual is None else residual
        steps = safe_steps(point, steps, self.problem.upper)
        jacobian = np.zeros((point.size, residual.size))
        begin = 0
        for r, root in enumerate(self.roots):
            inside = slice(begin, begin + root.size)
            moved = self.problem.simulated(r)
            points = np.repeat(point[None, :], moved.size, axis=0)
            points[np.arange(moved.size), moved] += steps[moved]
            rows = self.problem.residuals(points, r, root)
            rows -= residual[inside]
            rows /= steps[moved][:, None]
            jacobian[self.problem.entries(r)[moved.size :], inside] = root  # of a zero
            jacobian[moved, inside] = rows
            begin = inside.stop
        return State.at(point, residual, jacobian, exact=True)

    def renewed(self, state: State) -> State:
        """The same point with its Jacobian computed there, by steps that follow from the last Jacobian."""
        return replace(self.exact(state.point, self.steps(state), state.residual), damping=state.damping)

    def columns(
        self, points: Sequence[FloatArray], entries: npt.NDArray[np.intp], steps: FloatArray
    ) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Weighted residual (n,) at each point, and its derivatives (q, n) with respect to some entries of the vector.

        Args:
            points: (p,) vectors of the problem.
            entries: (q,) indices of the entries to move.
            steps: (p,) positive steps of forward differences, as in ``exact``.
        """
        together = max(_TOGETHER // (sum(root.size for root in self.roots) * (1 + entries.size)), 1)
        for first in range(0, len(points), together):
            yield from self._columns(points[first : first + together], entries, steps)

    def _columns(
        self, points: Sequence[FloatArray], entries: npt.NDArray[np.intp], steps: FloatArray
    ) -> Iterator[tuple[FloatArray, FloatArray]]:
        """``columns`` of points that are simulated together."""
        moved = np.repeat(np.array(points), 1 + entries.size, axis=0)
        for point, rows in zip(points, np.split(moved, len(points)), strict=True):
            rows[1 + np.arange(entries.size), entries] += safe_steps(point, steps, self.problem.upper)[entries]
        parts = [self.problem.residuals(moved, r, root) for r, root in enumerate(self.roots)]
        simulated = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)
        for first, point in zip(range(0, len(moved), 1 + entries.size), points, strict=True):
            residual, columns = simulated[first], simulated[first + 1 : first + 1 + entries.size] - simulated[first]
            columns /= (moved[first + 1 + np.arange(entries.size), entries] - point[entries])[:, None]
            yield residual.copy(), columns

    def steps(self, state: State | None) -> FloatArray:
        """Finite-difference steps: from the last Jacobian, or from natural sizes."""
        if state is None:
            return self.problem.first_steps()
        return self.problem.steps(state.normal / self._mean)

    @cached_property
    def _mean(self) -> float:
        """Mean weight of a sample."""
        return max(float(np.mean([np.vdot(root, root) / root.size for root in self.roots])), 1e-300)


def step(problem: Problem, state: State, damping: float) -> tuple[FloatArray, float]:
    """Levenberg–Marquardt step inside the bounds (``damped_step``).

    Args:
        problem: gives the bounds.
        state: point, residual and Jacobian.
        damping: added to the diagonal of the normal matrix after that is scaled to a unit diagonal.

    Returns:
        The step (p,), and the decrease of chi² that the linear model predicts for it.
    """
    lowest, highest = problem.lower - state.point, problem.upper - state.point
    move, promised = damped_step(state.normal, state.gradient, damping, lowest, highest)
    return move, float(promised)


def descend(weighting: Weighting, state: State, steps: int, least_gain: float) -> State:
    """Levenberg–Marquardt iterations with Broyden updates of the Jacobian.

    Args:
        weighting: problem and weights of the samples.
        state: where to start, and with which damping; its Jacobian need not be exact.
        steps: largest number of accepted steps.
        least_gain: predicted decrease of chi² below which the search ends. It ends only at an exact Jacobian: an
            updated one is computed anew first.

    Returns:
        The last state. Its Jacobian may be an updated one (``exact`` False) if the number of steps ended the search.
    """
    damping, growth = state.damping, 4.0
    taken = 0
    while taken < steps and damping < STUCK:
        move, promised = step(weighting.problem, state, damping)
        if promised < least_gain:
            if state.exact:
                break
            state = weighting.renewed(state)
            continue
        point = np.minimum(np.maximum(state.point + move, weighting.problem.lower), weighting.problem.upper)
        residual = weighting.residual(point)
        gain = state.chi - float(residual @ residual)
        if gain > 0.1 * promised or (gain > 0.0 and state.exact):
            state = _updated(state, point, residual)
            damping, growth = max(damping * (0.2 if gain > 0.5 * promised else 1.0), 1e-9), 4.0
            taken += 1
            if gain < 0.3 * promised:
                state = weighting.renewed(state)
        elif not state.exact:
            state = weighting.renewed(state)
        else:
            damping, growth = damping * growth, growth * 2.0
    return replace(state, damping=min(damping, DAMPING))


def _updated(state: State, point: FloatArray, residual: FloatArray) -> State:
    """The state at another point, its Jacobian updated by Broyden's formula."""
    move = point - state.point
    if not move.any():
        return State(point, residual, state.jacobian, state.normal, False)
    return State(point, residual, *broyden_update(move, residual - state.residual, state.jacobian, state.normal), False)


def extended(weighting: Weighting, parent: Problem, known: State, points: Sequence[FloatArray]) -> list[State]:
    """Starts for a model from the end of a smaller one: its Jacobian rows are reused, those of new entries computed.

    Args:
        weighting: problem and weights of the larger model.
        parent: the smaller model's problem, all entries of which stand in the larger one under the same names.
        known: the smaller model's state.
        points: (p,) starts of the larger problem.
    """
    place = {name: i for i, name in enumerate(parent.names)}
    places = np.array([place.get(name, -1) for name in weighting.problem.names])
    found = weighting.columns(points, np.flatnonzero(places < 0), weighting.steps(None))
    return [
        State(point, residual, *with_rows(known.jacobian, known.normal, places, columns), False)
        for point, (residual, columns) in zip(points, found, strict=True)
    ]
