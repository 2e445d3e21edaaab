"""The leading explanations of an experiment, simulated and diagnosed again: the rows of ``calibration``."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident import parallel, seeds
from msd_ident.data.record import Record
from msd_ident.estimate.effort import KEPT, SAMPLES
from msd_ident.estimate.levels import CONFIDENCE
from msd_ident.model.effects import by_name, spoken
from msd_ident.residuals import noise_model
from msd_ident.residuals.adequacy import judge
from msd_ident.selection import coarse_to_fine, naming
from msd_ident.selection.calibration import Calibration, Row, corrected
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.excitation import poor
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.fitted_sets import Progress
from msd_ident.selection.hypothesis import COULOMB, NOTHING, Causes, Hypothesis, causes_that_fit, kinds, without
from msd_ident.selection.hypothesis_fit import FAR, refine
from msd_ident.selection.ranking import NEAR, Ranking
from msd_ident.selection.structure_search import Remembered
from msd_ident.selection.synthetic_records import Disturbed, Imagined, drawn, of_any_strength, whole
from msd_ident.tuning import tuned

COPIES = tuned(
    8,
    unit="copies",
    why="of each explanation; twice as many of a single one whose strengths are drawn by lot",
    chosen="by hand",
)
#: Copies without a cause that a certain name needs at least: from so many on, Laplace's rule (N + 1)/(N + 2), which
#: limits what they allow, does not fall below the level of all intervals.
_ENOUGH = math.ceil((2.0 * CONFIDENCE - 1.0) / (1.0 - CONFIDENCE))
_CHEAP = tuned(
    1e7,
    unit="samples × sets",
    why="cost up to which copies are made unasked",
    chosen="measured at 3 to 40 s of processor time",
)
_OVERHEAD = tuned(
    2000, unit="samples", why="samples whose simulation costs as much as what is done around it", chosen="by hand"
)


@dataclass(frozen=True)
class Explanation:
    """An explanation to copy.

    Attributes:
        causes: names of its set.
        fitted: the fitted set; None if strengths are to be drawn by lot, or if it is not fitted yet.
        any_strength: whether the strengths of its laws are to be drawn by lot.
    """

    causes: Causes
    fitted: Hypothesis | None
    any_strength: bool = False

    def fitted_from(self, experiment: Experiment, lead: Hypothesis) -> Explanation:
        """The same, fitted: a part of the leading set starts from that set without the other causes."""
        if self.fitted is not None or self.any_strength:
            return self
        (gone,) = lead.causes - self.causes
        return replace(self, fitted=refine(experiment, self.causes, *without(lead, gone)))


@dataclass(frozen=True)
class Study:
    """What all copies of an experiment share.

    Attributes:
        experiment: the measured one, asked about the causes of the leading explanations alone.
        thin: a part of its samples, on which strengths drawn by lot are adjusted to the record.
        lead: the leading set.
        plain: the base model and the one with Coulomb friction, fitted: where a copy's diagnosis begins.
        scale: gives the variance in which parameters are known.
        disturbed: what is added to a copy's motion.
        remembered: sets fitted to the record from which a copy's diagnosis begins too, where they leave far more than
            noise: there the error has many minima, and to look for the right one in each copy took most of the time.
    """

    experiment: Experiment
    thin: Experiment
    lead: Hypothesis
    plain: tuple[Hypothesis, ...]
    scale: NoiseScale
    disturbed: Disturbed
    remembered: tuple[Remembered, ...]

    def copy(self, of: Explanation, number: tuple[int, int]) -> tuple[Imagined, tuple[Record, ...]]:
        """One copy of an explanation.

        Args:
            of: the explanation; its parameters are drawn from their posterior, or its strengths by lot if it was not
                fitted.
            number: index of the explanation and of the copy, from which the random numbers follow.

        Returns:
            The drawn set and its simulated records.
        """
        rng = np.random.default_rng([seeds.CALIBRATION, *number])
        if of.fitted is not None:
            found = drawn(of.fitted, self.scale, rng)
        else:
            found = whole(self.experiment, of_any_strength(self.thin, self.lead, of.causes, rng))
        return found, self.disturbed.copy(found, rng)

    def said(self, records: Sequence[Record]) -> Causes:
        """The causes that a diagnosis of a copy names; none where the cart of the copy sticks all the time."""
        if not any(np.ptp(record.position) for record in records):
            return NOTHING
        measured = self.experiment.readings
        parts = [
            noise_model.of_record(made, part.noise, part.step) for made, part in zip(records, measured, strict=True)
        ]
        experiment = replace(self.experiment, readings=tuple(parts), begun=bool(self.remembered))
        plain = tuple(refine(experiment, one.causes, one.model, one.initial) for one in self.plain)
        if judge(plain[0].residuals(), parts).consistent:
            return NOTHING
        ranking = coarse_to_fine.search(experiment, (plain[0], plain[-1]), _silent, self.remembered)
        return naming.leading(ranking).best.causes


def _silent(stage: str, fraction: float, cause: str) -> None:
    """Report to nobody."""


def explanations(ranking: Ranking, library: Sequence[str]) -> list[Explanation]:
    """The explanations to copy: the leading set, and for each of its causes the sets that could stand in its place.

    Those are the best sets within ``NEAR`` without the cause, the leading set with another law of the cause's family in
    its place, and the leading set without it.

    Args:
        ranking: sets by evidence, the leading one first.
        library: names of the causes that can act in the experiment.
    """
    lead = ranking.best
    fitted = {one.causes: one for one in ranking.sets}
    found = {lead.causes: Explanation(lead.causes, lead)}
    top = max(ranking.evidence)
    for cause in sorted(lead.causes):
        near = [
            one
            for one, value in zip(ranking.sets, ranking.evidence, strict=True)
            if by_name(cause).cause() not in kinds(one.causes) and value > top - NEAR
        ]
        for one in near[:KEPT]:
            part = one.causes < lead.causes
            found.setdefault(one.causes, Explanation(one.causes, one if part else None, not part))
        for other in _family(cause, library):
            wanted = lead.causes - {cause} | {other}
            if causes_that_fit(wanted):
                found.setdefault(wanted, Explanation(wanted, None, True))
        less = lead.causes - {cause}
        found[less] = Explanation(less, fitted.get(less))
    return list(found.values())


def _family(cause: str, library: Sequence[str]) -> list[str]:
    """Other laws of a cause's family."""
    family, kind = by_name(cause).family, by_name(cause).cause()
    others = [name for name in library if by_name(name).cause() != kind and not by_name(name).form_of]
    return [name for name in others if family and by_name(name).family == family]


