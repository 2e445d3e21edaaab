"""Rest before the first push as a constraint, for models that the samples alone do not determine.

After one step from an unknown zero, all forces and the zero can be scaled together without changing a sample: the cart
swings about the place where the step leaves it, and the distance from there to the relaxed spring is not measured. Rest
before the step determines it: spring and offset cancelled, within what friction holds (``estimate.formulation``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import State, Weighting
from msd_ident.estimate.damped_step import damped_step
from msd_ident.estimate.effort import SHORT, THOROUGH
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import in_force_unit
from msd_ident.estimate.problem import Problem, RestConstraint
from msd_ident.model.declarations import PLACE
from msd_ident.residuals.noise_model import Readings
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import weigh
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import LEAST_FALL
from msd_ident.selection.ranking import DECISIVE


def rest_constraints(fitted: Hypothesis) -> tuple[RestConstraint, ...]:
    """Constraint from rest at the start of each record."""
    problem = fitted.problem
    kept = frozenset(problem.model.names) - set(problem.names[: len(problem.free)])
    return formulate(fitted.model, problem.records, kept).balances


def information(problem: Problem, point: FloatArray, known: Sequence[RestConstraint]) -> FloatArray:
    """Information (p, p) that rest at the start of records adds.

    Args:
        problem: model and records.
        point: (p,) vector at which it is computed.
        known: the constraints, as ``rest_constraints`` gives them.
    """
    added = np.zeros((problem.size, problem.size))
    for balance in known:
        _, slope = problem.imbalance(point, balance)
        added += np.outer(slope, slope) / balance.spread**2
    return added


def constrained(fitted: Hypothesis, readings: Sequence[Readings], known: Sequence[RestConstraint]) -> Hypothesis:
    """The same set, moved so that it also agrees with rest at the start, as far as the samples allow it.

    At the edge of sticking a start may fit the noise a little better and seem sharply determined. Inside the range of
    sticking all starts are equally good, and there are many more of them. So the middle of that range is taken unless
    that is decisively less likely, with the constraints included.

    If the samples are decisively less likely in the moved set, the cart was not at rest at that balance: the set stays
    as it is, without the constraints.

    Args:
        fitted: the set.
        readings: the records with their weights.
        known: the constraints, as ``rest_constraints`` gives them.

    Returns:
        The set, whose problem has the constraints that hold (``Problem.balances``).
    """
    problem = replace(fitted.problem, balances=tuple(known))
    fitted = replace(fitted, problem=problem)
    if _pull(problem, fitted.point, known) < LEAST_FALL:
        return fitted
    weighting = weigh(problem, readings)
    found = []
    for start in (fitted.point, _rescaled(fitted, known)):
        state = _descend(weighting, weighting.exact(start, weighting.steps(fitted.state)), known)
        found.append((state.chi + _pull(problem, state.point, known), state))
    (there, stayed), (middle, moved) = found
    state = moved if middle < there + 2.0 * DECISIVE else stayed
    error = NoiseScale(sum(part.evidence for part in readings)).spread(fitted.chi)
    if state.chi > fitted.chi + 2.0 * DECISIVE * error:
        return replace(fitted, problem=replace(problem, balances=()))
    return replace(fitted, model=problem.model.with_values(problem.values(state.point)), state=state)


def _pull(problem: Problem, point: FloatArray, known: Sequence[RestConstraint]) -> float:
    return sum((problem.imbalance(point, balance)[0] / balance.spread) ** 2 for balance in known)


def _rescaled(fitted: Hypothesis, known: Sequence[RestConstraint]) -> FloatArray:
    """The vector (p,) with all forces scaled so that the first constrained record starts at the relaxed spring."""
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
    """The vector with breakaway forces not below the sliding ones, where they have no influence."""
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
        move = damped_step(normal, slope, damping, problem.lower - state.point, problem.upper - state.point)[0]
        point = _with_peak(problem, np.clip(state.point + move, problem.lower, problem.upper))
        residual = weighting.residual(point)
        reached = float(residual @ residual) + _pull(problem, point, known)
        if reached < cost:
            worth = cost - reached > LEAST_FALL
            state = weighting.exact(point, weighting.steps(state), residual)
            cost, damping, taken = reached, max(0.1 * damping, 1e-9), taken + 1
            if not worth or taken >= SHORT:
                break
        elif (damping := 10.0 * damping) > 1e4:
            break
    return state
