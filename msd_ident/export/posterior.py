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
from msd_ident.estimate.formulation import Zero
from msd_ident.export.known import kept, known
from msd_ident.export.plan import force_power
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.model.parameters import PARAMETERS
from msd_ident.workflow.identify import KNOWN_STEP
from msd_ident.workflow.known_parameters import Known
from msd_ident.workflow.saved_model import SavedModel

#: An explanation less likely than this is not drawn from.
_RARE = 0.005
#: Draws thrown away for each that is kept, at most, where bounds cut into a distribution.
_TRIES = 200
#: Parameter sets, at most: their file has about 100 MB, and they take half a gigabyte of memory while it is written.
MOST_DRAWS = 1_000_000


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


@dataclass(frozen=True)
class _Fitted:
    """One explanation, and how uncertain it is.

    Attributes:
        fit: with the known parameters at their values.
        uncertain: known parameters that are not exact.
        slopes: (free, uncertain) change of each fitted parameter with each of them.
    """

    fit: FitResult
    uncertain: tuple[Known, ...]
    slopes: FloatArray

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that differ from draw to draw: the fitted ones, then the known ones that are not exact."""
        return (*self.fit.free, *(one.name for one in self.uncertain))

    def deviations(self, count: int, rng: np.random.Generator) -> FloatArray:
        """(count, names) draws from normal distributions around the fit; to first order in what was known."""
        free, covariance = len(self.fit.free), np.asarray(self.fit.covariance)
        own = rng.multivariate_normal(np.zeros(free), covariance, size=count, method="eigh")
        given = rng.normal(size=(count, len(self.uncertain))) * [one.std for one in self.uncertain]
        return np.hstack([own + given @ self.slopes.T, given])


def draw(saved: SavedModel, records: Sequence[Record], count: int) -> Draws:
    """Draw parameter sets.

    Args:
        saved: the result.
        records: that it is from, as it is simulated on them: they tell how parameters go together.
        count: how many.

    Raises:
        UsageError: no records, fewer than one draw, or more than ``MOST_DRAWS``.
        DataError: as ``known``.
    """
    if count < 1:
        raise UsageError(f"{count} draws; expected at least 1, e.g. --draws 1000")
    if count > MOST_DRAWS:
        raise UsageError(
            f"{count} draws; expected at most {MOST_DRAWS}, whose file has about 100 MB: far fewer are enough"
        )
    if not records:
        raise UsageError(
            "draws need the record, since a result does not hold how parameters go together; expected its path: give "
            "--replay PATH"
        )
    sets = _explanations(saved)
    fits = [_fitted(saved, causes, records) for causes, _ in sets]
    names = tuple(dict.fromkeys(name for found in fits for name in found.fit.model.names))
    rng = np.random.default_rng(seeds.DRAWS)
    which = rng.choice(len(sets), size=count, p=[probability for _, probability in sets])
    values = np.array([_neutral(names)] * count)
    for i, found in enumerate(fits):
        rows = np.flatnonzero(which == i)
        if rows.size:
            columns = np.array([names.index(name) for name in found.fit.model.names])
            values[np.ix_(rows, columns)] = _drawn(found, rows.size, rng)
    return Draws(names, values, which.astype(np.int64), sets)


def _explanations(saved: SavedModel) -> tuple[tuple[tuple[str, ...], float], ...]:
    """The result's own effects and its rivals, with probabilities that add up to 1."""
    rivals = [(causes, p) for causes, p in saved.rivals if p > _RARE and set(causes) != set(saved.causes)]
    own = max(1.0 - sum(p for _, p in rivals), _RARE)
    whole = own + sum(p for _, p in rivals)
    return tuple((causes, p / whole) for causes, p in [(saved.model.effect_names, own), *rivals])


def _fitted(saved: SavedModel, causes: tuple[str, ...], records: Sequence[Record]) -> _Fitted:
    """The result's own model refitted from where it stands; another explanation from its effects' guesses.

    What was known beforehand is kept. As in ``identify``, one further fit with each known parameter a little higher
    tells how the others follow it.
    """
    own = set(causes) == set(saved.model.effect_names)
    model = saved.model if own else _begun(saved, causes, records[0])
    limits = {n: v for n, v in zip(model.names, model.values.tolist(), strict=True) if not math.isfinite(v)}
    fixed = limits | kept(saved, model)
    zero: Zero = "free" if model.stiffness > 0.0 else "known"
    found = fit(model, records, fixed=fixed, zero=zero, search="near" if own else "wide")
    free = [model.names.index(name) for name in found.free]
    uncertain = tuple(one for one in known(saved) if one.std > 0.0 and one.name in model.names)
    slopes = np.zeros((len(free), len(uncertain)))
    for i, one in enumerate(uncertain):
        step = min(one.std, KNOWN_STEP * abs(one.value) or one.std)
        moved = {**fixed, one.name: one.value + step}
        near = fit(found.model, records, fixed=moved, zero=zero, search="near", initial=found.initial)
        slopes[:, i] = (near.model.values - found.model.values)[free] / step
    return _Fitted(found, uncertain, slopes)


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


def _drawn(one: _Fitted, count: int, rng: np.random.Generator) -> FloatArray:
    """(count, p) parameter vectors of one explanation, within the bounds of its parameters."""
    model = one.fit.model
    places = [model.names.index(name) for name in one.names]
    lower = np.array([model.parameters[i].lower for i in places])
    upper = np.array([model.parameters[i].upper for i in places])
    centre = model.values[places]
    inside = np.empty((0, len(places)))
    for _ in range(_TRIES):
        fresh = centre + one.deviations(2 * count, rng)
        inside = np.concatenate([inside, fresh[np.all((fresh >= lower) & (fresh <= upper), axis=1)]])
        if len(inside) >= count:
            break
    else:
        inside = np.clip(centre + one.deviations(count, rng), lower, upper)
    values = np.tile(model.values, (count, 1))
    values[:, places] = inside[:count]
    return values