def checked(
    experiment: Experiment, base: Hypothesis, ranking: Ranking, asked: bool, progress: Progress
) -> tuple[Ranking, Calibration | None]:
    """The ranking as corrected by copies of the experiment, and their confusion matrix.

    Unless ``asked``, no copies are made if the experiment is not poor, if left-out data chose the leading set, whose
    causes are not certain anyway, if they cost more than ``_CHEAP``, or if the leading set leaves far more than noise:
    no copy of it is like the record then, and each takes many times as long. A poor experiment without copies limits
    the odds of each cause (``Ranking.limit``).

    Args:
        experiment: the measured records.
        base: the fitted base model.
        ranking: sets by evidence, the leading one first.
        asked: whether the user asked for copies.
        progress: called for each copy, see ``Progress``.

    Returns:
        The corrected ranking and the matrix; None if no copies were made.
    """
    if not asked and (ranking.rich or ranking.foretold):
        return ranking, None
    rows = explanations(ranking, experiment.library)
    counts = _copies(rows)
    far = ranking.best.chi > FAR * experiment.evidence
    if not asked and (far or cost(experiment, rows, counts) > _CHEAP):
        return replace(ranking, unchecked=True, far=far), None
    rows = [row.fitted_from(experiment, ranking.best) for row in rows]
    study = _study(experiment, base, ranking, rows)
    tasks = [(row, number) for row, count in enumerate(counts) for number in range(count)]
    answers, imagined = _all(study, rows, tasks, progress)
    made = []
    for index, row in enumerate(rows):
        said = Counter(causes for (place, _), causes in zip(tasks, answers, strict=True) if place == index)
        made.append(Row(row.causes, row.any_strength, dict(said)))
    standins = {causes: _stood(experiment, found) for causes, found in imagined.items()}
    after = corrected(ranking, made, standins)
    names = sorted(ranking.best.causes)
    stated, allowed = ({name: one.of_cause(name) for name in names} for one in (ranking, after))
    return after, Calibration(tuple(made), stated, allowed)


def left_unchecked(ranking: Ranking, matrix: Calibration | None) -> tuple[str, ...]:
    """A sentence that says why the leading set was not checked by copies, if it had to be.

    Args:
        ranking: the final one.
        matrix: the confusion matrix of the copies, if they were made; then they are of another leading set.
    """
    if not ranking.unchecked or not ranking.best.causes:
        return ()
    limit = f"odds are at most {_limits(ranking)}"
    if matrix is not None:
        return (f"The copies of this record were made of another explanation, which they did not confirm: {limit}.",)
    copies = "copies of this record, which take long to simulate, were not made to check the probabilities"
    if ranking.far:
        copies = "copies of what leaves far more than noise are not like this record, and were not made"
    return (
        f"One step, a ramp or a release excites little, and {copies}: {limit}. --calibrate makes the copies; steps in "
        "both directions need none.",
    )


def _limits(ranking: Ranking) -> str:
    """Greatest odds of the named causes in words, for each cause if they differ."""
    most = {spoken(name): f"{ranking.limit(name):g} to 1" for name in sorted(ranking.best.causes)}
    if len(set(most.values())) == 1:
        return next(iter(most.values()))
    return ", ".join(f"{odds} for {name}" for name, odds in most.items())


