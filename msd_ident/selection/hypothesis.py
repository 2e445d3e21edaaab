"""Sets of causes, each fitted in the extended model with all parameters free, by simulation error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import resolution
from msd_ident.estimate.broyden import State, Weighting, descend
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS, LOOK, THOROUGH
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.parameter_units import Magnitudes, magnitudes
from msd_ident.estimate.problem import Initial, Nuisance, Problem, build
from msd_ident.model import Model
from msd_ident.model.base_model import DRY_FRICTION
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.residuals import rest_response
from msd_ident.residuals.noise_model import Readings
from msd_ident.tuning import fixed, tuned

Causes = frozenset[str]

COULOMB = DRY_FRICTION
#: Laws that hold Coulomb's as a limit, with the parameter that becomes its force.
HOLDING_COULOMB = {effect.name: effect.dry_limit for effect in LIBRARY if effect.dry_limit}
_FIRST = tuned(4, unit="steps", why="first look at a start of a set", chosen="by hand")
_KICK = tuned(0.6, unit="rad", why="change of a phase that may lead to another minimum", chosen="by hand")
_FLOOR = tuned(1.5, unit="noise floors", why="what a set leaves from which on such turns are tried", chosen="by hand")
_ASIDE = tuned(
    6.0,
    unit="standard deviations",
    why="distance between the first reading and the fitted start that is not the noise's",
    chosen="by hand",
)
FAR = tuned(
    25.0,
    unit="chi² for each piece of evidence",
    why="far from the noise: what is left is the model's, not the data's",
    chosen="by hand",
)
COMPARABLE = tuned(
    4.0,
    unit="1",
    why="times the variance, or the chi², of another set: with more, a set is not refined, begun again or started from",
    chosen="by hand",
)
_HOPELESS_FAR = tuned(
    1.5, unit="factor", why="chi² of another set far from the noise: with more, a set is not refined", chosen="by hand"
)
REACH = tuned(
    10.0,
    unit="1",
    why="times the variance of the best set which a start may promise, or the chi² which a set may leave, to be "
    "looked at",
    chosen="by hand",
)
SOUGHT = tuned(
    40.0, unit="1", why="features of a model's error that are counted while a search goes on", chosen="by hand"
)
SAME = fixed(1e-3, "accuracy", "relative difference of the chi² of two starts or ends that are one")
NOISE_ERROR = tuned(
    0.1, unit="1", why="relative error that the estimate of the noise's variance may have", chosen="by hand"
)
_SLACK = tuned(
    1e-3, unit="1", why="part of what is left above the noise whose fall is not worth a simulation", chosen="by hand"
)
_SLACK_FAR = tuned(
    5e-3,
    unit="1",
    why="far from the noise, part of what is left whose fall is not worth a simulation",
    chosen="by hand",
)
LEAST_FALL = tuned(
    0.02, unit="chi²", why="fall that is not worth a simulation: far below one piece of evidence", chosen="by hand"
)


@dataclass(frozen=True)
class Experiment:
    """The data and the base model, which all candidate sets share.

    Attributes:
        readings: the records with their weights.
        base: the base model.
        fixed: base parameters that the data cannot give (stiffness without a spring, mass in a free decay).
        rests: stretches of the records in which the cart stands still, which the fits leave out.
        asked: the only causes in question; None for all of the library.
    """

    readings: tuple[Readings, ...]
    base: Model
    fixed: frozenset[str]
    rests: tuple[Readings, ...] = ()
    asked: frozenset[str] | None = None

    @property
    def evidence(self) -> float:
        """Sum of the weights of all samples, in pieces of evidence."""
        return sum(part.evidence for part in self.readings)

    def worse(self, chi: float, times: float) -> float:
        """The chi² of a set whose error has ``times`` the variance of another set's, along ``SOUGHT`` features.

        Args:
            chi: chi² of the other set. What it leaves above the noise by less than the uncertainty of the noise counts
                as noise.
            times: factor on the variance.
        """
        above = max(chi - (1.0 + NOISE_ERROR) * self.evidence, 0.0)
        return chi + (times - 1.0) * (SOUGHT + above)

    def thinned(self, keep: int) -> Experiment:
        """The same experiment with about ``keep`` samples in all.

        Every n-th sample is kept, but at least ``A_SWING`` samples in each swing. If these are still too many, only a
        stretch of a record that goes on in the same way is kept.
        """
        total = sum(part.record.samples for part in self.readings)
        swing = 2.0 * math.pi * self.typical.time
        parts = []
        for part in self.readings:
            fewest = int(A_SWING * part.record.duration / swing)
            own = max(keep * part.record.samples // total, FEWEST_READINGS)
            few = part.thinned(max(own, fewest))
            parts.append(few.stretch(own) if few.record.samples > 2 * own else few)
        return replace(self, readings=tuple(parts))

    def with_mean_force(self) -> Experiment:
        """The same experiment with one force, the mean, between any two samples; its simulation takes fewer steps."""
        return replace(self, readings=tuple(part.with_mean_force() for part in self.readings))

    @property
    def records(self) -> tuple[Record, ...]:
        """The records."""
        return tuple(part.record for part in self.readings)

    @cached_property
    def library(self) -> tuple[str, ...]:
        """Names of the causes that can act here.

        Causes on the spring are left out if there is none, and causes on the input if no force acts.
        """
        sprung = "stiffness" not in self.fixed
        forced = any(bool(np.any(record.force_at(record.time))) for record in self.records)
        return tuple(
            effect.name
            for effect in LIBRARY
            if (sprung or not effect.needs_spring)
            and (forced or effect.acts_on != "input")
            and any(effect.fits(record) for record in self.records)
            if self.asked is None or effect.name in self.asked
        )

    @property
    def tried_alone(self) -> tuple[str, ...]:
        """Causes that are tried in every search: all except those that are only another form of a simple law."""
        return tuple(name for name in self.library if by_name(name).stands_alone or not by_name(name).form_of)

    def forms(self, name: str) -> tuple[str, ...]:
        """Other laws of the same cause."""
        cause = by_name(name).cause()
        return tuple(other for other in self.library if by_name(other).cause() == cause and other != name)

    @cached_property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Free entries of each record: the same for all candidates."""
        return formulate(self.base, self.records, self.fixed).nuisances

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Ranges of the laws' inner parameters that the samples can resolve."""
        return resolution.ranges(self.records, self.base)

    @cached_property
    def typical(self) -> Magnitudes:
        """Typical force, length and time of the records."""
        return magnitudes(self.records, self.base.mass)

    def problem(self, model: Model, held: frozenset[str] = frozenset()) -> Problem:
        """The fitting problem of a model on these records.

        Args:
            model: structure, and the values of what is not fitted.
            held: further parameters that keep the model's values.
        """
        fixed = self.fixed | held | switched_off(model)
        return resolution.within(build(model, self.records, fixed, self.nuisances, self.typical), self.ranges)


