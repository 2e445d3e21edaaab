"""Levenberg–Marquardt with few simulations: the Jacobian is updated by Broyden's formula and computed anew when needed.

``fit`` computes its Jacobian at every step, which is the most reliable way to one result. The search over causes fits
some fifty models to one record, most of them wrong, and each starts from a smaller model whose Jacobian is known. The
columns of that Jacobian are reused, and later steps update them from the simulations that are made anyway (Broyden
1965). It is computed anew where a step with an updated Jacobian fails or gains little.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import DAMPING, STUCK
from msd_ident.estimate.problem import Problem
from msd_ident.tuning import fixed

_FELT = fixed(1024.0, "accuracy", "least finite-difference step, in units in the last place of what it moves")


@dataclass(frozen=True)
class State:
    """A point of the search with its residual and Jacobian.

    Attributes:
        point: (p,) vector of the problem.
        residual: (n,) weighted residual of all records, in units of the noise.
        jacobian: (p, n) derivatives of ``residual``.
        exact: whether the Jacobian was computed at this point; False after an update.
    """

    point: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    exact: bool

    @cached_property
    def chi(self) -> float:
        """Sum of squares."""
        return float(self.residual @ self.residual)

    @cached_property
    def normal(self) -> FloatArray:
        """Gauss–Newton matrix (p, p)."""
        return np.asarray(self.jacobian @ self.jacobian.T)

    @cached_property
    def size(self) -> FloatArray:
        """Root of the diagonal (p,) of ``normal``; 1 for entries without influence."""
        diagonal = np.diag(self.normal)
        return np.asarray(np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)))

    @cached_property
    def scaled(self) -> FloatArray:
        """``normal`` (p, p) in units of ``size``."""
        return np.asarray(self.normal / (self.size[:, None] * self.size))

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
        parts = [root * self.problem.residual(point, r) for r, root in enumerate(self.roots)]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def exact(self, point: FloatArray, steps: FloatArray) -> State:
        """Residual and Jacobian at a point by forward differences.

        Args:
            point: (p,) vector of the problem.
            steps: (p,) positive finite-difference steps. A step is enlarged where rounding would swallow it, and its
                sign is changed where it would leave the upper bound.
        """
        steps = np.maximum(steps, _FELT * np.spacing(np.abs(point)))
        steps = np.where(point + steps > self.problem.upper, -steps, steps)
        residuals, jacobian = [], np.zeros((point.size, sum(root.size for root in self.roots)))
        begin = 0
        for r, root in enumerate(self.roots):
            residual, columns = self.problem.linearised(point, r, steps)
            columns *= root
            jacobian[self.problem.entries(r), begin : begin + root.size] = columns
            residuals.append(root * residual)
            begin += root.size
        return State(point, np.concatenate(residuals), jacobian, True)

    def column(self, point: FloatArray, residual: FloatArray, entry: int, step: float) -> FloatArray:
        """Row (n,) of the Jacobian for one entry of the vector, by a forward difference.

        Args:
            point: (p,) vector of the problem.
            residual: (n,) weighted residual at ``point``.
            entry: index of the entry to move.
            step: positive finite-difference step, enlarged where rounding would swallow it.
        """
        moved = point.copy()
        step = max(step, _FELT * float(np.spacing(abs(point[entry]))))  # beside a huge phase a small step is none
        moved[entry] += step if point[entry] + step <= self.problem.upper[entry] else -step
        return np.asarray((self.residual(moved) - residual) / (moved[entry] - point[entry]))

    def steps(self, state: State | None) -> FloatArray:
        """Finite-difference steps: from the last Jacobian, or from natural sizes."""
        if state is None:
            return self.problem.first_steps()
        return self.problem.steps(state.normal / self._mean)

    @cached_property
    def _mean(self) -> float:
        """Mean weight of a sample."""
        return max(float(np.mean([np.mean(root**2) for root in self.roots])), 1e-300)


def step(problem: Problem, state: State, damping: float) -> tuple[FloatArray, float]:
    """Levenberg–Marquardt step inside the bounds; entries that it would move out of them are held at their bounds.

    Args:
        problem: gives the bounds.
        state: point, residual and Jacobian.
        damping: added to the diagonal of the normal matrix after that is scaled to a unit diagonal.

    Returns:
        The step (p,), and the decrease of chi² that the linear model predicts for it.
    """
    matrix, gradient = state.normal, state.gradient
    scaled = state.scaled.copy()
    scaled.reshape(-1)[:: gradient.size + 1] += damping
    move = _solve(scaled, -gradient / state.size) / state.size
    outside = _outside(problem, state.point + move)
    if outside.any():
        move = _held(problem, state, scaled, move, outside)
    return move, -2.0 * float(gradient @ move) - float(move @ matrix @ move)


def _outside(problem: Problem, point: FloatArray) -> npt.NDArray[np.bool_]:
    return (point < problem.lower) | (point > problem.upper)


def _held(
    problem: Problem, state: State, scaled: FloatArray, move: FloatArray, outside: npt.NDArray[np.bool_]
) -> FloatArray:
    """The step with the entries that it would take outside held at their bounds, one after the other."""
    move, free = np.where(outside, move, 0.0), np.ones(move.size, dtype=bool)
    while outside.any():
        at = np.minimum(np.maximum(state.point + move, problem.lower), problem.upper) - state.point
        move[outside] = at[outside]
        free &= ~outside
        index = np.flatnonzero(free)
        if index.size == 0:
            break
        right = -(state.gradient[index] + state.normal[np.ix_(index, ~free)] @ move[~free]) / state.size[index]
        move[index] = _solve(scaled[np.ix_(index, index)], right) / state.size[index]
        outside = free & _outside(problem, state.point + move)
    return move


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-12)[0], dtype=np.float64)


def descend(weighting: Weighting, state: State, steps: int, least_gain: float) -> State:
    """Levenberg–Marquardt iterations with Broyden updates of the Jacobian.

    Args:
        weighting: problem and weights of the samples.
        state: where to start; its Jacobian need not be exact.
        steps: largest number of accepted steps.
        least_gain: predicted decrease of chi² below which the search ends. It ends only at an exact Jacobian: an
            updated one is computed anew first.

    Returns:
        The last state. Its Jacobian may be an updated one (``exact`` False) if the number of steps ended the search.
    """
    damping, growth = DAMPING, 4.0
    taken = 0
    while taken < steps and damping < STUCK:
        move, promised = step(weighting.problem, state, damping)
        if promised < least_gain:
            if state.exact:
                break
            state = weighting.exact(state.point, weighting.steps(state))
            continue
        point = np.minimum(np.maximum(state.point + move, weighting.problem.lower), weighting.problem.upper)
        residual = weighting.residual(point)
        gain = state.chi - float(residual @ residual)
        if gain > 0.1 * promised or (gain > 0.0 and state.exact):
            state = _updated(state, point, residual)
            damping, growth = max(damping * (0.2 if gain > 0.5 * promised else 1.0), 1e-9), 4.0
            taken += 1
            if gain < 0.3 * promised:
                state = weighting.exact(state.point, weighting.steps(state))
        elif not state.exact:
            state = weighting.exact(state.point, weighting.steps(state))
        else:
            damping, growth = damping * growth, growth * 2.0
    return state


def _updated(state: State, point: FloatArray, residual: FloatArray) -> State:
    """Broyden's update: the least change of the Jacobian that explains what the step did."""
    scale = np.sqrt(np.maximum(np.einsum("ij,ij->i", state.jacobian, state.jacobian), 1e-300))
    move = (point - state.point) * scale  # in units in which every entry matters alike
    length = float(move @ move)
    if length == 0.0:
        return State(point, residual, state.jacobian, False)
    surprise = residual - state.residual - (point - state.point) @ state.jacobian
    jacobian = state.jacobian + np.outer(scale * move / length, surprise)
    return State(point, residual, jacobian, False)


def extended(weighting: Weighting, parent: Problem, known: State, point: FloatArray) -> State:
    """A start for a model from the end of a smaller one: its Jacobian rows are reused, those of new entries computed.

    Args:
        weighting: problem and weights of the larger model.
        parent: the smaller model's problem, all entries of which stand in the larger one under the same names.
        known: the smaller model's state.
        point: (p,) start of the larger problem.
    """
    names = weighting.problem.names
    place = {name: i for i, name in enumerate(parent.names)}
    residual = weighting.residual(point)
    jacobian = np.zeros((len(names), residual.size))
    steps = weighting.steps(None)
    for entry, name in enumerate(names):
        if name in place:
            jacobian[entry] = known.jacobian[place[name]]
        else:
            jacobian[entry] = weighting.column(point, residual, entry, float(steps[entry]))
    return State(point, residual, jacobian, False)
