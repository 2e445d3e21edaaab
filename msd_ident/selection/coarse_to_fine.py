"""Search on a part of the data first (thinned samples, a section, coarse steps); refine and judge the leaders on all
data.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from msd_ident.estimate.effort import A_SWING, KEPT, SAMPLES
from msd_ident.estimate.levels import MOST_OF, TENTH
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.regression_init import starting_state
from msd_ident.residuals.adequacy import judge
from msd_ident.residuals.noise_model import NOISE_ERROR
from msd_ident.selection.cause_assessment import noted
from msd_ident.selection.equal_motion import equal_motion
from msd_ident.selection.evidence import log_evidence, scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.fitted_sets import Progress
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import FAR, REACH, refine
from msd_ident.selection.ranking import LEADERS, NEAR, Ranking
from msd_ident.selection.speed_curves import also_bent
from msd_ident.selection.structure_search import Remembered, Search
from msd_ident.selection.undetermined import undetermined


def search(
    experiment: Experiment,
    known: tuple[Hypothesis, Hypothesis],
    progress: Progress,
    remembered: Sequence[Remembered] = (),
) -> Ranking:
    """Search for sets of causes on thinned samples, then refine and judge the leading sets on all samples.

    A set that is far behind on a part of the data is further behind on all of it. If the part was simulated with
    mean forces, or lines, between its few samples, a cause may have helped only against the error of that; so simpler
    sets are judged on all samples too. The search goes on with all samples if these show a misfit that the part does
    not show, or if the part cannot tell.

    Args:
        experiment: all samples.
        known: the base model and the one with Coulomb friction, fitted to all samples.
        progress: called for each set, see ``Progress``.
        remembered: sets that explained a part of the data, each with its model and initial states; they are tried
            again.

    Returns:
        All sets that were fitted to all samples, by evidence.
    """
    thin = experiment.thinned(SAMPLES)
    if all(few is part for few, part in zip(thin.readings, experiment.readings, strict=True)):
        only = _searching(experiment, progress)
        return replace(_told(only.run(known[0], known[1:], remembered), experiment), unfinished=_ended_after(only))
    part, blurred = _coarser(thin, known[1], known[1].chi / experiment.evidence)
    start = tuple(refine(part, one.causes, one.model, _begun(one.initial, experiment, part)) for one in known)
    again = [(causes, model, _begun(initial, experiment, part)) for causes, model, initial in remembered]
    first = _searching(part, progress, blurred)
    ahead = first.run(start[0], start[1:], again)
    sets = {one.causes: one for one in known}
    clear = judge(ahead.best.residuals(), part.readings).consistent
    asked = ahead.within(NEAR)[:LEADERS] + _with_one_less(ahead) + _leaving_less(ahead) + _as_good(first, ahead)
    asked += [] if clear else _simpler(ahead)
    for fitted in {one.causes: one for one in asked}.values():
        initial = _begun(fitted.initial, part, experiment, known[0].initial)
        sets[fitted.causes] = refine(experiment, fitted.causes, fitted.model, initial)
    whole = _searching(experiment, progress)
    ranking = whole.compared(list(sets.values()))
    if (clear or blurred(ahead.best)) and not whole.at_floor(ranking.best):
        whole.resume(list(whole.sets.values()))
    starts = {
        one.causes: (one.causes, one.model, _begun(one.initial, part, experiment, known[0].initial))
        for one in first.sets.values()
    }
    ranking = _told(whole.beside_its_parts(starts), experiment, (ahead, part))
    return replace(ranking, unfinished=_ended_after(first, whole))


def _ended_after(*searches: Search) -> int:
    """How many sets were tried by the searches that ended before all were; 0 if none did."""
    return max((len(one.tried) for one in searches if one.unfinished), default=0)


def _told(ranking: Ranking, experiment: Experiment, *before: tuple[Ranking, Experiment]) -> Ranking:
    """The ranking with what every set leaves, and with laws that move like one of a set's; of those near the first
    one, with laws whose strength is open.
    """
    scale = scale_from(ranking.sets, experiment.readings)
    sets = {one.causes: one for one in ranking.sets}
    near = {one.causes for one in ranking.within(NEAR)}
    for causes, one in sets.items():
        ranking = ranking.with_caveats(
            causes,
            alike=equal_motion(one, sets, experiment, scale),
            bending=also_bent(one, sets, scale.noise),
            open=undetermined(one) if causes in near else frozenset(),
        )
    return noted(ranking, experiment, *before)


def _begun(
    initial: Sequence[Initial], known: Experiment, wanted: Experiment, there: Sequence[Initial] | None = None
) -> tuple[Initial, ...]:
    """Initial states for other parts of records whose initial states are known.

    The same state if both parts begin at the same instant; else that of ``there``, or one read off the samples.
    """
    found = []
    for r, (start, one, other) in enumerate(zip(initial, known.records, wanted.records, strict=True)):
        if one.time[0] == other.time[0]:
            found.append(start)
        elif there is not None:
            found.append(replace(there[r], zero=start.zero))
        else:
            position, velocity = starting_state(other, int(A_SWING) // 4)  # a parabola fits a quarter of a swing
            found.append(Initial(position - start.zero, velocity, start.zero))
    return tuple(found)


def _with_one_less(ahead: Ranking) -> list[Hypothesis]:
    """Sets that lack one of the leading set's causes; they show what each cause explains beside the others."""
    wanted = {ahead.best.causes - {name} for name in ahead.best.causes} if len(ahead.best.causes) > 1 else set()
    return [one for one in ahead.sets if one.causes in wanted]


