"""Sets of causes, each fitted in the extended model with all parameters free, by simulation error."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from msd_ident.diagnose import resolvable
from msd_ident.diagnose.readings import Readings
from msd_ident.errors import UsageError
from msd_ident.fit.posing import pose
from msd_ident.fit.problem import Initial, Nuisance, Problem, build
from msd_ident.fit.solver import Limits, Normal, minimise
from msd_ident.model import Effect, Model
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.record import FloatArray, Record

Causes = frozenset[str]

_FIRST, _CHUNK, _CHUNKS = 3, 5, 8
_KEPT = 2
#: A set that leaves this many times the error of the best one, and has stopped falling, is not refined further.
_HOPELESS = 4.0


@dataclass(frozen=True)
class Experiment:
    """The data and what the base model is: what every candidate shares.

    ``fixed`` are the base parameters that the data cannot give (stiffness without a spring, mass in a free decay).
    """

    readings: tuple[Readings, ...]
    base: Model
    fixed: frozenset[str]

    @property
    def evidence(self) -> float:
        """Pieces of evidence in all records."""
        return sum(part.evidence for part in self.readings)

    def thinned(self, keep: int) -> Experiment:
        """The same with about ``keep`` samples in all."""
        total = sum(part.record.samples for part in self.readings)
        parts = tuple(part.thinned(max(keep * part.record.samples // total, 200)) for part in self.readings)
        return Experiment(parts, self.base, self.fixed)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records."""
        return tuple(part.record for part in self.readings)

    @cached_property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Free entries of each record: the same for all candidates."""
        return pose(self.base, self.records, self.fixed).nuisances

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Where inner parameters of the laws make sense."""
        return resolvable.ranges(self.records, self.base)

    def problem(self, model: Model) -> Problem:
        """The fitting problem of a model on these records."""
        fixed = self.fixed | switched_off(model)
        return resolvable.within(build(model, self.records, fixed, self.nuisances), self.ranges)


@dataclass(frozen=True)
class Weighted:
    """Half the sum of squares in units of the noise, each run of equal readings counted once.

    ``masks``, one (n,) array of 0 and 1 a record, leaves out samples (to predict them later).
    """

    problem: Problem
    factors: tuple[FloatArray, ...]
    steps: FloatArray

    def cost(self, point: FloatArray) -> float:
        """Half the weighted sum of squares."""
        return 0.5 * sum(float(f @ self.problem.residual(point, r) ** 2) for r, f in enumerate(self.factors))

    def linearise(self, point: FloatArray) -> Normal:
        """Normal equations at the point."""
        size = self.problem.size
        cost, gradient, matrix = 0.0, np.zeros(size), np.zeros((size, size))
        upper = self.problem.upper
        steps = np.where(point + self.steps > upper, -self.steps, self.steps)
        for r, factor in enumerate(self.factors):
            residual, jacobian = self.problem.linearised(point, r, steps)
            entries = self.problem.entries(r)
            weighted = jacobian * factor
            cost += 0.5 * float(factor @ residual**2)
            gradient[entries] += weighted @ residual
            matrix[np.ix_(entries, entries)] += weighted @ jacobian.T
        unweighted = matrix / max(sum(float(f.mean()) for f in self.factors) / len(self.factors), 1e-300)
        self.steps[:] = self.problem.steps(unweighted)
        return Normal(cost, gradient, matrix)


def objective(problem: Problem, readings: Sequence[Readings], masks: Sequence[FloatArray] | None = None) -> Weighted:
    """The weighted error of a problem, samples with mask 0 left out."""
    factors = tuple(part.factor for part in readings)
    if masks is not None:
        factors = tuple(factor * mask for factor, mask in zip(factors, masks, strict=True))
    return Weighted(problem, factors, problem.first_steps())


@dataclass(frozen=True)
class Fitted:
    """A set of causes, fitted: the model, each record's start, chi² and the information matrix in units of the noise."""

    causes: Causes
    model: Model
    problem: Problem
    point: FloatArray
    chi: float
    information: FloatArray

    @property
    def initial(self) -> tuple[Initial, ...]:
        """State and zero of each record."""
        return self.problem.initials(self.point)

    @property
    def free_parameters(self) -> int:
        """Parameters of the causes."""
        return len(self.model.names) - 3

    def residuals(self) -> tuple[FloatArray, ...]:
        """Model − data of each record [m]."""
        return tuple(self.problem.residual(self.point, r) for r in range(len(self.problem.records)))


