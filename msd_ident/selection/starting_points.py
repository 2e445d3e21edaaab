"""Starting points of a set of causes: from smaller fitted sets, or from a regression."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.broyden import State, Weighting, extended, step
from msd_ident.estimate.effort import KEPT, LOOK
from msd_ident.estimate.formulation import regressed
from msd_ident.estimate.levels import DAMPING, MOST_OF, NEGLIGIBLE, TENTH
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.estimate.weak_form import LINEAR
from msd_ident.model import Model
from msd_ident.model.base_model import DryFriction, friction_force
from msd_ident.model.effects import Effect, by_name
from msd_ident.model.effects.law import SECOND_MASS, STRUCTURAL
from msd_ident.selection.certainty import FAINT, ROUGH
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.growing import grown
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import SAME, StartingPoint
from msd_ident.selection.second_masses import SecondMass, second_masses
from msd_ident.selection.starting_values import FittedRecord, guesses


def starts(experiment: Experiment, causes: Causes, parent: Hypothesis) -> list[Model]:
    """Models to start a set from: the values of a smaller fitted set, with guesses for the effects that it lacks.

    Coulomb friction of the parent that is not among the causes is replaced by the law that holds it as a limit.

    Args:
        experiment: readings with their weights.
        causes: names of the set.
        parent: a fitted set.

    Returns:
        A model for each combination of guesses, and those that divide the parent's dry friction between two laws; none
        if a cause needs a spring and the parent has none.
    """
    kept = tuple(effect for effect in parent.model.effects if effect.name in causes)
    plant = Model(parent.model.mass, parent.model.damping, parent.model.stiffness)
    models = [replace(plant, effects=kept)]
    fitted = parent.kept("fitted record", lambda: fitted_record(experiment, parent, plant))
    seen = fitted.record
    rubs = friction_force(parent.model) if COULOMB in parent.causes - causes else 0.0
    if plant.stiffness <= 0.0 and any(by_name(name).needs_spring for name in causes):
        return []  # a parent that ended without a spring is no place to bend it
    for name in sorted(causes - parent.causes):
        simple = next((effect for effect in parent.model.effects if effect.name == by_name(name).form_of), None)
        if simple is not None and simple.name not in causes:
            found = by_name(name).from_simple_and_residual(simple, seen, plant, fitted.residual)
        elif rubs > 0.0 and name in HOLDING_COULOMB:
            found = by_name(name).from_dry_friction(rubs, seen, plant)
        else:
            found = parent.kept(("guesses", name), partial(guesses, name, fitted))
        added = [model + guess for model in models for guess in found]
        if by_name(name).structure == SECOND_MASS:
            hung = parent.kept("second masses", lambda: second_masses(plant, seen, fitted.residual, experiment.fixed))
            added = [_carried(model, experiment.fixed) for model in added]
            added += [_hung(model, one, start) for model in models for start in hung for one in _alike(found)]
        models = added
    return models + _divided(causes, parent, seen)


def fitted_record(experiment: Experiment, parent: Hypothesis, plant: Model) -> FittedRecord:
    """The record with the largest motion, and what a fitted set with this plant leaves there."""
    liveliest = _liveliest(experiment.records)
    part, residual = experiment.readings[liveliest], parent.residuals()[liveliest]
    largest = max(float(np.max(np.abs(record.force))) for record in experiment.records)
    zero = parent.initial[liveliest].zero
    return FittedRecord(plant, part.record, zero, residual, part.noise, largest, not parent.causes)


def _divided(causes: Causes, parent: Hypothesis, record: Record) -> list[Model]:
    """The parent with its dry friction in equal parts in Coulomb friction and in a law that holds it as a limit.

    One of the two is the only cause that the parent lacks. Its law has taken up the force of both: whole, this leaves
    no room for the other, which ends at no force.
    """
    lacks = causes - parent.causes
    found = []
    for name in sorted(causes & set(HOLDING_COULOMB)):
        if COULOMB not in causes or lacks not in ({COULOMB}, {name}):
            continue
        limit = HOLDING_COULOMB[name]
        half = 0.5 * (parent.model[limit] if lacks == {COULOMB} else friction_force(parent.model))
        others = causes - {COULOMB, name}
        rest = replace(parent.model, effects=tuple(e for e in parent.model.effects if e.name in others))
        laws = by_name(name).from_dry_friction(half, record, Model(rest.mass, rest.damping, rest.stiffness))
        found += [rest + DryFriction(half) + law for law in laws if half > 0.0]
    return found


def _hung(model: Model, guess: Effect, start: SecondMass) -> Model:
    """The model with a second mass, whose law is else as guessed, and what that leaves of the first."""
    mass, damping, stiffness = start.plant
    bare = replace(model, mass=mass, damping=damping, stiffness=stiffness)
    return bare + guess.within_bounds(*start.hung, *guess.values[STRUCTURAL[SECOND_MASS] :])


def _carried(model: Model, fixed: Collection[str]) -> Model:
    """The model with as much mass in all, for its size, as without the second one, which follows the first slowly."""
    second = model.structure(SECOND_MASS)[0]
    more = 1.0 + second / model.mass
    if "mass" not in fixed:
        return replace(model, mass=max(model.mass - second, TENTH * model.mass))
    return replace(model, damping=more * model.damping, stiffness=more * model.stiffness)


def _alike(found: Sequence[Effect]) -> list[Effect]:
    """Guesses of a second mass that differ in more than the mass and what it hangs on."""
    return list({guess.values[STRUCTURAL[SECOND_MASS] :]: guess for guess in found}.values())


def proposals(experiment: Experiment, causes: Causes, parents: Sequence[Hypothesis]) -> list[StartingPoint]:
    """Starts of a set, the most promising first: the best few next to other fitted sets, and those by regression.

    Args:
        experiment: readings with their weights.
        causes: names of the set.
        parents: fitted sets to start from, at least one; most have fewer causes.
    """
    found = []
    near = [starts(experiment, causes, parent) for parent in parents]
    for parent, models in zip(parents, near, strict=True):
        states: dict[tuple[int, bytes], State] = {}
        ahead = _beside(experiment, causes, parent, models, states)
        most = parent.chi / MOST_OF if parent.causes < causes else math.inf
        far = [i for i, start in enumerate(ahead) if start.fitted.chi > most]
        weakened = [_weakened(models[i], causes - parent.causes) for i in far]
        for i, weak in zip(far, _beside(experiment, causes, parent, weakened, states), strict=True):
            ahead[i] = weak if weak.promise < MOST_OF * ahead[i].promise else ahead[i]
        found += ahead
    found = _distinct(sorted(found, key=lambda start: start.promise))[:KEPT]
    beside = min(parent.chi for parent in parents)
    # A law of friction is begun from the known friction; the strength of a ripple is seen by a regression alone.
    known = any(COULOMB in parent.causes - causes for parent in parents)
    known = known and not any(by_name(name).ripple() for name in causes)
    for parent, models in zip(parents, near, strict=True):
        if not (parent.causes or known):
            zero = parent.initial[_liveliest(experiment.records)].zero
            found += regressions(experiment, causes, [_counted(model, -zero) for model in models], beside)
    return sorted(found, key=lambda start: start.promise)


def _liveliest(records: Sequence[Record]) -> int:
    """Index of the record with the largest motion."""
    return max(range(len(records)), key=lambda r: float(np.ptp(records[r].position)))


def _counted(model: Model, zero: float) -> Model:
    """The model with ripples over x − zero in place of x."""
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    terms = [law for effect in model.effects if (law := effect.ripple())]
    return model.with_values(
        {law.phase: values[law.phase] + 2.0 * math.pi * zero / values[law.scanned] for law in terms}
    )


def _distinct(found: Sequence[StartingPoint]) -> list[StartingPoint]:
    """Starts, sorted by what they promise, that do not lead to the same place."""
    pairs = zip(found, found[1:], strict=False)
    return list(found[:1]) + [one for before, one in pairs if one.promise > (1.0 + SAME) * before.promise]


def _beside(
    experiment: Experiment,
    causes: Causes,
    parent: Hypothesis,
    models: Sequence[Model],
    states: dict[tuple[int, bytes], State],
) -> list[StartingPoint]:
    """Starts next to a fitted parent, whose Jacobian they take over, one for each model of the set.

    ``states``: those that are known, to which new ones are added; within the bounds several models may be one point.
    """
    posed = [formulated(experiment, model, parent.initial) for model in models]
    keys = [(id(weighting), point.tobytes()) for _, weighting, point in posed]
    for weighting in {id(one): one for _, one, _ in posed}.values():
        pairs = zip(keys, posed, strict=True)
        new = {key: point for key, (_, one, point) in pairs if one is weighting and key not in states}
        made = extended(weighting, parent.problem, parent.state, list(new.values()))
        states |= zip(new, made, strict=True)
    found = []
    for key, model, (problem, _, _) in zip(keys, models, posed, strict=True):
        state = states[key]
        promised, most = (step(problem, state, damping)[1] for damping in (DAMPING, DAMPING**2))
        here = Hypothesis(causes, model, problem, state, experiment.readings, experiment.rests)
        found.append(StartingPoint(here.chi - promised, here, parent.chi, here.chi - most))
    return found


def _weakened(model: Model, names: Causes) -> Model:
    """The model with these effects close to doing nothing: too strong a guess may hide the direction of descent.

    Where the equation of motion is linear in a law without a kink, the best strength follows from none at all.
    """
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    weak = {}
    for effect in map(by_name, names):
        kinked = any(parameter.kinked for parameter in effect.parameters)
        part = 0.0 if effect.is_linear() and not kinked else 0.5 * TENTH  # below what counts as an effect
        for name, neutral in effect.neutral:
            if math.isfinite(neutral) and math.isfinite(values[name]):
                weak[name] = neutral + part * (values[name] - neutral)
    return model.with_values(weak)


def regressions(experiment: Experiment, causes: Causes, models: Sequence[Model], beside: float) -> list[StartingPoint]:
    """The two best starts by linear regression on the equation of motion.

    They are made only if the sets to start from are so far from the data that a start next to them leads nowhere.
    Nearer to the noise they are made only if all parameters enter linearly, or are those of a ripple. Parameters that
    do not enter linearly have the values of ``models``.

    Args:
        experiment: readings with their weights.
        causes: names of the set.
        models: models of the set, from ``starts`` with the base model; their ripples count from reading 0.
        beside: chi² of the best set to start from.
    """
    left = math.sqrt(beside / experiment.evidence)
    if left < FAINT:
        return []
    ripples = {name for cause in causes if (law := by_name(cause).ripple()) for name in law.names}
    tried: dict[tuple[float, ...], Model] = {}
    for model in models:
        inner = {n: v for n, v in zip(model.names, model.values.tolist(), strict=True) if n not in LINEAR}
        if len(model.names) > 3 + len(inner) and (left > ROUGH or set(inner) <= ripples):
            tried.setdefault(tuple(inner.values()), model)
    found = []
    for model in tried.values():
        for start in regressed(experiment.problem(model), counted=True):
            initial = [Initial(*state) for state in start.initial]
            relaxed = _counted(model.with_values(start.values), initial[_liveliest(experiment.records)].zero)
            _, weighting, point = formulated(experiment, relaxed, initial)
            found.append((weighting, point))
    if any(by_name(cause).angular for cause in causes):
        best = grown(found, 2)
    else:
        best = sorted(found, key=lambda one: float(np.sum(one[0].residual(one[1]) ** 2)))[:2]
    return [_exact_start(experiment, causes, _placed(experiment, *one), beside) for one in best]


def from_values(experiment: Experiment, model: Model, initial: Sequence[Initial], beside: float) -> StartingPoint:
    """A start from values that a regression gave, with the position and the states fitted to the samples.

    Args:
        experiment: readings with their weights.
        model, initial: values of the set, and state and zero of each record.
        beside: chi² of the base model.
    """
    _, weighting, point = formulated(experiment, model, initial)
    return _exact_start(experiment, frozenset(model.effect_names), _placed(experiment, weighting, point), beside)


def _placed(experiment: Experiment, weighting: Weighting, point: FloatArray) -> tuple[Problem, Weighting, FloatArray]:
    """The start with mass, stiffness, initial states and zeros fitted to the samples, and all other parameters kept.

    A regression gives good values of small forces, but a poor position of the cart. If all parameters moved at once,
    the error of the position would be put on the small forces, and the cart would stick at wrong places.
    """
    problem = weighting.problem
    model = problem.model.with_values(problem.values(point))
    others = frozenset(model.names) - {"mass", "stiffness"}
    bare, units, place = formulated(experiment, model, problem.initials(point), others)
    chi, best = math.inf, place
    for _ in range(LOOK):
        state = units.exact(place, units.steps(None))
        if not state.chi < chi:
            break
        move, promised = step(bare, state, DAMPING)
        chi, best = state.chi, place
        if promised < NEGLIGIBLE * chi:
            break
        place = np.clip(place + move, bare.lower, bare.upper)
    values = dict(zip(bare.model.names, bare.values(best).tolist(), strict=True))
    return problem, weighting, problem.vector(values, bare.initials(best))


def _exact_start(
    experiment: Experiment, causes: Causes, start: tuple[Problem, Weighting, FloatArray], beside: float
) -> StartingPoint:
    problem, weighting, point = start
    state = weighting.exact(point, weighting.steps(None))
    model = problem.model.with_values(problem.values(point))
    promised = step(problem, state, DAMPING)[1]
    here = Hypothesis(causes, model, problem, state, experiment.readings, experiment.rests)
    return StartingPoint(state.chi - promised, here, beside)
