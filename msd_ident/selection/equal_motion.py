"""Laws of another cause that give the same motion in the place of one of a set's: no evidence tells them apart."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from msd_ident.model.effects import LIBRARY, Effect
from msd_ident.model.effects.typical import speed
from msd_ident.residuals.noise_model import NOISE_ERROR
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.law_errors import leaves_noise


def equal_motion(
    fitted: Hypothesis, sets: Mapping[Causes, Hypothesis], experiment: Experiment, scale: NoiseScale
) -> dict[str, str]:
    """Laws of a set, each with a law of another cause that gives the same motion in its place, or of which it may be
    another form (``Effect.may_be``).

    The difference of the two motions, or of what the two leave where both were fitted, is less than what the set leaves
    above the noise, or so small that the records are not expected to show it (``NoiseScale.unseen``).

    Args:
        fitted: the set.
        sets: all fitted sets by their causes.
        experiment: readings with their weights.
        scale: of the likelihood.
    """
    others = ((effect, law.moving_as(effect, fitted.model)) for effect in fitted.model.effects for law in LIBRARY)
    most = max(fitted.chi - (1.0 + NOISE_ERROR) * scale.most, 0.0) + scale.unseen(fitted.chi)
    exact = leaves_noise(fitted, scale.noise)
    top, held = max(speed(record) for record in experiment.records), {one.cause() for one in fitted.model.effects}
    forms = {
        effect.name: cause
        for effect in fitted.model.effects
        for cause in [one for one in effect.may_be(top, exact and _alone(effect, fitted)) if one not in held][:1]
    }
    return forms | {
        effect.name: other.name
        for effect, other in others
        if other is not None and _least_change(fitted, effect, other, sets, experiment) < most
    }


def _alone(effect: Effect, fitted: Hypothesis) -> bool:
    """Whether no other law of a set is a curve over the speed as an effect is: two such curves come near any third one,
    so a set that leaves only noise with both does not show that either has its form.
    """
    others = (one for one in fitted.model.effects if one is not effect)
    return not (effect.is_curve_over_speed() and any(one.is_curve_over_speed() for one in others))


def _least_change(
    fitted: Hypothesis, effect: Effect, other: Effect, sets: Mapping[Causes, Hypothesis], experiment: Experiment
) -> float:
    """Chi² of the change of the motion when a law takes the place of an effect, as it is or fitted."""
    swapped = sets.get(fitted.causes - {effect.name} | {other.name})
    refitted = math.inf if swapped is None else abs(swapped.chi - fitted.chi)
    return min(refitted, _change(fitted, effect, other, experiment))


def _change(fitted: Hypothesis, effect: Effect, other: Effect, experiment: Experiment) -> float:
    """Chi² of the change of the motion with a law as it is in the place of an effect.

    Both without a law of the same cause as the new one, which a model holds once.
    """
    rest = tuple(one for one in fitted.model.effects if one is not effect and one.cause() != other.cause())
    motions = []
    for law in (effect, other):
        _, weighting, point = formulated(experiment, replace(fitted.model, effects=(*rest, law)), fitted.initial)
        motions.append(weighting.residual(point))
    change = motions[1] - motions[0]
    return float(change @ change)
