"""The profile that gives the smallest expected intervals of some parameters.

After a profile the parameters' information matrix is that of the measured data plus Jᵀ W J of the readings to come
(``discrimination.sharpened``); its inverse is the expected covariance. Of the family, the profile with the smallest
product of the standard deviations asked for is taken (D-optimal in them).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_ident import seeds
from msd_ident.data.record import FloatArray
from msd_ident.design import discrimination, safety
from msd_ident.design.evaluation import Option, Question, family_of, options
from msd_ident.design.hidden_effects import beside
from msd_ident.design.library import levels
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import Predictor, sensing
from msd_ident.design.profile import Profile, Segment
from msd_ident.design.profile_file import to_tree
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import UsageError
from msd_ident.estimate.effort import THOROUGH
from msd_ident.estimate.levels import TWO_SIDED
from msd_ident.model.base_model import FRICTION_FORCE, DryFriction
from msd_ident.paper.refinement import GRAVITY
from msd_ident.selection.candidate_models import CandidateModel

_FRICTION = "friction_coefficient"
_NEEDS = {_FRICTION: FRICTION_FORCE, "natural_frequency": "stiffness", "damping_ratio": "stiffness"}


@dataclass(frozen=True)
class Sharpened:
    """A profile that reduces the intervals of parameters.

    Attributes:
        profile: to be played.
        values: of the parameters asked for.
        now, after: half the 95 % interval of each, before and after the profile.
        step, random: the same after a single step, and after random steps, of the same duration.
        travel: least and greatest reading from the start [m].
        peak_speed: [m/s].
        sentence: what to do and what it gives.
    """

    profile: Profile
    values: Mapping[str, float]
    now: Mapping[str, float]
    after: Mapping[str, float]
    step: Mapping[str, float]
    random: Mapping[str, float]
    travel: tuple[float, float]
    peak_speed: float
    sentence: str

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "sentence": self.sentence,
            "duration_s": self.profile.duration,
            "expected": {
                name: {
                    "value": self.values[name], "half_interval_now": self.now[name],
                    "half_interval_after": self.after[name], "after_single_step": self.step[name],
                    "after_random_steps": self.random[name],
                } for name in self.values
            },
            "travel_m": list(self.travel),
            "peak_speed_m_s": self.peak_speed,
            "profile": to_tree(self.profile),
        }  # fmt: skip


def sharpen(diagnosis: Diagnosis, targets: Sequence[str], limits: Limits) -> Sharpened:
    """The profile within the limits that most reduces the intervals of some parameters.

    Args:
        diagnosis: its leading explanation is the model.
        targets: names of its parameters, or ``friction_coefficient``, ``natural_frequency`` or ``damping_ratio``.
        limits: what the rig allows.

    Raises:
        UsageError: a name that the model does not know, or limits without room.
    """
    seen = sensing(diagnosis.records, diagnosis.noise_floor)
    model = _knowing(diagnosis, targets)
    question = Question.of((model,), (1.0,), seen, limits, diagnosis.records)
    predictor = question.predictors[0]
    found = options(question, [p for p in family_of(question) if p.duration > 0.2 * limits.duration])
    if not found:
        raise limits.no_room(diagnosis.records[0].force_unit, diagnosis.records[0].position_unit)
    rated = [(_spread(question, one, targets), one) for one in found]
    stds, best = min(rated, key=lambda pair: float(np.sum(np.log(pair[0]))))
    step, random = (_rated(question, unit, targets) for unit in compared(best.profile.duration, question.period))
    values = dict(zip(targets, _values(predictor, predictor.point, targets), strict=True))
    now = _half(targets, _std(predictor, predictor.precision, targets))
    after, beside_step, beside_random = (_half(targets, one) for one in (stds, step, random))
    low, high, speed = safety.extremes(question.predictors, best.grid.record)
    return Sharpened(
        best.profile, values, now, after, beside_step, beside_random, (low, high), speed,
        _sentence(best, values, (now, after, beside_step)),
    )  # fmt: skip


def compared(duration: float, period: float) -> tuple[Profile, Profile]:
    """A single step and random steps, of unit force, to compare a design with.

    Args:
        duration: of each profile [s].
        period: of the plant [s]; it sets the rest at the start and the number of random steps.
    """
    rest = min(max(0.25 * period, 0.1), 0.2 * duration)
    lead = Segment("hold", rest)
    step = Profile((lead, Segment("step", duration - rest, force=1.0)), "single step")
    rng = np.random.default_rng(seeds.RANDOM_STEPS)
    count = min(max(int((duration - rest) / (0.5 * period)), 2), THOROUGH)
    random = levels(tuple(float(v) for v in rng.uniform(-1.0, 1.0, count)), (duration - rest) / count)
    return step, Profile((lead, *random), "random steps")


def _knowing(diagnosis: Diagnosis, targets: Sequence[str]) -> CandidateModel:
    """The explanation that stands, with friction beside it where friction is asked for."""
    if not diagnosis.contenders or not targets:
        raise UsageError("no parameter to sharpen; expected names such as mass,friction_coefficient")
    lead = diagnosis.contenders[0]
    wanted = {_NEEDS.get(name, name) for name in targets}
    if FRICTION_FORCE in wanted and FRICTION_FORCE not in lead.model.names:
        force = max(float(np.max(np.abs(record.force))) for record in diagnosis.records)
        lead = beside(diagnosis, DryFriction(1e-3 * force))
    unknown = sorted(wanted - set(lead.free))
    if unknown:
        known = ", ".join((*lead.free, *(name for name, need in _NEEDS.items() if need in lead.free)))
        raise UsageError(f"no parameter {unknown[0]!r} to sharpen; this model has {known}")
    return lead


def _values(predictor: Predictor, point: FloatArray, targets: Sequence[str]) -> list[float]:
    model = predictor.contender.model
    named = dict(zip(model.names, model.values.tolist(), strict=True))
    named |= dict(zip(predictor.contender.free, point.tolist(), strict=True))
    mass, damping, stiffness = (named[name] for name in ("mass", "damping", "stiffness"))
    if _FRICTION in targets:
        named[_FRICTION] = named[FRICTION_FORCE] / (mass * GRAVITY)
    if stiffness > 0.0:
        named["natural_frequency"] = math.sqrt(stiffness / mass)
        named["damping_ratio"] = 0.5 * damping / math.sqrt(stiffness * mass)
    return [named[name] for name in targets]


def _std(predictor: Predictor, information: FloatArray, targets: Sequence[str]) -> FloatArray:
    """Standard deviations of the targets, first order."""
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    covariance = np.linalg.pinv(information / np.outer(size, size), rcond=1e-13, hermitian=True) / np.outer(size, size)
    base = np.array(_values(predictor, predictor.point, targets))
    slopes = np.empty((len(targets), predictor.point.size))
    for i, value in enumerate(predictor.point):
        step = 1e-6 * (abs(value) or predictor.contender.scale[i])
        moved = predictor.point.copy()
        moved[i] += step
        slopes[:, i] = (np.array(_values(predictor, moved, targets)) - base) / step
    return np.asarray(np.sqrt(np.maximum(np.einsum("ti,ij,tj->t", slopes, covariance, slopes), 1e-300)))


def _spread(question: Question, option: Option, targets: Sequence[str]) -> FloatArray:
    predictor, prediction = question.predictors[0], option.predictions[0]
    weight = discrimination.weights(prediction, option.grid, question.sensing)
    after = discrimination.sharpened(predictor, prediction, weight)
    return _std(predictor, after + np.diag(predictor.contender.scale**-2.0), targets)


def _rated(question: Question, unit: Profile, targets: Sequence[str]) -> FloatArray:
    found = options(question, [unit])
    return _spread(question, found[0], targets) if found else np.full(len(targets), math.nan)


def _half(targets: Sequence[str], stds: FloatArray) -> dict[str, float]:
    return {name: TWO_SIDED * float(std) for name, std in zip(targets, stds, strict=True)}


def _sentence(best: Option, values: Mapping[str, float], intervals: Sequence[Mapping[str, float]]) -> str:
    now, after, step = intervals
    told = "; ".join(
        f"{name} {value:.4g} ± {after[name]:.2g} (now ± {now[name]:.2g}, after one step as long ± {step[name]:.2g})"
        for name, value in values.items()
    )
    low, high = best.profile.extremes
    return (
        f"Play {best.profile.name!r} for {best.profile.duration:.1f} s with {low:.3g} to {high:.3g} "
        f"{best.profile.unit}; expect {told}."
    )