def switched_off(model: Model) -> frozenset[str]:
    """Parameters that stand for the absence of a part of an effect: a limit at infinity, and the slope beside a limit."""
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    off = {name for name, value in values.items() if math.isinf(value)}
    if values.get("gain_slope") == 0.0 and "force_limit" not in off:
        off.add("gain_slope")
    return frozenset(off)


def causes_that_fit(causes: Causes) -> bool:
    """Whether the effects make sense together."""
    families = [by_name(name).family for name in causes if by_name(name).family]
    return len(families) == len(set(families))


def library() -> tuple[str, ...]:
    """Names of all causes."""
    return tuple(effect.name for effect in LIBRARY)


def starts(experiment: Experiment, causes: Causes, parents: Sequence[Fitted]) -> list[tuple[Model, tuple[Initial, ...]]]:
    """Models to start from: each parent's values, with guesses for the effects that it lacks."""
    found = []
    for parent in parents:
        kept = [effect for effect in parent.model.effects if effect.name in causes]
        plant = Model(parent.model.mass, parent.model.damping, parent.model.stiffness)
        models = [Model(plant.mass, plant.damping, plant.stiffness, tuple(kept))]
        for name in sorted(causes - parent.causes):
            guesses = _guesses(experiment, name, plant)
            models = [model + guess for model in models for guess in guesses]
        found += [(model, parent.initial) for model in models]
    return found


def _guesses(experiment: Experiment, name: str, plant: Model) -> tuple[Effect, ...]:
    liveliest = max(experiment.readings, key=lambda part: float(np.ptp(part.record.position)))
    guesses = by_name(name).guess(liveliest.record, plant)
    if name == "force_gain_nonlinearity":  # its other form, saturation, which no slope leads to
        largest = float(np.max(np.abs(liveliest.record.force)))
        guesses += tuple(ForceGainNonlinearity(0.0, share * largest) for share in (0.95, 0.75) if largest > 0.0)
    return guesses


def begin(experiment: Experiment, causes: Causes, parents: Sequence[Fitted]) -> list[Fitted]:
    """A few steps down from every start of a set, the best first; empty when none makes sense."""
    begun = []
    for model, initial in starts(experiment, causes, parents):
        problem = experiment.problem(model)
        values = dict(zip(model.names, model.values.tolist(), strict=True))
        begun.append(_descend(experiment, causes, problem, problem.vector(values, initial), _FIRST))
    return sorted(begun, key=lambda fitted: fitted.chi)


def finish(experiment: Experiment, begun: Sequence[Fitted], best_chi: Callable[[], float]) -> Fitted:
    """The best of a set's beginnings, refined.

    Args:
        best_chi: gives chi² of the best set so far: a set that stays far above it is not refined to the last digit.
    """
    refined = [_settled(experiment, fitted, best_chi) for fitted in _distinct(begun)[:_KEPT]]
    return min(refined, key=lambda fitted: fitted.chi)


def _distinct(begun: Sequence[Fitted]) -> list[Fitted]:
    """Beginnings that did not meet in one valley."""
    kept: list[Fitted] = []
    for fitted in begun:
        if all(abs(fitted.chi - other.chi) > 1e-3 * other.chi for other in kept):
            kept.append(fitted)
    return kept


def _settled(experiment: Experiment, fitted: Fitted, best_chi: Callable[[], float]) -> Fitted:
    for _ in range(_CHUNKS):
        before = fitted.chi
        fitted = _descend(experiment, fitted.causes, fitted.problem, fitted.point, _CHUNK)
        fall = before - fitted.chi
        if fall <= 1e-3 * max(fitted.chi - experiment.evidence, 0.0) + 0.02:
            break
        if fitted.chi > _HOPELESS * best_chi() and fall < 0.5 * before:
            break
    return fitted


def refine(experiment: Experiment, fitted: Fitted) -> Fitted:
    """The same set refined on another experiment (all samples instead of some), from where it stands."""
    problem = experiment.problem(fitted.model)
    return _settled(experiment, _descend(experiment, fitted.causes, problem, fitted.point, _CHUNK), lambda: math.inf)


def _descend(experiment: Experiment, causes: Causes, problem: Problem, point: FloatArray, iterations: int) -> Fitted:
    error = objective(problem, experiment.readings)
    lower, upper = problem.lower, problem.upper
    limits = Limits(lower, upper, problem.scale, iterations, cost_tolerance=1e-5, step_tolerance=1e-7)
    point = np.clip(minimise(error, point, limits).point, lower, upper)
    normal = error.linearise(point)
    return Fitted(causes, problem.model.with_values(problem.values(point)), problem, point, 2.0 * normal.cost, normal.matrix)
