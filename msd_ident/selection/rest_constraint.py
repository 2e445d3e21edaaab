"""Rest before the first push as a constraint, for models that the samples alone do not determine.

After one step from an unknown zero, all forces and the zero may grow together without a sample objecting: the cart
swings about where the step leaves it, and what that is to the relaxed spring nobody sees. That it stood at rest before
says it (``estimate.formulation``: spring and offset cancelled, within what friction holds).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import State, Weighting
from msd_ident.estimate.effort import SHORT, THOROUGH
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import in_force_unit
from msd_ident.estimate.problem import Problem, RestConstraint
from msd_ident.model.effects.base import PLACE
from msd_ident.residuals.noise_model import Readings
from msd_ident.selection.hypothesis import Hypothesis, weigh
from msd_ident.tuning import tuned

_WORTH = tuned(0.05, unit="chi²", why="fall that is worth another step towards rest", chosen="by hand")
_LITTLE = tuned(0.25, unit="chi²", why="pull of rest that is none", chosen="by hand")
_OBJECTION = tuned(
    9.0, unit="chi²", why="what the middle of the sticking range may leave more than its edge", chosen="by hand"
)


def rest_constraints(fitted: Hypothesis) -> tuple[RestConstraint, ...]:
    """What rest at the start of each record says."""
    problem = fitted.problem
    kept = frozenset(problem.model.names) - set(problem.names[: len(problem.free)])
    return formulate(fitted.model, problem.records, kept).balances


def information(problem: Problem, point: FloatArray, known: Sequence[RestConstraint]) -> FloatArray:
    """(p, p) information that rest adds."""
    added = np.zeros((problem.size, problem.size))
    for balance in known:
        _, slope = problem.imbalance(point, balance)
        added += np.outer(slope, slope) / balance.spread**2
    return added


def constrained(fitted: Hypothesis, readings: Sequence[Readings], known: Sequence[RestConstraint]) -> Hypothesis:
    """The same set where rest at the start agrees too, as far as the samples let it.

    On the very edge of sticking a start may gain a little from the noise, and seems sharp: one step further the cart
    would creep. Inside, all starts are as good, and there are many more of them: the middle is taken unless the samples
    object.
    """
    problem = fitted.problem
    if _pull(problem, fitted.point, known) < _LITTLE:
        return fitted
    weighting = weigh(problem, readings)
    found = []
    for start in (fitted.point, _rescaled(fitted, known)):
        state = _descend(weighting, weighting.exact(start, weighting.steps(fitted.state)), known)
        found.append((state.chi + _pull(problem, state.point, known), state))
    (there, stayed), (middle, moved) = found
    state = moved if middle < there + _OBJECTION else stayed
    return replace(fitted, model=problem.model.with_values(problem.values(state.point)), state=state)


def _pull(problem: Problem, point: FloatArray, known: Sequence[RestConstraint]) -> float:
    return sum((problem.imbalance(point, balance)[0] / balance.spread) ** 2 for balance in known)


def _cost(weighting: Weighting, point: FloatArray, known: Sequence[RestConstraint]) -> float:
    residual = weighting.residual(point)
    return float(residual @ residual) + _pull(weighting.problem, point, known)


def _rescaled(fitted: Hypothesis, known: Sequence[RestConstraint]) -> FloatArray:
    """All forces times what would have the cart start at the relaxed spring, its distance from the balance kept."""
    problem = fitted.problem
    record = problem.records[known[0].record]
    reach = float(record.force_at(record.time[:1])[0]) / max(fitted.model.stiffness, 1e-300)
    start = fitted.initial[known[0].record].position
    factor = reach / (reach - start) if reach != 0.0 and reach != start else 1.0
    if not 1.0 / NATURAL_RANGE < factor < NATURAL_RANGE:
        return fitted.point
    values = dict(zip(fitted.model.names, fitted.model.values.tolist(), strict=True))
    values |= in_force_unit(fitted.model, factor)
    for harmonic in (effect.harmonic for effect in fitted.model.effects):
        if harmonic is not None and harmonic.over == PLACE:  # the place is counted from another zero
            values[harmonic.phase] += 2.0 * np.pi * start / values[harmonic.scanned]
    initial = [
        replace(one, position=one.position - start, zero=one.zero + start) if i == known[0].record else one
        for i, one in enumerate(fitted.initial)
    ]
    return np.clip(problem.vector(values, initial), problem.lower, problem.upper)


def _with_peak(problem: Problem, point: FloatArray) -> FloatArray:
    """The vector with a breakaway force not below the sliding one: there, nothing would tell of it any more."""
    for entry, parameter in enumerate(problem.parameters):
        if parameter.not_below in problem.names:
            point[entry] = max(point[entry], point[problem.names.index(parameter.not_below)])
    return point


def _descend(weighting: Weighting, state: State, known: Sequence[RestConstraint]) -> State:
    """Levenberg–Marquardt on samples and rest together."""
    problem, damping, taken = weighting.problem, 1e-6, 0
    cost = state.chi + _pull(problem, state.point, known)
    for _ in range(THOROUGH):
        normal = state.normal + information(problem, state.point, known)
        slope = state.gradient
        for balance in known:
            left, gradient = problem.imbalance(state.point, balance)
            slope = slope + gradient * left / balance.spread**2
        size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        scaled = normal / np.outer(size, size) + damping * np.eye(size.size)
        move = -np.linalg.solve(scaled, slope / size) / size
        point = _with_peak(problem, np.clip(state.point + move, problem.lower, problem.upper))
        reached = _cost(weighting, point, known)
        if reached < cost:
            worth = cost - reached > _WORTH
            state = weighting.exact(point, weighting.steps(state))
            cost, damping, taken = reached, max(0.1 * damping, 1e-9), taken + 1
            if not worth or taken >= SHORT:
                break
        elif (damping := 10.0 * damping) > 1e4:
            break
    return state
