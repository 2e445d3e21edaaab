"""Posing the problem: what is free, what each record adds, and the vectors that a search starts from."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.special import ndtri

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import UsageError
from msd_ident.estimate.levels import CONFIDENCE, MOST_OF, NATURAL_RANGE, TENTH
from msd_ident.estimate.objective import SquaredError
from msd_ident.estimate.posing import build
from msd_ident.estimate.problem import Initial, Nuisance, Problem, RestConstraint
from msd_ident.estimate.regression_init import Regression, Start, candidates, starting_state
from msd_ident.estimate.weak_form import LINEAR
from msd_ident.model import Model
from msd_ident.model.declarations import PLACE
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import PLAY

Zero = Literal["free", "known"]


def formulate(
    model: Model, records: tuple[Record, ...], fixed: Mapping[str, float] | Collection[str] = (), zero: Zero = "free"
) -> Problem:
    """The problem that ``fit`` solves: which parameters are free, and the initial states and zeros of the records.

    An initial velocity is free unless the record starts at rest. A zero is free if ``zero`` is ``free`` and a force of
    the model depends on the position. Infinite limits are not fitted, nor are parameters that an effect only states
    (``Effect.held``).

    Args:
        model: structure and starting values.
        records: one experiment or several, which share the parameters.
        fixed: parameters to keep: a mapping gives their values, a collection of names keeps the model's.
        zero: ``free`` if the encoder's zero need not be the relaxed spring, ``known`` if it is.

    Raises:
        UsageError: no record, an unknown name in ``fixed``, an unknown ``zero``, or nothing left to fit.
    """
    if not records:
        raise UsageError("no records to fit; expected at least one")
    if isinstance(fixed, Mapping):
        model = model.with_values(fixed)
    unbounded = [name for name, value in zip(model.names, model.values, strict=True) if math.isinf(value)]
    held = frozenset(name for effect in model.effects for name in effect.held)
    kept = frozenset(fixed) | held | frozenset(unbounded)  # an infinite limit is no limit: nothing to fit
    if zero not in ("free", "known"):
        raise UsageError(f"zero is {zero!r}; expected 'free' or 'known'")
    # Without a force that depends on where the cart is, a zero is just another start position.
    springless = "stiffness" in kept and model["stiffness"] == 0.0 and not any(e.placed() for e in model.effects)
    nuisances = []
    at_rest = [starts_at_rest(record) for record in records]
    for i, rests in enumerate(at_rest):
        nuisances.append(Nuisance(i, "initial position"))
        if not rests:
            nuisances.append(Nuisance(i, "initial velocity"))
        if zero == "free" and not springless:
            nuisances.append(Nuisance(i, "zero"))
    if kept >= set(model.names):
        raise UsageError("every parameter is fixed; expected at least one to fit")
    resting = [r for r, record in enumerate(records) if starts_unpushed(record, at_rest[r])]
    problem = build(model, records, kept, tuple(nuisances))
    if zero == "known" or springless or not resting:
        return problem
    floors = [floor for floor in (quality.noise_floor(records[r]) for r in resting) if floor > 0.0]
    return balanced(problem, model, max([*floors, 1e-4 * problem.typical.length]), resting)


def balanced(problem: Problem, model: Model, noise: float, resting: Iterable[int]) -> Problem:
    """The problem with a ``RestConstraint`` for each record that starts at rest before its first push.

    Args:
        problem: gets the constraints in place of those that it has.
        model: values from which the width of each constraint follows: breakaway friction over stiffness, plus play.
        noise: standard deviation [m] of the position samples.
        resting: indices of the records that start at rest.
    """
    held = sum(effect.holding for effect in model.effects)
    holding = held / max(model["stiffness"], 1e-300) / math.sqrt(3.0)
    length = problem.typical.length
    spread = min(holding + sum(model.structure(PLAY)), NATURAL_RANGE * length) + max(noise, 1e-4 * length)
    return replace(problem, balances=tuple(RestConstraint(r, spread, noise) for r in resting))


def starts_unpushed(record: Record, at_rest: bool) -> bool:
    """Whether a record starts at rest without a force, before its first push or just as it comes.

    Args:
        record: a record without any force does not count.
        at_rest: result of ``starts_at_rest``. If False, a tenth of the largest force must act by the second sample
            (the first values of a ramp are no push), it must not go on from before the record, and the velocity at the
            first sample must be zero within its uncertainty. If no parabola passes through the first samples, they do
            not show that velocity.
    """
    pushes = np.flatnonzero(record.force)
    if not pushes.size or record.force_time[pushes[0]] < record.time[0]:
        return False
    if at_rest:
        return True
    first = np.abs(record.force[record.force_time <= record.time[1]])
    early = bool(np.max(first, initial=0.0) > TENTH * np.max(np.abs(record.force)))
    count = max(4, min(record.samples // 500, 40))
    within = int(np.searchsorted(record.force_time, record.time[count - 1], side="right"))
    if _goes_on(record.force[pushes[0] : within]):
        return False
    if _beside_parabola(record.position[:count]) > TENTH * float(np.std(record.position)):
        return False
    _, velocity = starting_state(record, count)
    span = float(record.time[count - 1] - record.time[0])
    # Fourth differences: with few samples in a swing, the motion has second ones.
    noise = float(np.std(np.diff(record.position[: 5 * count], 4))) / math.sqrt(70.0)
    uncertain = 14.0 * noise / math.sqrt(count)  # of a parabola's slope at its end, times its span
    return early and abs(velocity) * span < 0.002 * float(np.ptp(record.position)) + 3.0 * uncertain


def _goes_on(force: FloatArray) -> bool:
    """Whether a force (c,) that changes again and again begins far from zero: it acted before the first value."""
    changes = np.abs(np.diff(force))
    if changes.size < 2 or np.count_nonzero(changes) < MOST_OF * changes.size:
        return False
    return abs(float(force[0])) > float(np.sum(changes))


def _beside_parabola(head: FloatArray) -> float:
    """What a parabola through the first samples (c,), evenly spaced, leaves of them, rms."""
    place = np.linspace(0.0, 1.0, head.size)
    left = head - np.polyval(np.polyfit(place, head, 2), place)
    return float(np.sqrt(np.mean(left**2)))


def starts_at_rest(record: Record) -> bool:
    """Whether the first samples show no motion beyond the encoder's step, so that the initial velocity is zero.

    A hundredth of the record (10 to 200 samples) must stay within one encoder step, or be noise without a slope. Second
    differences give the noise, because a swing hardly contributes to them; at its turning point a swing has no slope
    either.
    """
    count = max(10, min(record.samples // 100, 200))
    head = record.position[:count]
    spread = float(np.ptp(head))
    if spread <= 1e-4 * float(np.ptp(record.position)) or np.unique(head).size <= 2:
        return True
    time = record.time[:count] - record.time[:count].mean()
    slope = float(time @ head) / float(time @ time)
    scatter = float(np.std(np.diff(head, 2))) / math.sqrt(6.0)
    widest = 2.0 * float(ndtri(1.0 - 0.5 * (1.0 - CONFIDENCE) / count))  # range of so many readings of a noise of 1
    if spread > widest * scatter + 2.0 * quality.encoder_step(record):
        return False
    bend = float(np.mean(head[: count // 2]) - np.mean(head[count // 2 :]))
    return abs(slope) < 2.0 * scatter / math.sqrt(float(time @ time)) and abs(bend) < 4.0 * scatter / math.sqrt(count)


def regressed(problem: Problem, *, counted: bool = False) -> list[Start]:
    """Starts by linear regression, one for each smoothing width.

    Args:
        problem: model and records.
        counted: whether the phases of ripples count from reading 0, as the regression does; else it leaves ripples out.
    """
    given = dict(zip(problem.model.names, problem.model.values.tolist(), strict=True))
    for effect in problem.model.effects:
        term = effect.harmonic
        if term is not None and term.over == PLACE and not (counted and effect.ripple()):
            del given[term.amplitude]
    free = {problem.model.names[i] for i in problem.free}
    zero_free = any(n.kind == "zero" for n in problem.nuisances)
    resting = {balance.record for balance in problem.balances}
    relaxed = tuple(r in resting for r in range(len(problem.records)))
    return candidates(problem.records, Regression(given, free, zero_free, relaxed))


def wide_vectors(problem: Problem, models: Sequence[Model], starts: Sequence[Start]) -> list[FloatArray]:
    """Starting vectors: the values of each model, with the linear parameters of each regression put in.

    Args:
        problem: says which entries the vector has.
        models: models of the problem's structure.
        starts: results of ``regressed``.

    Returns:
        len(models) · len(starts) vectors (p,).
    """
    vectors = []
    for model in models:
        own = _values_of(model)
        vectors += [_vector(problem, Start({**own, **_linear(problem, start)}, start.initial)) for start in starts]
    return vectors


def own_vectors(problem: Problem, model: Model, starts: Sequence[Start]) -> list[FloatArray]:
    """Starting vectors with the values of a model as they are.

    Args:
        problem: says which entries the vector has.
        model: a model of the problem's structure.
        starts: results of ``regressed``, of which the initial states and zeros are taken.

    Returns:
        One vector (p,) for each regression, and a last one that starts at the first readings with no velocity.
    """
    states = [*(start.initial for start in starts), _first_readings(problem)]
    return [_vector(problem, Start(_values_of(model), initial)) for initial in states]


def _values_of(model: Model) -> dict[str, float]:
    return dict(zip(model.names, model.values.tolist(), strict=True))


def _own(effect: Effect) -> dict[str, float]:
    return dict(zip((p.name for p in effect.parameters), effect.values, strict=True))


def guess_vectors(problem: Problem, best: FloatArray) -> list[FloatArray]:
    """Starting vectors from the guesses of the model's effects (``Effect.guess``).

    Args:
        problem: model and records.
        best: (p,) best vector so far, around which the guesses are made.

    Returns:
        ``best`` with the free parameters of one effect replaced, for each guess of each effect from each record.
    """
    model = problem.model.with_values(problem.values(best))
    vectors = []
    for effect in model.effects:
        for record in problem.records:
            for guess in effect.guess(record, model.without(effect.name)):
                guessed = _own(guess)
                vector = best.copy()
                for place, index in enumerate(problem.free):
                    value = guessed.get(model.names[index], math.nan)
                    if math.isfinite(value):  # an infinite limit is none, and nothing to start from
                        vector[place] = value
                vectors.append(vector)
    return vectors


def _linear(problem: Problem, start: Start) -> dict[str, float]:
    free = {problem.model.names[i] for i in problem.free}
    return {name: start.values[name] for name in LINEAR if name in free and name in start.values}


def neighbour_vectors(problem: Problem, best: FloatArray, starts: Sequence[Start]) -> list[FloatArray]:
    """Starting vectors in valleys of the error next to that of ``best`` (``Effect.neighbours``).

    The initial states are taken from the regression, because those of a fit in a wrong valley are wrong too.

    Args:
        problem: model and records.
        best: (p,) vector in the valley to leave.
        starts: results of ``regressed``; if empty, records start at their first readings with no velocity.

    Returns:
        Different vectors (p,); none if no free effect knows such valleys.
    """
    model = problem.model.with_values(problem.values(best))
    values, states = _values_of(model), _states(problem, starts)
    free = [effect for effect in model.effects if not {p.name for p in effect.parameters}.isdisjoint(problem.names)]
    others = [_own(other) for effect in free for other in effect.neighbours(problem.records)]
    vectors = [_vector(problem, Start({**values, **other}, states)) for other in others]
    # What is fixed keeps its value, so that some may be one and the same.
    return [one for i, one in enumerate(vectors) if not any(np.array_equal(one, other) for other in vectors[:i])]


def starting_states(problem: Problem) -> tuple[tuple[float, float, float], ...]:
    """Position, velocity and zero of each record at its first sample, from the regression or the first reading."""
    return _states(problem, regressed(problem))


def _states(problem: Problem, starts: Sequence[Start]) -> tuple[tuple[float, float, float], ...]:
    return starts[0].initial if starts else _first_readings(problem)


def _first_readings(problem: Problem) -> tuple[tuple[float, float, float], ...]:
    return tuple((float(record.position[0]), 0.0, 0.0) for record in problem.records)


def _vector(problem: Problem, start: Start) -> FloatArray:
    return problem.vector(start.values, [Initial(*state) for state in start.initial])


def regression_start(records: Record | Sequence[Record], model: Model, *, fixed: Collection[str] = ()) -> Model:
    """The model with starting values from a linear regression (``regression_init``), which simulates nothing to fit.

    Several smoothing widths are tried, and the one whose simulation fits best is kept. Parameters that do not enter
    linearly, or stand in ``fixed``, keep the model's values. All parameters keep them if the regression gives no
    plausible result, such as a negative mass.

    Args:
        records: one record or several, which share the parameters.
        model: structure, and values of what the regression does not estimate.
        fixed: names of parameters that keep their values.

    Raises:
        UsageError: no record, an unknown name in ``fixed``, or nothing left to fit.
    """
    group = (records,) if isinstance(records, Record) else tuple(records)
    problem = formulate(model, group, fixed)
    objective = SquaredError(problem)
    starts = regressed(problem)
    vectors = wide_vectors(problem, [model], starts) or own_vectors(problem, model, starts)
    best = min(vectors, key=objective.cost)
    return model.with_values(problem.values(best))
