"""Real (nonlinear) refits of rivals to each other's readings, held back by what the measured data says about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.design.discrimination import prior, refit, weights
from msd_ident.design.prediction import NUISANCES, Grid, Prediction, Predictor, Sensing
from msd_ident.estimate.effort import SHORT
from msd_ident.estimate.levels import NEGLIGIBLE
from msd_ident.parallel import each


@dataclass(frozen=True)
class Refitted:
    """Rival B refitted to A's readings.

    Attributes:
        chi: weighted sum of squares that is left, the change of B's parameters against the measured data included.
        true: (n,) readings of A [m].
        rival: (n,) readings of B after the refit [m].
        simulated: readings that the refit took.
    """

    chi: float
    true: FloatArray
    rival: FloatArray
    simulated: int

    @property
    def difference(self) -> FloatArray:
        """(n,) of the readings [m]."""
        return np.asarray(self.true - self.rival)


def refitted(rival: Predictor, own: Prediction, true: Prediction, on: Grid, seen: Sensing) -> Refitted:
    """Refit of a rival's parameters, start position and zero to another one's readings, by Levenberg–Marquardt.

    Args:
        rival: the rival; the measured data holds its parameters back.
        own: its prediction before the refit.
        true: prediction of the one that is taken as true.
        on: the instants.
        seen: noise, encoder step and sample period of the rig.
    """
    weight = weights(true, on, seen)
    before = prior(rival, seen.noise)
    origin = np.concatenate([rival.point, [rival.start.position, rival.start.zero]])
    lower, upper = _bounds(rival)
    point, readings, jacobian = origin.copy(), own.position, own.jacobian
    cost, damping = _cost(readings, true, weight, point - origin, before), 1e-6
    simulated = 0
    for _ in range(SHORT):
        normal = (jacobian * weight) @ jacobian.T + before
        slope = (jacobian * weight) @ (true.position - readings) - before @ (point - origin)
        size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        scaled = normal / np.outer(size, size) + max(damping, 1e-12) * np.eye(size.size)
        ahead = np.clip(point + np.linalg.solve(scaled, slope / size) / size, lower, upper)
        free, start = ahead[:-NUISANCES], ahead[-NUISANCES:]
        reading = rival.readings(on.record, free[None, :], start[None, :])[0]
        simulated += reading.size
        reached = _cost(reading, true, weight, ahead - origin, before)
        if reached >= cost:
            damping = max(10.0 * damping, 1e-3)
            continue
        settled = cost - reached < NEGLIGIBLE * reached + 0.01
        point, readings, cost, damping = ahead, reading, reached, 0.1 * damping
        if settled:
            break
        _, jacobian = rival.linearised(on.record, free, start)
        simulated += point.size * reading.size
    return Refitted(cost, true.position, readings, simulated)


def _bounds(rival: Predictor) -> tuple[FloatArray, FloatArray]:
    lower = [-np.inf] * (rival.point.size + NUISANCES)
    upper = [np.inf] * (rival.point.size + NUISANCES)
    for i, place in enumerate(rival.places):
        parameter = rival.contender.model.parameters[place]
        lower[i], upper[i] = parameter.lower, parameter.upper
        if parameter.name in ("mass", "stiffness"):
            lower[i] = 0.2 * float(rival.point[i])
    return np.array(lower), np.array(upper)


def _cost(readings: FloatArray, true: Prediction, weight: FloatArray, moved: FloatArray, before: FloatArray) -> float:
    return float(weight @ (true.position - readings) ** 2 + moved @ before @ moved)


def shares(
    predictors: Sequence[Predictor], predictions: Sequence[Prediction], on: Grid, seen: Sensing
) -> tuple[FloatArray, list[list[Refitted | None]]]:
    """Refits of every rival to every other one's readings.

    Args:
        predictors: the r rivals.
        predictions: of each, on the grid.
        on: the instants.
        seen: noise, encoder step and sample period of the rig.

    Returns:
        (r, r) part of the chi² of a linear refit that the real one leaves (at most 1), the row true and the column
        refitted; and the refits.
    """
    count = len(predictors)
    kept = np.ones((count, count))
    found: list[list[Refitted | None]] = [[None] * count for _ in range(count)]
    weighed = [weights(true, on, seen) for true in predictions]

    def part(pair: tuple[int, int]) -> tuple[Refitted, float]:
        a, b = pair
        rival, own, true = predictors[b], predictions[b], predictions[a]
        done = refitted(rival, own, true, on, seen)
        linear = refit(own.jacobian, weighed[a], prior(rival, seen.noise)).left((true.position - own.position)[None, :])
        return done, float(np.clip(done.chi / max(float(linear[0, 0]), 1e-9), 0.0, 1.0))

    pairs = [(a, b) for a in range(count) for b in range(count) if a != b]
    for (a, b), (done, share) in zip(pairs, each(part, pairs), strict=True):
        found[a][b], kept[a, b] = done, share
    return kept, found
