"""Fits of a set of causes from its starting points: a few steps from each, and the best refined."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.broyden import State, Weighting, descend, step
from msd_ident.estimate.effort import LOOK, THOROUGH
from msd_ident.estimate.levels import ALIKE, BEYOND_DOUBT, DAMPING, MOST_OF, NEGLIGIBLE
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.model import Model
from msd_ident.model.effects import by_name
from msd_ident.selection.experiment import Experiment, formulated, weigh
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.tuning import fixed, tuned

_FIRST = tuned(4, unit="steps", why="first look at a start of a set", chosen="by hand")
_STRONGER = tuned(
    1.5,
    unit="factor",
    why="strength of a harmonic law from which a second fit begins",
    chosen="on cogging (`python -m bench.blind`, seeds 170355 and 176245): found with it, not without: first fits end "
    "at 0.68 and 0.61 of the amplitude",
)
FAR = tuned(
    25.0,
    unit="chi² for each piece of evidence",
    why="far from the noise: what is left is the model's, not the data's",
    chosen="with 100 a measured cart (`python -m bench.real --only step_1`) is searched for 47 s in place of "
    "14, to the same cause",
)
COMPARABLE = tuned(
    4.0,
    unit="1",
    why="times the variance, or the chi², of another set: with more, a set is not refined, begun again or started from",
    chosen="by hand",
)
REACH = tuned(
    10.0,
    unit="1",
    why="times the variance of the best set which a start may promise, or the chi² which a set may leave, to be "
    "looked at",
    chosen="by hand",
)
SAME = fixed(1e-3, "accuracy", "relative difference of the chi² of two starts or ends that are one")
#: Fall of chi² that is not worth a simulation beside noise: a negligible part of one piece of evidence.
LEAST_FALL = NEGLIGIBLE


@dataclass(frozen=True)
class StartingPoint:
    """A start of a set.

    A start is judged by the chi² that its first Gauss–Newton step predicts, not by its own: a guess of the right shape
    but the wrong size is a good one.

    Attributes:
        promise: the predicted chi².
        fitted: the set at the start.
        beside: chi² of the smaller set from which the start was made.
        least: chi² that a step with hardly any damping predicts, which goes far along directions that the data shows
            only weakly.
    """

    promise: float
    fitted: Hypothesis
    beside: float
    least: float = math.inf

    def worth(self, reach: float) -> bool:
        """Whether to follow the start.

        It may reach a chi² below ``reach``, or less than half that of the smaller set. In the second case the first
        step tells little about where the start leads.
        """
        return min(self.promise, self.least) < max(reach, MOST_OF * self.beside)


def begin(experiment: Experiment, found: Sequence[StartingPoint], reach: float) -> list[Hypothesis]:
    """A few steps down from the most promising starts of a set.

    Args:
        experiment: readings with their weights.
        found: starts by rising ``promise``; the first one is always followed.
        reach: predicted chi² below which a further start is followed, if it is also below what the starts before it
            have reached; one that promises half of the smaller set is followed anyway (``StartingPoint.worth``).

    Returns:
        The sets as they are after these steps, by rising chi².
    """
    ahead: list[Hypothesis] = []
    for start in found:
        if not ahead or start.worth(min(reach, *(fitted.chi for fitted in ahead))):
            ahead.append(_lower(experiment, start.fitted, _FIRST))
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
    for _ in range(LOOK):
        if not ALIKE**2 * experiment.evidence < best.chi < _worth_kicking(experiment, least):
            break
        kicked = [_settled(experiment, fitted, best.chi) for fitted in _kicked(experiment, best)]
        before, best = best, min([best, *kicked], key=lambda fitted: fitted.chi)
        if before.chi - best.chi <= _negligible(experiment, best.chi):
            break  # no start beside it leads further down
    return best


def _kicked(experiment: Experiment, fitted: Hypothesis) -> list[Hypothesis]:
    """A few steps down from other starts, which may lead to another minimum.

    One with stronger harmonic laws. And one from the first readings, if the fit begins far from them: a smaller model
    makes up for missing laws with a shifted start, and with friction a larger model that starts from there keeps the
    shift.
    """
    weighting = weigh(fitted.problem, experiment.readings)
    found = []
    point = _begun(experiment, fitted)
    if not np.array_equal(point, fitted.point):
        state = weighting.exact(point, weighting.steps(fitted.state))
        found.append(_lower(experiment, _at(experiment, fitted.causes, fitted.problem, state), _FIRST))
    stronger = _stronger(fitted)
    if stronger is not None:
        found.append(_down(experiment, fitted, weighting, stronger))
    return found


def _stronger(fitted: Hypothesis) -> FloatArray | None:
    """The fitted vector (p,) with stronger harmonic laws: at ripples that are too weak the cart does not stick.

    None if the set has no harmonic law.
    """
    point = fitted.point.copy()
    for entry, index in enumerate(fitted.problem.free):
        name = fitted.problem.model.names[index]
        for cause in fitted.causes:
            law = by_name(cause)
            if name in dict(law.neutral) and any(parameter.is_phase for parameter in law.parameters):
                point[entry] *= _STRONGER
    return None if np.array_equal(point, fitted.point) else np.clip(point, fitted.problem.lower, fitted.problem.upper)


def _down(experiment: Experiment, fitted: Hypothesis, weighting: Weighting, point: FloatArray) -> Hypothesis:
    """A few steps down from another point, with the set's present Jacobian."""
    known = fitted.state
    state = State(point, weighting.residual(point), known.jacobian, known.normal, False)
    return _lower(experiment, _at(experiment, fitted.causes, fitted.problem, state), _FIRST)