def formulated(
    experiment: Experiment, model: Model, initial: Sequence[Initial], held: frozenset[str] = frozenset()
) -> tuple[Problem, Weighting, FloatArray]:
    """A model's problem in units of the noise, and the vector of its values and initial states inside the bounds.

    Parameters ``held`` stay as the model has them.

    Args:
        experiment: readings with their weights.
        model: values to start from.
        initial: initial state of each record.
        held: parameters that are not fitted.
    """
    problem = experiment.problem(model, held)
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    point = np.clip(problem.vector(values, initial), problem.lower, problem.upper)
    return problem, weigh(problem, experiment.readings), point


def weigh(problem: Problem, readings: Sequence[Readings], masks: Sequence[FloatArray] | None = None) -> Weighting:
    """A problem in units of the noise, with each run of equal readings counted once.

    Args:
        problem: model and records.
        readings: the same records with their weights.
        masks: for each record (n,): 0 for samples to leave out, else 1; None for all samples.
    """
    if masks is None:
        return Weighting(problem, tuple(part.root for part in readings))
    factors = [part.factor * mask for part, mask in zip(readings, masks, strict=True)]
    return Weighting(problem, tuple(np.sqrt(factor) for factor in factors))


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

    @cached_property
    def stirred(self) -> float:
        """Misfit to the cart at rest before the records, in units of the noise (``residuals.rest_response``)."""
        return sum(rest_response.chi(self.model, rest) for rest in self.rests)

    @cached_property
    def octaves(self) -> FloatArray:
        """(BANDS,) sums of squares in units of the noise, octave by octave; ``chi`` is their sum."""
        ends = np.cumsum([part.record.samples for part in self.readings])[:-1]
        parts = zip(self.readings, np.split(self.state.residual, ends), strict=True)
        return np.asarray(np.sum([part.octaves.of(residual) for part, residual in parts], axis=0))

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

    @property
    def free_parameters(self) -> int:
        """Number of fitted parameters, without those of single records."""
        return len(self.problem.free)

    @cached_property
    def _residuals(self) -> tuple[FloatArray, ...]:
        return tuple(self.problem.residual(self.point, r) for r in range(len(self.problem.records)))

    def residuals(self) -> tuple[FloatArray, ...]:
        """Model − data of each record [m]."""
        return self._residuals


