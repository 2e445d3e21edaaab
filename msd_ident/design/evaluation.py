"""Evaluation of profiles: scaled to the limits, predicted by every rival, and compared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.special import expit

from msd_ident.data.record import FloatArray, Record
from msd_ident.design import discrimination, safety
from msd_ident.design.discrimination import Discrimination
from msd_ident.design.library import TimeScale, family
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import NUISANCES, Grid, Prediction, Predictor, Sensing, grid, instants
from msd_ident.design.profile import Profile
from msd_ident.estimate.levels import NEGLIGIBLE
from msd_ident.parallel import each
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.excitation import poor
from msd_ident.selection.ranking import DECISIVE, LEADERS

#: Probability of a decision that is as good as certain: of the profiles that have it, the shortest is taken.
ENOUGH = float(expit(DECISIVE))


@dataclass(frozen=True)
class Option:
    """A profile, the readings that each of r rivals predicts for it, and how well it distinguishes them.

    Attributes:
        profile: scaled to the limits.
        grid: instants of the predictions.
        predictions: of each rival.
        parting: how well the profile distinguishes the rivals.
        shares: (r, r) part of the chi² of a linear refit that a real refit leaves; 1 where no real refit was made.
    """

    profile: Profile
    grid: Grid
    predictions: tuple[Prediction, ...]
    parting: Discrimination
    shares: FloatArray

    @property
    def probability(self) -> float:
        """Probability of a decision."""
        return self.parting.probability

    @property
    def strength(self) -> float:
        """Mean log chi² between each rival that is found out in half of the cases or more and the one closest to it."""
        chi = self.parting.chi + np.diag(np.full(len(self.parting.chi), np.inf))
        found_out = self.parting.decided >= 0.5
        return float(np.log(np.maximum(chi[found_out].min(axis=1), 1e-9)).mean()) if found_out.any() else -np.inf


@dataclass(frozen=True)
class Question:
    """What is to be decided, on which rig.

    Attributes:
        predictors: the r rivals.
        truths: (r,) probability of each.
        sensing: noise, encoder step and sample period of the rig.
        limits: what the rig allows.
        period: the plant's period [s].
        cautions: models that are no rivals, but under which a profile must stay within the limits too.
    """

    predictors: tuple[Predictor, ...]
    truths: FloatArray
    sensing: Sensing
    limits: Limits
    period: float
    cautions: tuple[Predictor, ...] = ()

    @staticmethod
    def of(
        contenders: Sequence[CandidateModel], truths: Sequence[float], seen: Sensing, limits: Limits,
        records: Sequence[Record] = (),
    ) -> Question:  # fmt: skip
        """The question which of several explanations is true.

        Args:
            contenders: the explanations, the leading one first.
            truths: probability of each.
            seen: noise, encoder step and sample period of the rig.
            limits: what the rig allows.
            records: what was measured; with them, profiles must be safe for an actuator that saturated there too.
        """
        predictors = tuple(Predictor(one, 10.0 * seen.noise) for one in contenders)
        stronger = safety.worst_case_actuator(contenders[0], records) if records else None
        cautions = () if stronger is None else (Predictor(stronger, 10.0 * seen.noise),)
        return Question(predictors, np.asarray(truths), seen, limits, period_of(contenders[0], limits), cautions)

    @property
    def contenders(self) -> tuple[CandidateModel, ...]:
        """The rivals."""
        return tuple(one.contender for one in self.predictors)

    def work(self, profile: Profile) -> float:
        """Readings that must be simulated to predict a profile by every rival, with its Jacobian and its draws."""
        rows = sum(1 + len(one.places) + NUISANCES for one in self.predictors)
        rows += (1 + LEADERS) * (len(self.predictors) + len(self.cautions))
        return float(rows * instants(profile, self.period, self.sensing))


def period_of(contender: CandidateModel, limits: Limits) -> float:
    """Period of the plant [s]; without a spring twice m/b, or a tenth of the longest experiment if that is shorter.

    Args:
        contender: gives mass, damping and stiffness.
        limits: give the longest experiment.
    """
    model = contender.model
    if model.stiffness > 0.0:
        return 2.0 * math.pi * math.sqrt(model.mass / model.stiffness)
    decay = model.mass / model.damping if model.damping > 0.0 else math.inf
    return min(2.0 * decay, limits.duration / 10.0)


def options(question: Question, profiles: Sequence[Profile]) -> list[Option]:
    """Profiles that fit within the limits, scaled to them and evaluated.

    Args:
        question: rivals and limits.
        profiles: of unit force; those that do not fit are left out.
    """
    return [found for found in each(partial(_option, question), profiles) if found is not None]


def family_of(question: Question, unit: str = "N") -> list[Profile]:
    """The family of profiles for a plant, the shortest first.

    Args:
        question: gives the plant's period and the longest experiment.
        unit: of the force.
    """
    made = family(TimeScale(question.period, question.limits.duration), unit)
    return sorted(made, key=lambda profile: profile.duration)


def exciting(
    question: Question, profiles: Sequence[Profile], records: Sequence[Record]
) -> tuple[list[Profile], list[Profile]]:
    """The profiles that excite more than one kind of motion, together with what was measured, and the other ones.

    Without that no cause is certain, whatever a profile shows (``selection.excitation``).

    Args:
        question: gives the plant's period.
        profiles: to choose from.
        records: what was measured.
    """
    rich: list[Profile] = []
    plain: list[Profile] = []
    for profile in profiles:
        played = grid(profile, question.period, question.sensing).record
        (plain if poor([*records, played], question.period) else rich).append(profile)
    return rich, plain


def choose(found: Sequence[Option]) -> Option | None:
    """The shortest of the profiles that decide as well as the best one, or well enough."""
    if not found:
        return None
    best = max(one.probability for one in found)
    good = [one for one in found if one.probability >= min(best - NEGLIGIBLE, ENOUGH)]
    return min(good, key=lambda one: one.profile.duration)


def _option(question: Question, unit: Profile) -> Option | None:
    imagined = (*question.predictors, *question.cautions)
    strong = safety.fitted_in(unit, imagined, question.limits, question.period, question.sensing)
    return None if strong is None else judge(question, strong)


def judge(question: Question, profile: Profile) -> Option:
    """Predictions of the rivals for a profile, and how well it distinguishes them by linear refits.

    Args:
        question: the rivals with their probabilities.
        profile: as it would be played.
    """
    on = grid(profile, question.period, question.sensing)
    predictions = tuple(one.predict(on.record) for one in question.predictors)
    parting = discrimination.discriminate(question.predictors, predictions, on, question.sensing)
    parting = parting.asked(question.truths)
    return Option(profile, on, predictions, parting, np.ones_like(parting.chi))


def judge_again(question: Question, option: Option, kept: FloatArray) -> Option:
    """The option evaluated with real refits of the rivals.

    Args:
        question: the rivals with their probabilities.
        option: the option as ``judge`` gave it.
        kept: (r, r) part of the chi² of a linear refit that a real refit leaves (``rival_refits.shares``).
    """
    parting = discrimination.discriminate(
        question.predictors, option.predictions, option.grid, question.sensing, kept
    ).asked(question.truths)
    return replace(option, parting=parting, shares=kept)
