"""How hard a profile may push: within the limits under every rival, the worst one included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.design.limits import Limits
from msd_ident.design.prediction import Prediction, Predictor, Sensing, grid
from msd_ident.design.profile import Profile

#: Part of the travel and of the speed that a design plans to use: no rival is exactly right.
MARGIN = 0.8
_TURNS = 4
#: A profile that needs less than this part of the force has no room.
_LEAST = 1e-3


def extremes(predictors: Sequence[Predictor], predictions: Sequence[Prediction]) -> tuple[float, float, float]:
    """Least and greatest reading from the start [m] and greatest speed [m/s], whichever rival is right."""
    spans = [p.span(one.draws) for one, p in zip(predictors, predictions, strict=True)]
    speed = max(float(np.max(p.speed)) for p in predictions)
    return min(low for low, _ in spans), max(high for _, high in spans), speed


def fitted_in(
    profile: Profile, predictors: Sequence[Predictor], limits: Limits, period: float, seen: Sensing
) -> Profile | None:
    """A profile of unit force made as strong as the limits allow under every rival; ``None`` when it has no room."""
    room = limits.force_room(*profile.extremes)
    if not np.isfinite(room):
        return profile  # no force at all
    factor = min(room, limits.reach)  # what is small on purpose stays small
    for _ in range(_TURNS):
        if factor < _LEAST * limits.reach:
            return None
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
