"""Other laws of the force gain that a record cannot distinguish from the leading one.

A record with two sizes of force shows only the ratio of their gains. A slope, a limit, a dead zone and a gain that
depends on the sign then fit equally well, each with its own mass, damping and stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import in_force_unit
from msd_ident.model import Effect, Model
from msd_ident.model.effects import by_name
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment, switched_off
from msd_ident.selection.hypothesis import Causes, Hypothesis, causes_that_fit, without
from msd_ident.selection.hypothesis_fit import COMPARABLE, REACH, StartingPoint, begin, finish, refine
from msd_ident.selection.ranking import CALLED, DECISIVE
from msd_ident.selection.starting_points import proposals
from msd_ident.tuning import fixed

_COMMANDS = fixed(200, "accuracy", "commands at which two laws of the gain are compared, of a record with more")


def alike(experiment: Experiment, best: Hypothesis, scale: NoiseScale) -> list[Hypothesis]:
    """The leading set with each other law of the force's gain that is not decisively less likely.

    Args:
        experiment: all data.
        best: the leading set, fitted to it.
        scale: how likelihoods are read there.
    """
    found = []
    for name in sorted(best.causes):
        if "input_map" not in by_name(name).laws():
            continue
        bare = refine(experiment, best.causes - {name}, *without(best, name))
        for form in (name, *experiment.forms(name)):
            causes = best.causes - {name} | {form}
            if causes_that_fit(causes) and by_name(form).cause() == by_name(name).cause():
                found += _fitted(experiment, causes, bare, best)
    return [one for one in found if scale.of(one) > scale.of(best) - DECISIVE]


def leading(best: Hypothesis, laws: Sequence[Hypothesis], scale: NoiseScale) -> Hypothesis:
    """The law of the gain that leads where several fit alike.

    The commands are calibrated forces, so a law comes first that keeps their gain over a range (a dead zone, a limit):
    a law that changes the gain at every command moves mass, damping and stiffness away from this calibration.

    Args:
        best: the leading set.
        laws: result of ``alike``.
        scale: how likelihoods are read there.
    """
    near = [one for one in laws if scale.of(one) > scale.of(best) - CALLED]
    keeping = [one for one in (best, *near) if all(effect.keeps_gain() for effect in one.model.effects)]
    return best if best in keeping else max(keeping, key=scale.of, default=best)


def shares(
    laws: Sequence[Hypothesis], best: Hypothesis, scale: NoiseScale, whole: float
) -> list[tuple[float, Hypothesis]]:
    """The probability of the leading set, shared with each other law of the gain by their likelihoods.

    Args:
        laws: result of ``alike``.
        best: the leading set.
        scale: how likelihoods are read there.
        whole: probability of the leading set, whatever law of the gain it has.
    """
    odds = [math.exp(min(scale.of(one) - scale.of(best), DECISIVE)) for one in laws]
    return [(whole * one / (1.0 + math.fsum(odds)), law) for one, law in zip(odds, laws, strict=True)]


def _fitted(experiment: Experiment, causes: Causes, bare: Hypothesis, best: Hypothesis) -> list[Hypothesis]:
    """A set in each of its shapes (a slope, a limit), but for the one that ``best`` is."""
    (own,), (form,) = best.causes - bare.causes, causes - bare.causes
    shapes: dict[Causes, list[StartingPoint]] = {}
    for start in proposals(experiment, causes, [bare]):
        shapes.setdefault(switched_off(start.fitted.model), []).append(start)
    if causes == best.causes:
        shapes.pop(switched_off(best.model), None)
    reach = experiment.worse(best.chi, REACH)
    found = []
    for starts in shapes.values():
        one = finish(experiment, begin(experiment, starts, reach), best.chi)
        # From one law of the gain to another all forces change together, which a search that is given up early only
        # begins; with dry friction, or stops, a search from elsewhere may not get there at all.
        models = [(one.model, one.initial)] if one.chi < COMPARABLE * best.chi else []
        if "input_map" in by_name(form).laws():
            law = starts[0].fitted.model.effect(form)
            models.append((_rescaled(best.model, best.model.effect(own), law, experiment), best.initial))
        tries = [refine(experiment, causes, model, initial) for model, initial in models]
        found.append(min((one, *tries), key=lambda fitted: fitted.chi))
    return found


def _rescaled(model: Model, own: Effect, law: Effect, experiment: Experiment) -> Model:
    """A model with another law of the gain, nearest to the same motion: with the same forces but for a factor, by which
    all else that has a unit of force is multiplied.

    The factor 1/a and the law's values p minimise Σ (a·g(u; p) − f(u))² over the commands u of the records, where the
    model makes f(u) of them and the other law g(u; p). A law that lets no command pass is no minimum of it.
    """
    commands = np.unique(np.concatenate([record.force for record in experiment.records]))
    if commands.size > _COMMANDS:
        commands = np.quantile(commands, np.linspace(0.0, 1.0, _COMMANDS))
    made = np.array([own.pushes(u) for u in commands.tolist()])
    free = [parameter for parameter in law.parameters if parameter.name not in law.idle()]
    start = np.array([1.0, *(getattr(law, parameter.name) for parameter in free)])
    bounds = [1.0 / NATURAL_RANGE, *(p.lower for p in free)], [NATURAL_RANGE, *(p.upper for p in free)]

    def other(values: FloatArray) -> Effect:
        known = dict(zip([p.name for p in law.parameters], law.values, strict=True))
        return type(law).from_values(known | dict(zip([p.name for p in free], values.tolist(), strict=True)))

    def error(vector: FloatArray) -> FloatArray:
        changed = other(vector[1:])
        return np.asarray(vector[0] * np.array([changed.pushes(u) for u in commands.tolist()]) - made)

    found = least_squares(error, start, bounds=bounds, x_scale=np.where(start != 0.0, np.abs(start), 1.0)).x
    plain = replace(model, effects=tuple(effect for effect in model.effects if effect is not own))
    scaled = plain.with_values(in_force_unit(plain, 1.0 / float(found[0])))
    return replace(scaled, effects=(*scaled.effects, other(found[1:])))
