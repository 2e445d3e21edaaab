"""Scaling of profiles so that every rival, the worst one included, stays within the limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import Record
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import Prediction, Predictor, Sensing, grid
from msd_ident.design.profile import Profile
from msd_ident.estimate.levels import BEYOND_DOUBT, MOST_OF, NATURAL_RANGE
from msd_ident.estimate.parameter_units import in_force_unit
from msd_ident.model.effects import saturation
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.tuning import tuned

MARGIN = tuned(
    0.8,
    unit="1",
    why="part of the travel and of the speed that a design plans to use: no rival is exactly right",
    chosen="by hand",
)
#: How much stronger an actuator may be below the forces that were measured: what is known of it is most of it.
_STRONGER = 1.0 / MOST_OF


def worst_case_actuator(lead: CandidateModel, records: Sequence[Record]) -> CandidateModel | None:
    """The explanation with an actuator that saturated at the measured force and is stronger below it.

    One amplitude of the force tells nothing about the gain at another, so no rival need contain this.

    Args:
        lead: the leading explanation.
        records: what was measured.

    Returns:
        None if forces below ``MOST_OF`` of the largest one were measured, if none was, or if the explanation has this
        effect.
    """
    limit = saturation()
    forces = np.abs(np.concatenate([record.force for record in records]))
    forces = forces[forces > 0.0]
    if limit is None or forces.size == 0 or forces.min() < MOST_OF * forces.max() or lead.model.has(limit.name):
        return None
    weaker = lead.model.with_values(in_force_unit(lead.model, 1.0 / _STRONGER))
    return replace(lead, model=weaker + limit.limited(float(forces.max()) / _STRONGER))


def extremes(predictors: Sequence[Predictor], predictions: Sequence[Prediction]) -> tuple[float, float, float]:
    """Least and greatest reading from the start [m] and greatest speed [m/s] over all rivals.

    Args:
        predictors: the rivals.
        predictions: of each.
    """
    spans = [p.span(one.draws) for one, p in zip(predictors, predictions, strict=True)]
    speed = max(float(np.max(p.speed)) for p in predictions)
    return min(low for low, _ in spans), max(high for _, high in spans), speed


def fitted_in(
    profile: Profile, predictors: Sequence[Predictor], limits: Limits, period: float, seen: Sensing
) -> Profile | None:
    """A profile of unit force, scaled up as far as the limits allow under every rival.

    Args:
        profile: of unit force.
        predictors: the rivals, and models that must be safe too.
        limits: force, travel and speed of the rig; a margin of travel and speed is kept.
        period: of the plant [s].
        seen: noise, encoder step and sample period of the rig.

    Returns:
        None if no useful force fits, or if the profile has no force and no rival moves by itself.
    """
    room = limits.force_room(*profile.extremes)
    if not np.isfinite(room):  # no force at all: worth playing where some rival moves by itself
        rest = grid(profile, period, seen).record
        moves = any(float(np.ptp(one.positions(rest))) > BEYOND_DOUBT * seen.noise for one in predictors)
        return profile if moves else None
    factor = min(room, limits.reach)  # what is small on purpose stays small
    while factor >= 1.0 / NATURAL_RANGE * limits.reach:  # it falls by a fiftieth each time, or more
        strong = profile.scaled(factor)
        on = grid(strong, period, seen)
        room = np.inf
        for one in predictors:
            position = one.positions(on.record)
            start = position[0]
            speed = float(np.max(np.abs(np.gradient(position, on.record.time))))
            room = min(room, limits.room(float(position.min() - start), float(position.max() - start)))
            room = min(room, limits.speed / max(speed, 1e-300))
        room *= MARGIN
        if room >= 1.0:
            return strong
        factor *= 0.98 * room
    return None
