"""Scaling of profiles so that every rival, the worst one included, stays within the limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import DRAWS, Predictor, Sensing, grid
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


def extremes(predictors: Sequence[Predictor], on: Record) -> tuple[float, float, float]:
    """Least and greatest reading from the start [m] and greatest speed [m/s] over all rivals and all draws of what the
    data leaves of their parameters (``Predictor.drawn``).

    Args:
        predictors: the rivals.
        on: record with the profile's force.
    """
    reached = [_reached(one.drawn(on, DRAWS), on) for one in predictors]
    return min(low for low, _, _ in reached), max(high for _, high, _ in reached), max(fast for _, _, fast in reached)


def _reached(positions: FloatArray, on: Record) -> tuple[float, float, float]:
    """Least and greatest reading from the start [m] and greatest speed [m/s] of motions (q, n)."""
    away = positions - positions[:, :1]
    return float(away.min()), float(away.max()), float(np.max(np.abs(np.gradient(positions, on.time, axis=1))))


def _room(positions: FloatArray, on: Record, limits: Limits) -> float:
    """Factor by which motions (q, n) may still grow before one of them leaves the limits."""
    low, high, speed = _reached(positions, on)
    return min(limits.room(low, high), limits.speed / max(speed, 1e-300))


def fitted_in(
    profile: Profile, predictors: Sequence[Predictor], limits: Limits, period: float, seen: Sensing
) -> Profile | None:
    """A profile of unit force, scaled up as far as the limits allow under every rival, whatever the data leaves of its
    parameters.

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
        moved = [one.drawn(rest) for one in predictors]
        moves = any(float(np.ptp(positions[0])) > BEYOND_DOUBT * seen.noise for positions in moved)
        return profile if moves and all(_room(positions, rest, limits) >= 1.0 for positions in moved) else None
    factor = min(room, limits.reach)  # what is small on purpose stays small
    while factor >= 1.0 / NATURAL_RANGE * limits.reach:  # it falls by a fiftieth each time, or more
        strong = profile.scaled(factor)
        on = grid(strong, period, seen).record
        room = MARGIN * min(_room(one.positions(on)[None, :], on, limits) for one in predictors)
        if room >= 1.0:  # so it must be with other values too that the data leaves
            room = MARGIN * min(_room(one.drawn(on), on, limits) for one in predictors)
        if room >= 1.0:
            return strong
        factor *= 0.98 * room
    return None