def _leaving_less(ahead: Ranking) -> list[Hypothesis]:
    """The likeliest sets that leave only noise, or less than half of the error of the leading one, if that leaves more
    than noise: they may predict what it does not.
    """
    if ahead.leader_caveats.exact:
        return []
    pairs = list(zip(ahead.evidence, ahead.sets, strict=True))
    noise = [(value, one) for value, one in pairs if ahead.caveats_of(one.causes).exact]
    less = [(value, one) for value, one in pairs if one.chi < MOST_OF**2 * ahead.best.chi]
    return [one for _, one in sorted(noise or less, key=lambda pair: -pair[0])[:KEPT]]


def _as_good(first: Search, ahead: Ranking) -> list[Hypothesis]:
    """The likeliest sets that lack a cause of the leading one and leave hardly more, also those that are no explanation
    on the part.

    A further cause may explain little there beside the error of a law: on all data the set may leave only noise.
    """
    best, scale = ahead.best, first.scale()
    rivals = [one for one in first.sets.values() if one.chi < (1.0 + NOISE_ERROR) * best.chi]
    rivals = [one for one in rivals if len(one.causes) <= len(best.causes) + 1 and not best.causes <= one.causes]
    return sorted(rivals, key=lambda one: -log_evidence(one, scale))[:KEPT]


def _simpler(ahead: Ranking) -> list[Hypothesis]:
    """Sets with fewer causes than the leading one whose chi² is not many times as large, the best first."""
    best = ahead.best
    found = [one for one in ahead.sets if len(one.causes) < len(best.causes) and one.chi < REACH * best.chi]
    return sorted(found, key=lambda one: one.chi)[:LEADERS]


def _coarser(thin: Experiment, friction: Hypothesis, left: float) -> tuple[Experiment, Callable[[Hypothesis], bool]]:
    """Longer steps, far from the noise; and where it spares half of all forces the mean between samples, or a line.

    Args:
        thin: thinned samples.
        friction: the model with Coulomb friction, of whose misfit they may change little.
        left: chi² that this model leaves, for each piece of evidence.

    Returns:
        The experiment to search on, and whether a set fitted there leaves so little that their error hides the rest.
    """
    if left <= FAR:
        return thin, lambda fitted: False
    for fewer in (thin.with_mean_force(), thin.with_force_lines(), thin):
        coarse = fewer.loose()
        spares = fewer is thin or _forces(fewer) < MOST_OF * _forces(thin)
        if spares and _change(thin, coarse, friction) < TENTH**2 * left * thin.evidence:
            return coarse, partial(_is_blurred, thin, coarse)
    return thin, lambda fitted: False


def _forces(experiment: Experiment) -> int:
    return sum(record.force.size for record in experiment.records)


def _is_blurred(thin: Experiment, coarse: Experiment, fitted: Hypothesis) -> bool:
    """Whether the error of a coarse simulation hides what a set leaves."""
    return _change(thin, coarse, fitted) > MOST_OF**2 * fitted.chi


def _change(thin: Experiment, coarse: Experiment, fitted: Hypothesis) -> float:
    """Chi² of what coarse simulations change of a model's motion."""
    exact, rough = (one.problem(fitted.model) for one in (thin, coarse))
    values = dict(zip(fitted.model.names, fitted.model.values.tolist(), strict=True))
    # Fewer samples may show otherwise whether a record begins at rest: the entries of the vector differ then.
    points = [problem.vector(values, fitted.initial) for problem in (exact, rough)]
    parts = enumerate(thin.readings)
    return sum(part.chi(exact.residual(points[0], r) - rough.residual(points[1], r)) for r, part in parts)


def _searching(
    experiment: Experiment, progress: Progress, blurred: Callable[[Hypothesis], bool] = lambda fitted: False
) -> Search:
    def at_floor(fitted: Hypothesis) -> bool:
        """Whether a set leaves nothing that calls for a further cause."""
        # What is left above the noise by less than the noise's own error calls for no further cause.
        return (
            fitted.chi < (1.0 + NOISE_ERROR) * experiment.evidence
            or judge(fitted.residuals(), experiment.readings).consistent
            or blurred(fitted)
        )

    return Search(experiment, at_floor, progress)
