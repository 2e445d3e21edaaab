"""From the point where the solver ended to a result: intervals, open directions, sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate import covariance as uncertainty
from msd_ident.estimate import identifiability
from msd_ident.estimate.formulation import balanced
from msd_ident.estimate.least_squares import Solution
from msd_ident.estimate.levels import ALIKE
from msd_ident.estimate.objective import SquaredError, gram
from msd_ident.estimate.one_sided import open_scale
from msd_ident.estimate.parameter_units import unit_in
from msd_ident.estimate.problem import Problem
from msd_ident.estimate.result import FitResult
from msd_ident.estimate.see import see
from msd_ident.estimate.single_tone import common_tone
from msd_ident.model.joint_words import said_of
from msd_ident.model.parameters import FORCES
from msd_ident.quantity import Quantity

#: Force and position units in which mass, damping and stiffness are absolute.
_ABSOLUTE = (("N", "m"), ("N·m", "rad"))
#: What stands between an unknown gain or scale and the parameters that are known only up to it.
SCALE_SAID = ", so "


@dataclass(frozen=True)
class _Sandwich:
    """Sums over all records.

    Attributes:
        bread: (p, p) JᵀJ, with the rest at the start.
        meat: (p, p) JᵀΓJ, with the rest at the start.
        rest: (p, p) the part of ``meat`` that is the rest at the start.
        readings: (p, p) the part of ``bread`` that is the readings'.
        pinned: (p, p) information that does not come from samples.
        residuals: one (n,) for each record.
        effective: number of independent samples.
    """

    bread: FloatArray
    meat: FloatArray
    rest: FloatArray
    readings: FloatArray
    pinned: FloatArray
    residuals: tuple[FloatArray, ...]
    effective: float


def summarise_fit(problem: Problem, outcome: Solution, floor: float, soft: float = 0.0) -> FitResult:
    """The result of a fit: values, covariance, open directions and SEE.

    Args:
        problem: what was fitted.
        outcome: where the solver ended.
        floor: noise floor of the records [m]; NaN if unknown.
        soft: residual [m] beyond which the soft-L1 loss grows linearly; 0 for plain squares.
    """
    sums = _sandwich(problem, outcome, soft)
    found, null = _open(problem, outcome.point, sums)
    if not _moves(problem, floor):
        found = [identifiability.motionless(problem.names[: len(problem.free)])]
    if not any("mass" in direction.names for direction in found):
        found += _of_a_tone(problem, outcome.point, see(sums.residuals), floor)
    inverse = uncertainty.inverse_beside(sums.bread, null)
    effective = sums.effective
    freedom = effective / max(effective - min(problem.size, 0.5 * effective), 1.0)
    covariance = freedom * inverse @ sums.meat @ inverse
    if not found:
        found += _of_one_side(problem, outcome.point, sums, covariance, soft)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    named = {name for direction in found for name in direction.names}
    loose = identifiability.loose(problem.names, outcome.point, std, problem.scale)
    found += [direction for direction in loose if direction.names[0] not in named]
    count = len(problem.free)
    covariance = covariance[:count, :count]
    covariance.setflags(write=False)
    unit = problem.records[0].position_unit
    advice = tuple(direction.sentence for direction in found) + _gain_sentence(problem)
    return FitResult(
        model=problem.model.with_values(problem.values(outcome.point)),
        quantities=_quantities(problem, outcome.point, std, found),
        free=problem.names[:count],
        covariance=covariance,
        plain=(inverse @ sums.readings @ inverse)[:count, :count],
        rest=(inverse @ sums.rest @ inverse)[:count, :count],
        residuals=sums.residuals,
        see=see(sums.residuals),
        noise_floor=floor,
        initial=problem.initials(outcome.point),
        effective_samples=effective,
        open=tuple(found),
        open_directions=_unmoved_sentence(problem, found) + tuple(said_of(one, unit) for one in advice),
        converged=outcome.converged and _finite(outcome, sums.residuals),
        message=outcome.message,
    )


def _of_one_side(
    problem: Problem, point: FloatArray, sums: _Sandwich, covariance: FloatArray, soft: float
) -> list[identifiability.OpenDirection]:
    """The scale of all forces as an open direction, where the data shows it on one side alone."""
    direction = open_scale(problem, point, sums.bread, covariance, soft)
    if direction is None:
        return []
    reference = np.maximum(np.abs(point), problem.scale)
    found = identifiability.describe(direction / reference, problem.names, point, reference, forced=True)
    return [] if found is None else [found]


def _of_a_tone(problem: Problem, point: FloatArray, left: float, floor: float) -> list[identifiability.OpenDirection]:
    """Mass and stiffness as one open direction, where all records are one tone and the model leaves more than noise."""
    omega = common_tone(problem.records) if {"mass", "stiffness"} <= set(problem.names) else 0.0
    if not omega or not left > ALIKE * floor:
        return []
    values = dict(zip((parameter.name for parameter in problem.model.parameters), problem.values(point), strict=True))
    record = problem.records[0]
    known = f"{values['stiffness'] - values['mass'] * omega**2:.4g} {record.force_unit}/{record.position_unit}"
    return [identifiability.of_a_tone(omega, known)]


def _moves(problem: Problem, floor: float) -> bool:
    """Whether any record shows more than noise and one encoder step."""
    still = max(10.0 * floor if np.isfinite(floor) else 0.0, max(problem.encoder_steps))
    return any(float(np.ptp(record.position)) > still for record in problem.records)


def _finite(outcome: Solution, residuals: tuple[FloatArray, ...]) -> bool:
    return bool(np.isfinite(outcome.cost)) and all(bool(np.all(np.isfinite(residual))) for residual in residuals)


def _sandwich(problem: Problem, outcome: Solution, soft: float) -> _Sandwich:
    point = outcome.point
    matrix = outcome.matrix if outcome.matrix is not None else SquaredError(problem).linearise(point).matrix
    steps = 10.0 * problem.steps(matrix)
    size = problem.size
    bread, meat, rest, pinned = (np.zeros((size, size)) for _ in range(4))
    residuals, pulls, effective = [], [], 0.0
    for r, record in enumerate(problem.records):
        residual, jacobian = problem.central(point, r, steps)
        entries = np.ix_(problem.entries(r), problem.entries(r))
        weight = 1.0 / np.sqrt(1.0 + (residual / soft) ** 2) if soft > 0.0 else None
        pull = residual if weight is None else weight * residual
        sensed = uncertainty.Linearisation(pull, jacobian, residual + record.position, problem.encoder_steps[r])
        bread[entries] += gram(jacobian, None if weight is None else weight**3)  # the slope of the loss, not its weight
        found = uncertainty.evidence(sensed)
        meat[entries] += found.meat
        residual.setflags(write=False)
        residuals.append(residual)
        pulls.append(pull)
        effective += found.effective_samples
    readings = bread.copy()
    if problem.balances:
        fitted = problem.model.with_values(problem.values(point))
        resting = [balance.record for balance in problem.balances]
        for balance in balanced(problem, fitted, see(pulls), resting).balances:
            _, slope = problem.imbalance(point, balance)
            bread += balance.weight * np.outer(slope, slope)
            rest += (balance.weight * balance.spread) ** 2 * np.outer(slope, slope)
            pinned += np.outer(slope, slope) / balance.spread**2
    return _Sandwich(bread, meat + rest, rest, readings, pinned, tuple(residuals), effective)


def _open(
    problem: Problem, point: FloatArray, sums: _Sandwich
) -> tuple[list[identifiability.OpenDirection], FloatArray]:
    """Null directions as sentences (without those of initial states alone), and as columns (p, q)."""
    reference = np.maximum(np.abs(point), problem.scale)
    forced = any(bool(np.any(record.force)) for record in problem.records)
    directions = identifiability.null_directions(sums.bread, reference, sums.pinned)
    described = [identifiability.describe(one, problem.names, point, reference, forced) for one in directions]
    null = np.array([direction * reference for direction in directions]).reshape(len(directions), problem.size).T
    return [direction for direction in described if direction is not None], null


def _quantities(
    problem: Problem, point: FloatArray, std: FloatArray, found: list[identifiability.OpenDirection]
) -> dict[str, Quantity]:
    """Quantities of all parameters; std is 0 for fixed ones and NaN for open ones."""
    unknown = {name for direction in found for name in direction.names}
    spread = dict(zip(problem.names, std.tolist(), strict=True))
    quantities = {}
    for parameter, value in zip(problem.model.parameters, problem.values(point), strict=True):
        deviation = math.nan if parameter.name in unknown else spread.get(parameter.name, 0.0)
        quantities[parameter.name] = Quantity(float(value), deviation, unit_in(parameter.unit, problem.records[0]))
    return quantities


def _unmoved_sentence(problem: Problem, found: Sequence[identifiability.OpenDirection]) -> tuple[str, ...]:
    """A sentence where mass, damping and stiffness are open each by itself although the record moves."""
    free = {problem.model.names[i] for i in problem.free}
    opened = [free & set(direction.names) for direction in found]
    alone = set().union(*(names for names in opened if len(names) == 1))
    plant = free & {"mass", "damping", "stiffness"}
    if "mass" not in plant or not plant <= alone:
        return ()
    return (
        "The force of this record explains none of its motion, so no parameter with a unit of force is known: a hand "
        "or a position controller moves the cart, or the encoder is inverted (try a negative --position-scale), or a "
        "controller holds an unstable plant, which no simulation from the first sample follows. Cut the record to a "
        "stretch that the force moves (--start, --end), or use --force none after a release.",
    )


def _gain_sentence(problem: Problem) -> tuple[str, ...]:
    record = problem.records[0]
    if (record.force_unit, record.position_unit) in _ABSOLUTE:
        return ()
    names = ", ".join(problem.model.names[i] for i in problem.free if problem.model.names[i] in FORCES)
    said = []
    if record.force_unit not in ("N", "N·m"):
        said.append(
            f"The force is in {record.force_unit} and its gain in newtons is unknown{SCALE_SAID}{names} are known only "
            "up to that gain: measure the force of one input with a spring balance, or weigh the moving mass."
        )
    if record.position_unit not in ("m", "rad"):
        said.append(
            f"The position is in {record.position_unit} and its scale in metres is unknown{SCALE_SAID}{names} are "
            "known only up to that scale: measure a known travel, and give --position-scale and --position-unit m."
        )
    if not said:
        said.append(
            f"The force is in {record.force_unit} and the position in {record.position_unit}{SCALE_SAID}{names} are "
            "known only up to the lever arm between them: give --force-scale or --position-scale."
        )
    return tuple(said)
