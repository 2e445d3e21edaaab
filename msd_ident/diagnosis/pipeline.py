"""The diagnosis, step by step: is anything wrong, what is missing, which causes, does it predict, with which
probability.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from msd_ident import parallel
from msd_ident.diagnosis import intervals, ranges, rival_sets, verdict
from msd_ident.diagnosis.choice import Choice, chosen
from msd_ident.diagnosis.result import Cause, Diagnosis
from msd_ident.diagnosis.searching import Searched, Task, floor, result, search, silent
from msd_ident.estimate import FitResult, see, see_reduction
from msd_ident.estimate.levels import NEGLIGIBLE, TENTH
from msd_ident.estimate.result import scale_known
from msd_ident.estimate.summary import SCALE_SAID
from msd_ident.features import extract
from msd_ident.model.effects import by_name
from msd_ident.model.joint_words import said_of
from msd_ident.quantity import Quantity
from msd_ident.residuals import dependence, nonparametric
from msd_ident.residuals.adequacy import Adequacy, judge
from msd_ident.residuals.disturbance import DisturbanceEstimate, lacking_force, missing_force
from msd_ident.residuals.noise_spectrum import NoiseSpectrum
from msd_ident.residuals.ringdown import RingDown, ring_down
from msd_ident.residuals.unexplained import JudgedModel, remainders
from msd_ident.selection import (
    doubts,
    gain_laws,
    identities,
    naming,
    replication,
    rest_constraint,
    ties,
)
from msd_ident.selection.candidate_models import of_ranking
from msd_ident.selection.cause_assessment import assess
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.fitted_sets import Progress
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import DECISIVE, Ranking


def diagnose_records(task: Task, progress: Progress = silent, earlier: Diagnosis | None = None) -> Diagnosis:
    """What m x'' + b x' + k x = F gets wrong about these records, the causes, the extended model and its gain.

    Arguments and errors are those of ``search``.
    """
    return concluded(task, search(task, progress, earlier), progress)


def concluded(task: Task, found: Searched, progress: Progress = silent) -> Diagnosis:
    """What a search for a task found, as a diagnosis; ``progress`` as of ``diagnose_records``."""
    experiment, base, shared = found.experiment, found.base, found.shared
    choice = chosen(experiment, base, found.ranking, task.calibrate, progress)
    ranking, best, scale, alike = choice.ranking, choice.best, choice.scale, choice.alike
    progress("verdict", 0.97, "")
    base, shown = _resting(experiment, base), _resting(experiment, best)
    heard, left = _heard(experiment, scale.other_noise, (base, shown))
    rivals = _beside(experiment, best, ranking, alike, scale)
    rubbing = ranking.rubbing.get(best.causes)
    faint = rubbing and _resting(experiment, rubbing)
    fit = result(experiment, shown, shared)
    extended = intervals.stated(fit, shown, rivals, scale, faint)
    plain = intervals.stated(result(experiment, base, shared), base, (), scale) if best.causes else extended
    fits = (plain, extended)
    causes = _causes(ranking, best, fits[1]) if best.causes else ()
    ends = ((base, left[0]), (shown, left[1]))
    missing, *lacking = _forces(heard, base, ends if best.causes else ends[1:])
    still = lacking[-1]
    judged = [JudgedModel(*one) for one in zip(fits, (lacking[0], still), left, strict=True)]
    lacks = remainders(task.records, floor(heard), judged[0], judged[1], task.tolerance)
    decision = verdict.decide(causes, lacks)
    curves = nonparametric.measure(heard.readings, shown.model, shown.initial, fits[0].see) if lacks.exceeds else None
    tied = ranking.within(DECISIVE) if decision == "ambiguous" else [best]
    others = [_resting(experiment, one) for one in (*tied, *alike) if one is not best]
    moved = ranges.over(extended, others, ranking.caveats_of(best.causes).exact, shared)
    said = _warned(task, choice, shown) + verdict.spread_sentence(moved) + fits[1].open_directions
    if not scale_known(fits[1].quantities):
        said += not_said(fits[0].open_directions, fits[1].open_directions) or (intervals.NO_SCALE,)
    after = dependence.sentence(still), _unnamed(ranking, best, scale)
    return Diagnosis(
        records=task.records,
        findings=task.findings,
        verdict=decision,
        summary=verdict.summary(decision, causes, lacks, choice.heldout, after),
        causes=causes,
        base=fits[0],
        extended=fits[1],
        see_reduction_percent=see_reduction(fits[0].see, fits[1].see),
        heldout=choice.heldout,
        noise_floor=floor(heard),
        base_adequacy=left[0],
        adequacy=left[1],
        left=lacks,
        missing=missing,
        dependences=dependence.dependences(missing),
        still_missing=still,
        characteristics=curves,
        spread=moved,
        rivals=rival_sets.listed(ranking, best, partial(_floors_left, experiment, scale.other_noise)),
        calibration=choice.matrix,
        warnings=tuple(dict.fromkeys(said)),
        ring_down=_read(task, causes, fits[1]),
        contenders=of_ranking(ranking, scale, experiment.readings),
        tried=assess(experiment.library, ranking, best.causes, [name for cause in causes for name in cause.tied_with]),
        derived=intervals.at_rest(fit, shown, rivals, scale),
    )


def not_said(sentences: Sequence[str], before: Sequence[str]) -> tuple[str, ...]:
    """Sentences but for those on an unknown gain or scale that another list of parameters was told of before."""
    known = {one.partition(SCALE_SAID)[0] for one in before if SCALE_SAID in one}
    return tuple(one for one in sentences if one.partition(SCALE_SAID)[0] not in known)


def _warned(task: Task, choice: Choice, shown: Hypothesis) -> tuple[str, ...]:
    """What is known about the data, and why named causes are not certain."""
    said = task.warnings + identities.sentences(shown.model, task.forced, task.gain_known)
    if choice.best.causes != choice.ranking.best.causes:
        return said
    doubted = tuple(said_of(one, task.records[0].position_unit) for one in doubts.sentences(choice.ranking))
    return said + doubted + replication.left_unchecked(choice.ranking, choice.matrix)


def _unnamed(ranking: Ranking, best: Hypothesis, scale: NoiseScale) -> str:
    """Why other explanations than the named one are not named, in a sentence or none."""
    return verdict.unpredicted(best.causes, ranking.best.causes, naming.leaving_less(ranking, scale.most))


def _beside(
    experiment: Experiment, best: Hypothesis, ranking: Ranking, alike: Sequence[Hypothesis], scale: NoiseScale
) -> list[tuple[float, Hypothesis]]:
    """The explanations beside the leading one that are not negligible, with their probabilities (``naming.chances``).

    Laws of the force's gain that fit alike share the probability of the leading set, if they have none of their own.
    """
    chances = naming.chances(ranking)
    pairs = [(chances[one.causes], one) for one in ranking.sets if one.causes != best.causes]
    ranked = [(p, one) for p, one in pairs if p > NEGLIGIBLE]
    known = {one.causes for _, one in ranked}
    others = [one for one in alike if one.causes not in known]
    found = ranked + gain_laws.shares(others, best, scale, ranking.of_set(best.causes))
    return [(p, _resting(experiment, one)) for p, one in found]


def _read(task: Task, causes: Sequence[Cause], fit: FitResult) -> RingDown | None:
    """The ring-down, its sentences read with the causes that are named and with the simulated motion."""
    if task.ring_down is None or not task.ring_down.observations:
        return task.ring_down
    strengths = ((cause.name, cause.parameters.get(by_name(cause.name).neutral[0][0])) for cause in causes)
    named = {name: strength.value for name, strength in strengths if strength is not None}
    tied = dict.fromkeys(name for cause in causes for name in cause.tied_with)
    pairs = zip(task.records, fit.residuals, strict=True)
    simulated = ring_down([extract(replace(record, position=record.position + left)) for record, left in pairs])
    return task.ring_down.beside(simulated).read_with(named, tied)


def _causes(ranking: Ranking, best: Hypothesis, result: FitResult) -> tuple[Cause, ...]:
    """The causes of a set, the one first without which most is left."""
    found = []
    for name in sorted(best.causes):
        parameters = {p.name: result.quantities[p.name] for p in by_name(name).parameters}
        tied = ties.tied(ranking, name)
        probability, either = ranking.of_cause(name), ranking.of_any((name, *tied))
        in_any_law = ranking.of_other_laws(name) > TENTH
        found.append(Cause(name, probability, _finite(parameters), tied, either, in_any_law))
    without = {fitted.causes: fitted.chi for fitted in ranking.sets}
    return tuple(sorted(found, key=lambda cause: -without.get(best.causes - {cause.name}, math.inf)))


def _finite(parameters: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """Without limits that stand at infinity, i.e. are not there."""
    return {name: q for name, q in parameters.items() if math.isfinite(q.value)}


def _resting(experiment: Experiment, fitted: Hypothesis) -> Hypothesis:
    """The same set with rest at the start as a constraint, which decides what the samples leave open and no more."""
    missed = see(fitted.residuals())  # a wrong model errs at rest too
    known = tuple(
        replace(balance, spread=balance.spread + missed) for balance in rest_constraint.rest_constraints(fitted)
    )
    return rest_constraint.constrained(fitted, experiment.readings, known)


def _heard(
    experiment: Experiment, noise: NoiseSpectrum | None, sets: Sequence[Hypothesis]
) -> tuple[Experiment, tuple[Adequacy, ...]]:
    """The data with the noise that the residual shows, and the tests of what each set leaves, whitened.

    Args:
        experiment: with the noise that the readings told.
        noise: of the residual; None if it is that.
        sets: to be tested.
    """
    if noise is None:
        return experiment, tuple(judge(one.residuals(), experiment.readings) for one in sets)
    white = ([noise.whitened(residual) for residual in one.residuals()] for one in sets)
    louder = tuple(replace(part, noise=noise.growth * part.noise) for part in experiment.readings)
    return replace(experiment, readings=louder), tuple(judge(residuals, experiment.readings) for residuals in white)


def _floors_left(experiment: Experiment, noise: NoiseSpectrum | None, one: Hypothesis) -> float:
    """What a set leaves, in floors of the noise in which the named models are judged (``_heard``)."""
    if noise is None:
        return math.sqrt(one.chi / experiment.evidence)
    return _heard(experiment, noise, (one,))[1][0].ratio


def _forces(
    experiment: Experiment, base: Hypothesis, judged: Sequence[tuple[Hypothesis, Adequacy]]
) -> list[tuple[DisturbanceEstimate, ...]]:
    """The missing force of the base model, then what each of the judged sets still lacks, estimated side by side."""
    works = [partial(_missing, experiment, base), *(partial(_still_missing, experiment, *one) for one in judged)]
    return parallel.each(lambda work: work(), works)


def _missing(experiment: Experiment, fitted: Hypothesis) -> tuple[DisturbanceEstimate, ...]:
    plant = (fitted.model.mass, fitted.model.damping, fitted.model.stiffness)
    return tuple(
        missing_force(part.record, plant, part.noise, state.zero)
        for part, state in zip(experiment.readings, fitted.initial, strict=True)
    )


def _still_missing(experiment: Experiment, best: Hypothesis, left: Adequacy) -> tuple[DisturbanceEstimate, ...]:
    """The force that a model lacks, one for each record (``disturbance.lacking_force``)."""
    plant = (best.model.mass, best.model.damping, best.model.stiffness)
    parts = zip(experiment.readings, best.residuals(), strict=True)
    return tuple(
        lacking_force(part.record, residual, plant, part.noise, only_noise=left.consistent) for part, residual in parts
    )