def _study(experiment: Experiment, base: Hypothesis, ranking: Ranking, rows: Sequence[Explanation]) -> Study:
    """What the copies share; the model with Coulomb friction is one that a diagnosis begins with."""
    asked = _asked(experiment, rows)
    asking = replace(experiment, asked=asked)
    friction = [one for one in ranking.sets if one.causes == {COULOMB} <= asked]
    scale = scale_from(list(ranking.sets), experiment.readings)
    lead, thin = ranking.best, asking.thinned(SAMPLES)
    far = lead.chi > FAR * experiment.evidence
    begun = tuple((one.causes, one.model, one.initial) for one in ranking.sets if far and NOTHING < one.causes <= asked)
    disturbed = Disturbed.by(lead, experiment.readings)
    return Study(asking, thin, lead, (base, *friction), scale, disturbed, begun)


def _asked(experiment: Experiment, rows: Sequence[Explanation]) -> frozenset[str]:
    """Causes of the explanations, and those from which a search comes to one that is not tried by itself."""
    named = frozenset().union(*(row.causes for row in rows))
    plain = set(experiment.tried_alone)
    return named.union(*(plain.intersection(experiment.forms(name)) for name in named - plain))


def is_poor(experiment: Experiment, base: Hypothesis) -> bool:
    """Whether the force excites the rig little (``excitation.poor``).

    A plant without a spring counts as one that swings as long as a twentieth of its record.
    """
    mass, stiffness = base.model.mass, base.model.stiffness
    longest = max(record.duration for record in experiment.records)
    swing = 2.0 * math.pi * math.sqrt(mass / stiffness) if stiffness > 0.0 else longest / 20.0
    return poor(experiment.records, swing)


def cost(experiment: Experiment, rows: Sequence[Explanation], counts: Sequence[int]) -> float:
    """Estimated work of the searches of all copies: samples simulated for each trial of a set, times number of sets.

    A search tries each cause alone and beside the leading ones, which is about the square of the number of causes asked
    about.

    Args:
        experiment: the measured records.
        rows: the explanations.
        counts: copies of each.
    """
    asked = len(frozenset().union(*(row.causes for row in rows)))
    samples = _OVERHEAD + sum(part.record.samples for part in experiment.readings)
    return float(samples * sum(counts) * max(asked, 1) ** 2)


def _copies(rows: Sequence[Explanation]) -> list[int]:
    """Copies of each row: more where few rows lack a cause, which certainty needs, and of a single one drawn by lot.

    Of more such rivals of a cause the mean counts (``calibration._against``), which is known from fewer copies of each.
    """
    counts = [COPIES] * len(rows)
    for cause in rows[0].causes:
        kind = by_name(cause).cause()
        drawn = [i for i, row in enumerate(rows) if row.any_strength and kind not in kinds(row.causes)]
        if len(drawn) == 1:
            counts[drawn[0]] = 2 * COPIES
    for cause in sorted(rows[0].causes):
        lacking = [i for i, row in enumerate(rows) if cause not in row.causes]
        for i in lacking:
            counts[i] = max(counts[i], math.ceil(_ENOUGH / len(lacking)))
    return counts


def _all(
    study: Study, rows: Sequence[Explanation], tasks: Sequence[tuple[int, int]], progress: Progress
) -> tuple[list[Causes], dict[Causes, Imagined]]:
    """What each copy was called, and of explanations of any strength the draw nearest to the record."""
    nearest: dict[Causes, tuple[float, Imagined]] = {}
    answers: list[Causes] = []

    def one(task: tuple[int, int]) -> tuple[Imagined, Causes]:
        imagined, records = study.copy(rows[task[0]], task)
        return imagined, study.said(records)

    def told(done: int, _: tuple[int, int]) -> None:
        progress("copies of this record", 0.9 + 0.05 * done / len(tasks), "")

    for task, (imagined, said) in zip(tasks, parallel.each(one, tasks, told), strict=True):
        answers.append(said)
        left = _chi(study.experiment, imagined)
        if rows[task[0]].any_strength and left < nearest.get(imagined.causes, (math.inf,))[0]:
            nearest[imagined.causes] = (left, imagined)
    return answers, {causes: found for causes, (_, found) in nearest.items()}


def _chi(experiment: Experiment, found: Imagined) -> float:
    return sum(part.chi(left) for part, left in zip(experiment.readings, found.residuals(), strict=True))


def _stood(experiment: Experiment, found: Imagined) -> Hypothesis:
    """A set as drawn, as if it had been fitted there."""
    model = found.problem.model.with_values(found.problem.values(found.point))
    problem, weighting, point = formulated(experiment, model, found.problem.initials(found.point))
    return Hypothesis(found.causes, model, problem, weighting.exact(point, weighting.steps(None)), experiment.readings)
