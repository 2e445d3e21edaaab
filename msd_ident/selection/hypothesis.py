"""A set of causes, fitted in the extended model with all parameters free by simulation error."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import State
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.model import Model
from msd_ident.model.base_model import DRY_FRICTION
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.residuals import force_between, noise_spectrum, rest_response, standstill
from msd_ident.residuals.noise_model import Readings
from msd_ident.residuals.noise_spectrum import NoiseSpectrum

_Made = TypeVar("_Made")

Causes = frozenset[str]
NOTHING: Causes = frozenset()
COULOMB = DRY_FRICTION
#: Laws that hold Coulomb's as a limit, with the parameter that becomes its force.
HOLDING_COULOMB = {effect.name: effect.dry_limit for effect in LIBRARY if effect.dry_limit}


def kinds(causes: Iterable[str]) -> frozenset[str]:
    """Causes to which these laws belong: two forms of a law are one cause."""
    return frozenset(by_name(name).cause() for name in causes)


@dataclass(frozen=True)
class Hypothesis:
    """A fitted set of causes.

    Attributes:
        causes: names of the set.
        model: the fitted model.
        problem: the fitting problem.
        state: point, residual and Jacobian where the search ended.
        readings: what it was fitted to.
        rests: stretches in which the cart stands still, which the fit left out.
    """

    causes: Causes
    model: Model
    problem: Problem
    state: State
    readings: tuple[Readings, ...]
    rests: tuple[Readings, ...] = ()

    @property
    def chi(self) -> float:
        """Sum of squares in units of the noise."""
        return self.state.chi

    def kept(self, key: Hashable, make: Callable[[], _Made]) -> _Made:
        """What ``make`` gives, made once for each key: a search ranks the same sets again after every few fits.

        Args:
            key: what is made, and all that it depends on beside the set.
            make: makes it.
        """
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]  # type: ignore[no-any-return]

    @cached_property
    def _kept(self) -> dict[Hashable, Any]:
        return {}

    @cached_property
    def stirred(self) -> float:
        """Misfit to the cart at rest before the records, in units of the noise (``residuals.rest_response``)."""
        return sum(rest_response.chi(self.model, rest) for rest in self.rests)

    @cached_property
    def creeping(self) -> float:
        """Motion while the cart stands still within the records, in units of the noise (``residuals.standstill``)."""
        parts = zip(self._whitened, self.readings, strict=True)
        return sum(standstill.chi(residual, part, self.model) for residual, part in parts)

    @cached_property
    def between(self) -> float:
        """Chi² that the force between its samples leaves open (``residuals.force_between``)."""
        return force_between.chi(self.readings, self.model)

    @cached_property
    def octaves(self) -> FloatArray:
        """(BANDS,) sums of squares in units of the noise, octave by octave; ``chi`` is their sum."""
        parts = zip(self.readings, self._whitened, strict=True)
        return np.asarray(np.sum([part.octaves.of(residual) for part, residual in parts], axis=0))

    @cached_property
    def noise_spectrum(self) -> NoiseSpectrum | None:
        """The noise of a set that leaves nothing else; None where it leaves more, or the readings cannot show it."""
        return noise_spectrum.only_noise(self._whitened, self.readings)

    @property
    def _whitened(self) -> list[FloatArray]:
        """(n,) residual of each record in units of its noise."""
        ends = np.cumsum([part.record.samples for part in self.readings])[:-1]
        return np.split(self.state.residual, ends)

    @property
    def point(self) -> FloatArray:
        """Fitted vector (p,) of the problem."""
        return self.state.point

    @property
    def information(self) -> FloatArray:
        """Information matrix (p, p) in units of the noise."""
        return self.state.normal

    @property
    def initial(self) -> tuple[Initial, ...]:
        """State and zero of each record."""
        return self.problem.initials(self.point)

    @cached_property
    def _residuals(self) -> tuple[FloatArray, ...]:
        return tuple(self.problem.residual(self.point, r) for r in range(len(self.problem.records)))

    def residuals(self) -> tuple[FloatArray, ...]:
        """Model − data of each record [m]."""
        return self._residuals


def causes_that_fit(causes: Causes) -> bool:
    """Whether the causes may act together: no two of one family, and no two forms of one cause."""
    families = [by_name(name).family for name in causes if by_name(name).family]
    kinds = [by_name(name).cause() for name in causes]
    return len(families) == len(set(families)) and len(kinds) == len(set(kinds))


def imitated(model: Model, *, alike: bool = False) -> dict[Causes, Model]:
    """Models in which an effect is replaced by another one that it may imitate, by their causes.

    Args:
        model: as it was fitted.
        alike: only those to which the model is equal with its present values.
    """
    found = {}
    for effect in model.effects:
        for other in LIBRARY:
            if alike and (other.name in model.effect_names or not other.is_all_of(effect, model)):
                continue
            start = other.in_place_of(effect, model)
            if start is not None and causes_that_fit(frozenset(start.effect_names)):
                found[frozenset(start.effect_names)] = start
    return found


def without(fitted: Hypothesis, name: str) -> tuple[Model, tuple[Initial, ...]]:
    """A fitted model without one of its effects; the other parameters are moved so that the residual changes least.

    With the sensitivities J of the residual, the removed parameters r go to their neutral values by Δr, and the others
    o follow by Δo = −(Jo Joᵀ)⁻¹ Jo Jrᵀ Δr.

    Args:
        fitted: the set.
        name: one of its effects.

    Returns:
        The model, and the initial state and zero of each record.
    """
    problem, point = fitted.problem, fitted.point
    fade = np.zeros(point.size)
    gone = np.zeros(point.size, dtype=bool)
    neutral = dict(by_name(name).neutral)
    for parameter in by_name(name).parameters:
        if parameter.name in problem.names:
            entry = problem.names.index(parameter.name)
            gone[entry] = True
            value = neutral.get(parameter.name, math.inf)
            fade[entry] = value - point[entry] if math.isfinite(value) else 0.0
    rows = fitted.state.jacobian
    follow = np.linalg.lstsq(rows[~gone].T, -fade @ rows, rcond=1e-10)[0]
    moved = point.copy()
    moved[~gone] = np.clip(point[~gone] + follow, problem.lower[~gone], problem.upper[~gone])
    model = fitted.model.with_values(problem.values(moved))
    return replace(model, effects=tuple(e for e in model.effects if e.name != name)), problem.initials(moved)


def imitated_by(fitted: Hypothesis) -> tuple[Causes, ...]:
    """Sets with another effect in the place of one that it is equal to."""
    return fitted.kept("imitated", lambda: tuple(imitated(fitted.model, alike=True)))