def switched_off(model: Model) -> frozenset[str]:
    """Parameters that are not fitted.

    Those that an effect only states, and infinite limits, which mean that a part of the effect is absent.
    """
    return frozenset(name for effect in model.effects for name in effect.idle())


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


@dataclass(frozen=True)
class StartingPoint:
    """A start of a set.

    A start is judged by the chi² that its first Gauss–Newton step predicts, not by its own: a guess of the right shape
    but the wrong size is a good one.

    Attributes:
        promise: the predicted chi².
        fitted: the set at the start.
        beside: chi² of the smaller set from which the start was made.
    """

    promise: float
    fitted: Hypothesis
    beside: float

    @property
    def turn(self) -> float:
        """Key by which starts are ordered, the smallest first: those that promise the largest reduction of chi²."""
        promise = max(self.promise, 0.0)  # a step that takes all away may promise less than nothing by rounding
        return promise * math.sqrt(promise / max(self.beside, 1e-300))

    def worth(self, reach: float) -> bool:
        """Whether to follow the start.

        It promises a chi² below ``reach``, or less than half that of the smaller set. In the second case the first step
        tells little about where the start leads.
        """
        return self.promise < max(reach, MOST_OF * self.beside)


def begin(experiment: Experiment, found: Sequence[StartingPoint], reach: float) -> list[Hypothesis]:
    """A few steps down from the most promising starts of a set.

    Args:
        experiment: readings with their weights.
        found: starts by rising ``promise``; the first one is always followed.
        reach: predicted chi² below which a further start is followed (``StartingPoint.worth``).

    Returns:
        The sets as they are after these steps, by rising chi².
    """
    kept = [start.fitted for i, start in enumerate(found) if i == 0 or start.worth(reach)]
    ahead = [_lower(experiment, fitted, _FIRST) for fitted in kept]
    return sorted(ahead, key=lambda fitted: fitted.chi)


def finish(experiment: Experiment, begun: Sequence[Hypothesis], least: float) -> Hypothesis:
    """The best of a set's beginnings, refined.

    Args:
        experiment: readings with their weights.
        begun: result of ``begin``.
        least: chi² of the best set so far; a set that stays far above it is not refined to full precision.
    """
    refined = [_settled(experiment, fitted, least) for fitted in _distinct(begun)]
    best = min(refined, key=lambda fitted: fitted.chi)
    if not _FLOOR * experiment.evidence < best.chi < _hopeless(experiment, least):
        return best
    kicked = [_settled(experiment, fitted, best.chi) for fitted in _kicked(experiment, best)]
    return min([best, *kicked], key=lambda fitted: fitted.chi)


def _kicked(experiment: Experiment, fitted: Hypothesis) -> list[Hypothesis]:
    """A few steps down from other starts, which may lead to another minimum.

    One start on either side of a harmonic law's phase: where the cart sticks at the ripples, the error has several
    minima within a cycle. And one from the first readings, if the fit begins far from them: a smaller model makes up
    for missing laws with a shifted start, and with friction a larger model that starts from there keeps the shift.
    """
    weighting = weigh(fitted.problem, experiment.readings)
    found = []
    point = _begun(experiment, fitted)
    if not np.array_equal(point, fitted.point):
        state = weighting.exact(point, weighting.steps(fitted.state))
        found.append(_lower(experiment, _at(experiment, fitted.causes, fitted.problem, state), _FIRST))
    for entry, parameter in enumerate(fitted.problem.parameters):
        if not parameter.is_phase:
            continue
        for turn in (-_KICK, _KICK):
            point = fitted.point.copy()
            point[entry] += turn
            state = State(point, weighting.residual(point), fitted.state.jacobian, False)
            found.append(_lower(experiment, _at(experiment, fitted.causes, fitted.problem, state), _FIRST))
    return found


