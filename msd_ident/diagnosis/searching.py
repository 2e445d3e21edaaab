"""The search of a diagnosis: its task, the data as evidence, and the ranking of the sets of causes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.quality import Finding, force_unknown, steered
from msd_ident.data.record import Record
from msd_ident.diagnosis import intervals
from msd_ident.diagnosis.result import Diagnosis
from msd_ident.errors import UsageError
from msd_ident.estimate import FitResult
from msd_ident.estimate.base_fits import Shared
from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.single_tone import common_tone
from msd_ident.estimate.summary import summarise_fit
from msd_ident.model import Model, Plant
from msd_ident.residuals import noise_model
from msd_ident.residuals.adequacy import judge
from msd_ident.residuals.ringdown import RingDown
from msd_ident.residuals.unexplained import TOLERANCE
from msd_ident.selection import coarse_to_fine, handover
from msd_ident.selection.base_hypotheses import base_fit, shared_fits
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.cause_assessment import noted
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.fitted_sets import Progress
from msd_ident.selection.hypothesis import NOTHING, Hypothesis
from msd_ident.selection.ordering import rank
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.structure_search import Remembered


def silent(stage: str, fraction: float, cause: str) -> None:
    """Progress callback that reports nothing."""


@dataclass(frozen=True)
class Task:
    """What to diagnose.

    Attributes:
        records: one experiment: all records of one plant, in one pair of units, each from its start or release on.
        sprung: False for a plain axis, whose stiffness is 0.
        plant: mass, damping and stiffness from the features, to start from.
        findings, warnings, ring_down: what is known about the data before any model; they go into the result.
        tolerance: part of the motion's rms that the lab does not care about [%].
        rest_before: for each record the rest before a hand moved the cart, which the record leaves out; None without.
        calibrate: whether copies of the records are diagnosed too, and the probabilities corrected by what they are
            called; if False, only where ``selection.replication`` finds it worth the cost.
        balanced: whether the records are stretches of an unstable motion, which a controller holds.
        known: a fit of a larger model to these records, whose effects are tried from where it stands.
    """

    records: tuple[Record, ...]
    sprung: bool = True
    plant: Model | None = None
    findings: tuple[Finding, ...] = ()
    warnings: tuple[str, ...] = ()
    ring_down: RingDown | None = None
    tolerance: float = TOLERANCE
    rest_before: tuple[Record | None, ...] = ()
    calibrate: bool = False
    balanced: bool = False
    known: FitResult | None = None

    @property
    def forced(self) -> bool:
        """Whether any force acts."""
        return any(bool(np.any(record.force_at(record.time))) for record in self.records)

    @property
    def steered(self) -> bool:
        """Whether a controller computes the force from the readings."""
        return steered(self.findings)

    @property
    def gain_known(self) -> bool:
        """Whether forces and positions are in units of mechanics."""
        return (self.records[0].force_unit, self.records[0].position_unit) in (("N", "m"), ("N·m", "rad"))


@dataclass(frozen=True)
class Searched:
    """What a search found.

    Attributes:
        experiment: the data, with the base model.
        base: the fitted base model.
        ranking: sets of causes by evidence.
        shared: the fits of the plain plant.
    """

    experiment: Experiment
    base: Hypothesis
    ranking: Ranking
    shared: Shared

    @property
    def fitted(self) -> FitResult:
        """The leading set, refitted by plain simulation error."""
        best, readings = self.ranking.best, self.experiment.readings
        scale = scale_from(self.ranking.sets, readings)
        return intervals.stated(result(self.experiment, best, self.shared), best, (), scale)


def search(task: Task, progress: Progress = silent, earlier: Diagnosis | None = None) -> Searched:
    """The sets of causes that explain records, by evidence.

    Args:
        task: what to diagnose.
        progress: called with the stage, the fraction done and the cause being tried; its exceptions end the work.
        earlier: of some of these records: its explanations are tried too, from where they stood.

    Raises:
        UsageError: no records.
    """
    if not task.records:
        raise UsageError("no records to diagnose; expected at least one")
    progress("base model", 0.02, "")
    experiment = prepare(task)
    shared = shared_fits(experiment, task.plant or experiment.base)
    base, friction = base_fit(experiment, shared)
    experiment = replace(experiment, base=base.model)
    left = judge(base.residuals(), experiment.readings)
    if left.consistent:
        ranking = replace(noted(rank({NOTHING: base}, NoiseScale()), experiment), rubbing={NOTHING: friction})
    else:
        ranking = coarse_to_fine.search(experiment, (base, friction), progress, _remembered(earlier, task))
    unseen = force_unknown(task.findings)
    ranking = replace(ranking, steered=task.steered, pushed_unseen=unseen, balanced=task.balanced)
    return Searched(experiment, base, ranking, shared)


def prepare(task: Task) -> Experiment:
    """The data as evidence, and what the base model has fixed."""
    fixed = set() if task.sprung else {"stiffness"}
    if not task.forced:
        fixed.add("mass")  # a free decay knows ratios only: the numbers are those of 1 kg
    force = max(float(np.max(np.abs(record.force))) for record in task.records)
    span = max(float(np.ptp(record.position)) for record in task.records)
    duration = max(record.duration for record in task.records)
    stiffness = (force or 1.0) / max(span, 1e-12)
    mass = stiffness * (duration / 20.0) ** 2 if task.forced else 1.0
    if not task.forced:
        stiffness = (20.0 / duration) ** 2
    model = Plant(mass, 0.1 * math.sqrt(mass * stiffness), stiffness if task.sprung else 0.0)
    parts = noise_model.prepare(task.records)
    rests = zip(task.rest_before, parts, strict=False)
    quiet = tuple(noise_model.of_record(rest, part.noise, part.step) for rest, part in rests if rest is not None)
    led = task.forced and (task.balanced or task.steered or common_tone(task.records) > 0.0)
    return Experiment(parts, model, frozenset(fixed), quiet, led=led)


def _remembered(earlier: Diagnosis | None, task: Task) -> list[Remembered]:
    """What stood before, the likeliest first; a record that was not there begins at rest at its first reading."""
    if task.known is not None:
        model = task.known.model if task.sprung else task.known.model.with_values({"stiffness": 0.0})
        return [(frozenset(model.effect_names), model, task.known.initial)]
    if earlier is None:
        return []

    def began(contender: CandidateModel, record: Record) -> Initial:
        for known, initial in zip(earlier.records, contender.initial, strict=True):
            if np.array_equal(known.time, record.time) and np.array_equal(known.position, record.position):
                return initial
        return Initial(0.0, 0.0, float(record.position[0]))

    return [
        (frozenset(one.causes), one.model, tuple(began(one, record) for record in task.records))
        for one in earlier.contenders[:KEPT]
        if one.causes
    ]


def result(experiment: Experiment, fitted: Hypothesis, shared: Shared) -> FitResult:
    """The model that is handed over: the set refitted by plain simulation error."""
    return summarise_fit(fitted.problem, handover.simulating(fitted, shared), floor(experiment))


def floor(experiment: Experiment) -> float:
    samples = sum(part.record.samples for part in experiment.readings)
    return math.sqrt(sum(part.record.samples * part.noise**2 for part in experiment.readings) / samples)
