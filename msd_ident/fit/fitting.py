"""fit: parameters of a model from one record or several, by simulation error."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Literal

import numpy as np

from msd_ident import quality
from msd_ident.errors import UsageError
from msd_ident.fit import openness, uncertainty
from msd_ident.fit.noise import noise_floor
from msd_ident.fit.objective import Loss, SquaredError
from msd_ident.fit.posing import Zero, pose, start_vectors
from msd_ident.fit.problem import Problem
from msd_ident.fit.result import FitResult
from msd_ident.fit.search import limits, robust, valleys
from msd_ident.fit.see import see
from msd_ident.fit.solver import Outcome, minimise
from msd_ident.fit.units import unit_in
from msd_ident.model import Model
from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray, Record

Search = Literal["wide", "near"]

KNOWN_UNITS = (("N", "m"), ("N·m", "rad"))


def fit(
    model: Model,
    records: Record | Sequence[Record],
    *,
    fixed: Mapping[str, float] | Collection[str] = (),
    zero: Zero = "free",
    loss: Loss = "linear",
    starts: Sequence[Model] = (),
    search: Search = "wide",
) -> FitResult:
    """Fit a model to all records at once: shared parameters, each record its own initial state and zero.

    Args:
        model: structure and starting values.
        records: one record or several.
        fixed: parameters to keep: a mapping gives their values, a collection of names keeps the model's.
        zero: ``free`` when the encoder's zero need not be the relaxed spring, ``known`` when it is.
        loss: ``soft_l1`` when single samples are wild.
        starts: further models of the same structure to start from, e.g. with an effect's guesses.
        search: ``wide`` starts from a regression and from all starts, ``near`` only from the values given.

    Returns:
        The fit; one that failed says so in ``converged`` and ``message``.

    Raises:
        UsageError: no record, an unknown name in ``fixed``, a start of another structure, or nothing left to fit.
    """
    group = (records,) if isinstance(records, Record) else tuple(records)
    problem = pose(model, group, fixed, zero)
    outcome = _solve(problem, [_same_structure(model, other) for other in starts], search)
    if loss == "soft_l1":
        outcome = robust(problem, outcome, _softness(problem, outcome))
    return conclude(problem, outcome)


def _same_structure(model: Model, other: Model) -> Model:
    if other.names != model.names:
        raise UsageError(f"a start has {', '.join(other.names)}; expected the model's {', '.join(model.names)}")
    return other


def _solve(problem: Problem, models: Sequence[Model], width: Search) -> Outcome:
    vectors = start_vectors(problem, models)
    if width == "near":
        return minimise(SquaredError(problem), vectors[-1], limits(problem))
    return valleys(problem, noise_floor(problem.records)).deepest(vectors)


def _softness(problem: Problem, outcome: Outcome) -> float:
    """1.5 robust standard deviations of the residual, never below the noise floor."""
    residual = np.concatenate([problem.residual(outcome.point, r) for r in range(len(problem.records))])
    spread = 1.4826 * float(np.median(np.abs(residual - np.median(residual))))
    floor = noise_floor(problem.records)
    return 1.5 * max(spread, floor if math.isfinite(floor) else 0.0, 1e-12 * problem.typical.length)


def conclude(problem: Problem, outcome: Outcome) -> FitResult:
    """Intervals, open directions and the result, at the point where the solver ended."""
    point = outcome.point
    steps = 10.0 * problem.steps(SquaredError(problem).linearise(point).matrix)
    size = problem.size
    bread, meat = np.zeros((size, size)), np.zeros((size, size))
    residuals, effective = [], 0.0
    for r, record in enumerate(problem.records):
        residual, jacobian = problem.central(point, r, steps)
        entries = np.ix_(problem.entries(r), problem.entries(r))
        sensed = uncertainty.Sensed(residual, jacobian, residual + record.position, quality.encoder_step(record))
        found = uncertainty.evidence(sensed)
        bread[entries] += jacobian @ jacobian.T
        meat[entries] += found.meat
        residuals.append(residual)
        effective += found.effective_samples
    inverse, _ = uncertainty.pseudo_inverse(bread, openness.NULL)
    freedom = effective / max(effective - min(size, 0.5 * effective), 1.0)
    covariance = freedom * inverse @ meat @ inverse
    return _result(problem, outcome, bread, covariance, tuple(residuals), effective)


def _result(
    problem: Problem,
    outcome: Outcome,
    bread: FloatArray,
    covariance: FloatArray,
    residuals: tuple[FloatArray, ...],
    effective: float,
) -> FitResult:
    count = len(problem.free)
    found = _open(problem, outcome.point, bread, covariance)
    unknown = {name for direction in found for name in direction.names}
    values = problem.values(outcome.point)
    std = dict(zip(problem.names[:count], np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist(), strict=False))
    quantities = {}
    for parameter, value in zip(problem.model.parameters, values, strict=True):
        deviation = math.nan if parameter.name in unknown else std.get(parameter.name, 0.0)
        quantities[parameter.name] = Quantity(float(value), deviation, unit_in(parameter.unit, problem.records[0]))
    finite = bool(np.isfinite(outcome.cost)) and all(bool(np.all(np.isfinite(r))) for r in residuals)
    sentences = tuple(direction.sentence for direction in found) + _gain_sentence(problem)
    return FitResult(
        model=problem.model.with_values(values),
        quantities=quantities,
        free=problem.names[:count],
        covariance=covariance[:count, :count],
        residuals=residuals,
        see=see(residuals),
        noise_floor=noise_floor(problem.records),
        initial=problem.initials(outcome.point),
        effective_samples=effective,
        open=tuple(found),
        open_directions=sentences,
        converged=outcome.converged and finite,
        message=outcome.message,
    )


def _open(
    problem: Problem, point: FloatArray, bread: FloatArray, covariance: FloatArray
) -> list[openness.OpenDirection]:
    count = len(problem.free)
    reference = np.maximum(np.abs(point), problem.scale)
    reference[:count] = np.where(point[:count] != 0.0, np.abs(point[:count]), problem.scale[:count])
    forced = any(bool(np.any(record.force)) for record in problem.records)
    described = [
        openness.describe(direction, problem.names, point, reference, forced)
        for direction in openness.null_directions(bread, reference)
    ]
    found = [direction for direction in described if direction is not None]
    named = {name for direction in found for name in direction.names}
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return found + [d for d in openness.loose(problem.names, point, std, problem.scale) if d.names[0] not in named]


def _gain_sentence(problem: Problem) -> tuple[str, ...]:
    record = problem.records[0]
    if (record.force_unit, record.position_unit) in KNOWN_UNITS:
        return ()
    names = [problem.model.names[i] for i in problem.free if problem.model.names[i] in openness.FORCES]
    return (
        f"The force is in {record.force_unit} and its gain in newtons is unknown, so {', '.join(names)} are known only "
        "up to that gain: measure the force of one input with a spring balance, or weigh the moving mass.",
    )