def _begun(experiment: Experiment, fitted: Hypothesis) -> FloatArray:
    """The fitted vector (p,), with records that begin far from their first reading moved to it."""
    problem, point = fitted.problem, fitted.point.copy()
    for entry, nuisance in enumerate(problem.nuisances, start=len(problem.free)):
        if nuisance.kind == "initial position":
            part = experiment.readings[nuisance.record]
            first = float(part.record.position[0]) - fitted.initial[nuisance.record].zero
            if abs(point[entry] - first) > BEYOND_DOUBT * part.noise:
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
    hopeless = _hopeless(experiment, least)
    if fitted.chi > hopeless and _promises_too_little(experiment, fitted, least):
        return fitted
    for _ in range(THOROUGH // LOOK):
        before = fitted.chi
        fitted = _lower(experiment, fitted, LOOK)
        fall = before - fitted.chi
        if fall <= _negligible(experiment, fitted.chi):
            break
        if fitted.chi > hopeless and fall < 0.5 * before:
            return fitted
    return exactly(experiment, fitted) if fitted.chi < hopeless else fitted


def _promises_too_little(experiment: Experiment, fitted: Hypothesis, least: float) -> bool:
    """Whether a step with hardly any damping would not halve the chi², beside a set that leaves little more than noise.

    Far from the noise no model is right, and what a step promises says little.
    """
    return (
        not _leaves_far_more(experiment, least) and step(fitted.problem, fitted.state, DAMPING**2)[1] < 0.5 * fitted.chi
    )


def _leaves_far_more(experiment: Experiment, chi: float) -> bool:
    """Whether a set's error is of another size than the noise."""
    return chi > COMPARABLE * experiment.evidence


def _hopeless(experiment: Experiment, least: float) -> float:
    """The chi² above which a set has lost against one that leaves ``least``.

    Far from the noise no model is right, and there a factor of a few in chi² is a large difference in evidence.
    """
    if _leaves_far_more(experiment, least):
        return least * ALIKE**2
    return experiment.worse(least, COMPARABLE)


def _worth_kicking(experiment: Experiment, least: float) -> float:
    """The chi² below which a set is begun from other starts: far from the noise, where most sets are as good as the
    leading one, only a set that leads is.
    """
    return least if _leaves_far_more(experiment, least) else _hopeless(experiment, least)


def _negligible(experiment: Experiment, chi: float) -> float:
    """Fall of a chi² that is not worth a few steps: far below one piece of evidence, or a small part of the chi²."""
    return LEAST_FALL + SAME * max(chi - experiment.evidence, 0.0)


def exactly(experiment: Experiment, fitted: Hypothesis) -> Hypothesis:
    """The same set with a Jacobian that is computed at its point, after a last step with it.

    Args:
        experiment: readings with their weights.
        fitted: returned as it is if its Jacobian is exact already.
    """
    if fitted.state.exact:
        return fitted
    weighting = weigh(fitted.problem, experiment.readings)
    state = weighting.renewed(fitted.state)
    state = descend(weighting, state, 2, _negligible(experiment, fitted.chi))
    if not state.exact:
        state = weighting.renewed(state)
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
    return exactly(experiment, _at(experiment, causes, problem, descended(experiment, weighting, point)))


def refine_near(
    experiment: Experiment, causes: Causes, model: Model, initial: Sequence[Initial], most: float = math.inf
) -> Hypothesis | None:
    """``refine`` from a start that leaves less than ``most`` and than ``COMPARABLE`` times a still cart, else None.

    A start that leaves many times as much as a cart that does not move at all says nothing about the minimum, and a fit
    from there simulates a stiff or unstable model step by tiny step.
    """
    _, weighting, point = formulated(experiment, model, initial)
    left = weighting.residual(point)
    near = left @ left < min(most, COMPARABLE * experiment.motion)
    return refine(experiment, causes, model, initial) if near else None


def descended(experiment: Experiment, weighting: Weighting, point: FloatArray) -> State:
    """Where a descent from a point (p,) ends.

    A cart that sticks gives the chi² many small kinks, down which a fit far from the noise creeps for hundreds of
    simulations: there it ends where a few steps change next to nothing. Nearer to the noise this may be a bent valley
    that leads on.
    """
    far = FAR * experiment.evidence
    state = weighting.exact(point, weighting.steps(None))
    state = weighting.renewed(descend(weighting, state, _FIRST, LEAST_FALL))
    for _ in range(THOROUGH // LOOK):
        before = state.chi
        state = descend(weighting, state, LOOK, least_fall(experiment, before) if before > far else LEAST_FALL)
        if state.chi == before or (state.chi > far and before - state.chi <= _negligible(experiment, state.chi)):
            break
    return state


def least_fall(experiment: Experiment, chi: float) -> float:
    """The fall of a chi² that is worth a simulation where a fit ends: below it, the evidence hardly changes.

    Evidence is stated in units of what the best set leaves, be that noise or far more.
    """
    return LEAST_FALL * max(chi / experiment.evidence, 1.0)


def _lower(experiment: Experiment, fitted: Hypothesis, steps: int) -> Hypothesis:
    weighting = weigh(fitted.problem, experiment.readings)
    state = descend(weighting, fitted.state, steps, _negligible(experiment, fitted.chi))
    return _at(experiment, fitted.causes, fitted.problem, state)


def _at(experiment: Experiment, causes: Causes, problem: Problem, state: State) -> Hypothesis:
    model = problem.model.with_values(problem.values(state.point))
    return Hypothesis(causes, model, problem, state, experiment.readings, experiment.rests)
