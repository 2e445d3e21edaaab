"""Draws of the joint posterior: parameters with their correlations, tied explanations as often as they are likely."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident import seeds
from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult, fit
from msd_ident.export.plan import force_power
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.model.parameters import PARAMETERS
from msd_ident.workflow.saved_model import SavedModel

#: An explanation less likely than this is not drawn from.
_RARE = 0.005
#: Draws thrown away for each that is kept, at most, where bounds cut into a distribution.
_TRIES = 200


@dataclass(frozen=True)
class Draws:
    """Parameter sets for domain randomisation.

    Attributes:
        names: of the columns.
        values: (draws, columns). The parameters of an effect that an explanation does not have are at their neutral
            values.
        explanation: (draws,) index into ``explanations``.
        explanations: effects of each, with its probability.
    """

    names: tuple[str, ...]
    values: FloatArray
    explanation: np.ndarray[tuple[int], np.dtype[np.int64]]
    explanations: tuple[tuple[tuple[str, ...], float], ...]

    def scaled(self, factor: float) -> Draws:
        """The same in newtons.

        Args:
            factor: newtons per force unit of the record. It is that of the whole result, as the record's motion tells
                it: every row moves as the record does under the same force.
        """
        powers = [force_power(PARAMETERS[name].unit) for name in self.names]
        return replace(self, values=self.values * np.power(factor, powers))


def draw(saved: SavedModel, records: Sequence[Record], count: int) -> Draws:
    """Draw parameter sets.

    Args:
        saved: the result.
        records: that it is from, as it is simulated on them: they tell how parameters go together.
        count: how many.

    Raises:
        UsageError: no records, or fewer than one draw.
    """
    if count < 1:
        raise UsageError(f"{count} draws; expected at least 1, e.g. --draws 1000")
    if not records:
        raise UsageError(
            "draws need the record, since a result does not hold how parameters go together; expected its path: give "
            "--replay PATH"
        )
    sets = _explanations(saved)
    fits = [_fitted(saved, causes, records) for causes, _ in sets]
    names = tuple(dict.fromkeys(name for found in fits for name in found.model.names))
    rng = np.random.default_rng(seeds.DRAWS)
    which = rng.choice(len(sets), size=count, p=[probability for _, probability in sets])
    values = np.array([_neutral(names)] * count)
    for i, found in enumerate(fits):
        rows = np.flatnonzero(which == i)
        if rows.size:
            columns = np.array([names.index(name) for name in found.model.names])
            values[np.ix_(rows, columns)] = _drawn(found, rows.size, rng)
    return Draws(names, values, which.astype(np.int64), sets)


def _explanations(saved: SavedModel) -> tuple[tuple[tuple[str, ...], float], ...]:
    """The result's own effects and its rivals, with probabilities that add up to 1."""
    rivals = [(causes, p) for causes, p in saved.rivals if p > _RARE and set(causes) != set(saved.causes)]
    own = max(1.0 - sum(p for _, p in rivals), _RARE)
    whole = own + sum(p for _, p in rivals)
    return tuple((causes, p / whole) for causes, p in [(saved.model.effect_names, own), *rivals])


def _fitted(saved: SavedModel, causes: tuple[str, ...], records: Sequence[Record]) -> FitResult:
    """The result's own model refitted from where it stands; another explanation from its effects' guesses."""
    own = set(causes) == set(saved.model.effect_names)
    model = saved.model if own else _begun(saved, causes, records[0])
    given = [name for name, quantity in saved.parameters.items() if quantity.std == 0.0 and name in model.names]
    fixed = {*given, *(name for name, value in zip(model.names, model.values, strict=True) if not math.isfinite(value))}
    if model.stiffness == 0.0:
        fixed.add("stiffness")
    return fit(
        model, records, fixed=fixed, zero="free" if model.stiffness > 0.0 else "known", search="near" if own else "wide"
    )


def _begun(saved: SavedModel, causes: tuple[str, ...], record: Record) -> Model:
    plant = Plant(saved.model.mass, saved.model.damping, saved.model.stiffness)
    model = plant
    for name in causes:
        shared = saved.model.effect(name) if saved.model.has(name) else by_name(name).guess(record, plant)[0]
        model = model + shared
    return model


def _neutral(names: Sequence[str]) -> list[float]:
    """Value of each column where its effect does not act: neutral, or NaN where nothing says."""
    from msd_ident.model.effects import LIBRARY

    neutral = {name: value for effect in LIBRARY for name, value in effect.neutral}
    return [neutral.get(name, math.nan) for name in names]


def _drawn(found: FitResult, count: int, rng: np.random.Generator) -> FloatArray:
    """(count, p) parameter vectors of one explanation, within the bounds of its parameters."""
    names, model = list(found.model.names), found.model
    free = [names.index(name) for name in found.free]
    lower = np.array([model.parameters[i].lower for i in free])
    upper = np.array([model.parameters[i].upper for i in free])
    centre, covariance = model.values[free], np.asarray(found.covariance)
    kept = np.empty((0, len(free)))
    for _ in range(_TRIES):
        fresh = rng.multivariate_normal(centre, covariance, size=2 * count, method="eigh")
        kept = np.concatenate([kept, fresh[np.all((fresh >= lower) & (fresh <= upper), axis=1)]])
        if len(kept) >= count:
            break
    else:
        kept = np.clip(rng.multivariate_normal(centre, covariance, size=count, method="eigh"), lower, upper)
    values = np.tile(model.values, (count, 1))
    values[:, free] = kept[:count]
    return values