def _begun(experiment: Experiment, fitted: Hypothesis) -> FloatArray:
    """The fitted vector (p,), with records that begin far from their first reading moved to it."""
    problem, point = fitted.problem, fitted.point.copy()
    for entry, nuisance in enumerate(problem.nuisances, start=len(problem.free)):
        if nuisance.kind == "initial position":
            part = experiment.readings[nuisance.record]
            first = float(part.record.position[0]) - fitted.initial[nuisance.record].zero
            if abs(point[entry] - first) > _ASIDE * part.noise:
                point[entry] = first
    return np.asarray(np.clip(point, problem.lower, problem.upper))


def _distinct(begun: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Beginnings with different chi², which are taken for different minima."""
    kept: list[Hypothesis] = []
    for fitted in begun:
        if all(abs(fitted.chi - other.chi) > SAME * other.chi for other in kept):
            kept.append(fitted)
    return kept


def _settled(experiment: Experiment, fitted: Hypothesis, least: float) -> Hypothesis:
    for _ in range(THOROUGH // LOOK):
        before = fitted.chi
        fitted = _lower(experiment, fitted, LOOK)
        fall = before - fitted.chi
        if fall <= _settled_gain(experiment, fitted):
            break
        if fitted.chi > _hopeless(experiment, least) and fall < 0.5 * before:
            return fitted
    return exactly(experiment, fitted) if fitted.chi < _hopeless(experiment, least) else fitted


def _hopeless(experiment: Experiment, least: float) -> float:
    """The chi² above which a set has lost against one that leaves ``least``.

    Far from the noise no model is right, and there a factor of a few in chi² is a large difference in evidence.
    """
    if least > FAR * experiment.evidence:
        return least * _HOPELESS_FAR
    return experiment.worse(least, COMPARABLE)


def _settled_gain(experiment: Experiment, fitted: Hypothesis) -> float:
    """Decrease of chi² that is not worth a simulation: far below one piece of evidence, or a small part of the chi²."""
    slack = _SLACK_FAR if fitted.chi > FAR * experiment.evidence else _SLACK
    return LEAST_FALL + slack * max(fitted.chi - experiment.evidence, 0.0)


def exactly(experiment: Experiment, fitted: Hypothesis) -> Hypothesis:
    """The same set with a Jacobian that is computed at its point, after a last step with it.

    Args:
        experiment: readings with their weights.
        fitted: returned as it is if its Jacobian is exact already.
    """
    if fitted.state.exact:
        return fitted
    weighting = weigh(fitted.problem, experiment.readings)
    state = weighting.exact(fitted.point, weighting.steps(fitted.state))
    state = descend(weighting, state, 2, _settled_gain(experiment, fitted))
    if not state.exact:
        state = weighting.exact(state.point, weighting.steps(state))
    return _at(experiment, fitted.causes, fitted.problem, state)


def refine(experiment: Experiment, causes: Causes, model: Model, initial: Sequence[Initial]) -> Hypothesis:
    """A set fitted from given values to full precision.

    Args:
        experiment: readings with their weights.
        causes: names of the set.
        model: its values are the starting point.
        initial: initial state of each record to start from.
    """
    problem, weighting, point = formulated(experiment, model, initial)
    state = descend(weighting, weighting.exact(point, weighting.steps(None)), 3, LEAST_FALL)
    state = descend(weighting, weighting.exact(state.point, weighting.steps(state)), THOROUGH, LEAST_FALL)
    return exactly(experiment, _at(experiment, causes, problem, state))


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


def _lower(experiment: Experiment, fitted: Hypothesis, steps: int) -> Hypothesis:
    weighting = weigh(fitted.problem, experiment.readings)
    state = descend(weighting, fitted.state, steps, _settled_gain(experiment, fitted))
    return _at(experiment, fitted.causes, fitted.problem, state)


def _at(experiment: Experiment, causes: Causes, problem: Problem, state: State) -> Hypothesis:
    model = problem.model.with_values(problem.values(state.point))
    return Hypothesis(causes, model, problem, state, experiment.readings, experiment.rests)
