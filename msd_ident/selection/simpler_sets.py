"""Sets simpler than a fitted one: those that it is equal to, and those that are worth a fit from where it stands."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects import Effect, by_name
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import (
    COULOMB,
    HOLDING_COULOMB,
    Causes,
    Hypothesis,
    causes_that_fit,
    imitated,
    without,
)

#: A set, and the model and the initial states to start it from.
Start = tuple[Causes, Model, Sequence[Initial]]


def equal_to(fitted: Hypothesis) -> dict[Causes, Model]:
    """Simpler sets that the fitted model is equal to, each with its model: an effect without strength, or Coulomb
    friction alone.
    """
    return fitted.kept("equal to", lambda: _equal_to(fitted))


def _equal_to(fitted: Hypothesis) -> dict[Causes, Model]:
    model, found = fitted.model, {}
    for name in sorted(fitted.causes):
        if all(model[parameter] == value for parameter, value in by_name(name).neutral):
            found[fitted.causes - {name}] = model.without(name)
        if model.effect(name).is_dry_friction():
            found[fitted.causes - {name} | {COULOMB}] = model.without(name) + DryFriction(model[HOLDING_COULOMB[name]])
    return found


def reduced(fitted: Hypothesis, library: Collection[str]) -> Iterator[Start]:
    """Sets simpler than a fitted one, each with a model and initial states to start from.

    Those with one cause less, with the simple law for another form of it, with Coulomb friction for a law that has it
    as a limit, or with an effect that one of the causes may imitate. A set may come twice, with the other parameters
    moved and as they are: where a cause does nothing but hold the cart in another place, each move makes it slip.

    Args:
        fitted: the set.
        library: names of the causes that can act in the experiment.
    """
    for name in sorted(fitted.causes):
        model = replace(fitted.model, effects=tuple(e for e in fitted.model.effects if e.name != name))
        yield fitted.causes - {name}, *without(fitted, name)
        yield fitted.causes - {name}, model, fitted.initial
        if simple := _simple_law(fitted.model, name):
            yield fitted.causes - {name} | {simple.name}, model + simple, fitted.initial
        causes = fitted.causes - {name} | {COULOMB}
        if name in HOLDING_COULOMB and COULOMB not in fitted.causes and causes_that_fit(causes):
            yield causes, model + DryFriction(fitted.model[HOLDING_COULOMB[name]]), fitted.initial
    for causes, model in imitated(fitted.model).items():
        if causes - fitted.causes <= set(library):
            yield causes, model, _counted(fitted, model)


def nearest(experiment: Experiment, fitted: Hypothesis) -> list[Start]:
    """The sets simpler than a fitted one (``reduced``), each once, with the start that leaves least.

    Args:
        experiment: readings with their weights.
        fitted: the set.
    """

    def left(start: Start) -> float:
        _, weighting, point = formulated(experiment, *start[1:])
        residual = weighting.residual(point)
        return float(residual @ residual)

    found: dict[Causes, list[Start]] = {}
    for start in reduced(fitted, experiment.library):
        found.setdefault(start[0], []).append(start)
    return [starts[0] if len(starts) == 1 else min(starts, key=left) for starts in found.values()]


def _counted(fitted: Hypothesis, model: Model) -> tuple[Initial, ...]:
    """The states of a set, counted from where the effects of a model count that it has not."""
    new = (effect for effect in model.effects if effect.name not in fitted.causes)
    zero = math.fsum(effect.zero_in(fitted.model) for effect in new)
    return tuple(replace(one, position=one.position - zero, zero=one.zero + zero) for one in fitted.initial)


def _simple_law(model: Model, name: str) -> Effect | None:
    """The simple law of which an effect is another form, with the values that both have or that the effect gives; None
    if it has others.
    """
    if not (form_of := by_name(name).form_of):
        return None
    values = dict(zip(model.names, model.values.tolist(), strict=True)) | model.effect(name).simple_values()
    simple = by_name(form_of)
    return simple.from_values(values) if {p.name for p in simple.parameters} <= set(values) else None
