"""How well a profile distinguishes rivals: what is left of their difference when each refits its unknown parameters.

Rival A predicts the readings y_A, rival B the readings y_B with Jacobian J_B. If A is true, B's parameters will be
refitted to A's readings, held back only by what the measured data says about them (information P_B), so that what is
left in units of the noise is

    chi² = dᵀ W d − dᵀ W J_Bᵀ (J_B W J_Bᵀ + P_B)⁻¹ J_B W d,     d = y_A − y_B,

with W the weight of each reading over its noise squared. A's own parameters are not known exactly either: they are
drawn from what the data leaves (J_A enters d). With the Occam factors of the evidence (``selection.evidence``) this
gives the evidence that A will have over B, and how often it will be decisive: the log of a likelihood ratio has the
mean chi²/2 and the variance chi².
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from msd_ident.data.record import FloatArray
from msd_ident.design.prediction import DRAWS, NUISANCES, Grid, Prediction, Predictor, Sensing
from msd_ident.selection.ranking import DECISIVE
from msd_ident.tuning import fixed

_UNKNOWN = fixed(
    1e5,
    "accuracy",
    "standard deviation of a start position and a zero before any reading, in noise levels: a flat prior",
)


@dataclass(frozen=True)
class Discrimination:
    """How well a profile distinguishes r rivals.

    Attributes:
        chi: (r, r) mean chi² left when the row is true and the column refitted.
        decided: (r,) probability that each rival, if true, beats all others decisively.
        probability: of a decision, over the probabilities of the rivals.
    """

    chi: FloatArray
    decided: FloatArray
    probability: float

    def asked(self, truths: FloatArray) -> Discrimination:
        """The same with other probabilities (r,) of the rivals."""
        return replace(self, probability=float(truths @ self.decided / max(math.fsum(truths), 1e-300)))


def weights(prediction: Prediction, on: Grid, seen: Sensing) -> FloatArray:
    """Weights (n,) [1/m²] of the instants of a grid, for the samples that each stands for: weight over noise squared,
    and over the variance of what the laws leave, which counts in a new record as it does in the measured ones.

    Args:
        prediction: gives the speeds.
        on: the grid.
        seen: noise, encoder step and sample period of the rig.
    """
    return np.asarray(seen.weight(prediction.speed) * (on.each / (seen.variance * seen.noise**2)))


def prior(predictor: Predictor, noise: float) -> FloatArray:
    """Information (p + 2, p + 2) about a rival's parameters, start position and zero before the profile is played.

    Args:
        predictor: the rival; its p free parameters have the information from the measured data.
        noise: standard deviation of a reading [m], from which the large uncertainty of start position and zero follows.
    """
    count = predictor.point.size
    matrix = np.zeros((count + NUISANCES,) * 2)
    matrix[:count, :count] = predictor.precision
    matrix[count:, count:] = np.eye(NUISANCES) / (_UNKNOWN * noise) ** 2
    return matrix


@dataclass(frozen=True)
class Refit:
    """A linear refit of a rival, which removes a part of the difference between readings.

    Attributes:
        jacobian: (p + 2, n) of the rival.
        weight: (n,) weight over noise squared [1/m²].
        factor: lower Cholesky factor of its information after the profile, in units of ``size``.
        size: (p + 2,) roots of the diagonal of that information.
    """

    jacobian: FloatArray
    weight: FloatArray
    factor: FloatArray
    size: FloatArray

    def left(self, differences: FloatArray) -> FloatArray:
        """Weighted products (q, q) of differences (q, n) of readings, after the refit has removed what it can."""
        weighted = differences * self.weight
        hidden = (weighted @ self.jacobian.T) / self.size
        solved = np.linalg.solve(self.factor, hidden.T)
        return np.asarray(weighted @ differences.T - solved.T @ solved)


def refit(jacobian: FloatArray, weight: FloatArray, before: FloatArray) -> Refit:
    """Linear refit of a rival to readings.

    Args:
        jacobian: (p + 2, n) of the rival's readings with its free parameters, start position and zero.
        weight: (n,) weight over noise squared [1/m²].
        before: (p + 2, p + 2) information before the profile is played.
    """
    matrix = (jacobian * weight) @ jacobian.T + before
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += 1e-10
    return Refit(jacobian, weight, np.linalg.cholesky(scaled), size)


def occam(predictor: Predictor, information: FloatArray) -> float:
    """Logarithm of the share of the plausible parameter space that is left [nats]; below 0.

    Args:
        predictor: the rival, which gives the natural sizes of its p free parameters.
        information: (p, p) about these parameters.
    """
    scale = predictor.contender.scale
    matrix = information * np.outer(scale, scale)
    matrix[np.diag_indices_from(matrix)] += 1.0
    sign, value = np.linalg.slogdet(matrix)
    return -0.5 * float(value) if sign > 0 else 0.0


def sharpened(predictor: Predictor, prediction: Prediction, weight: FloatArray) -> FloatArray:
    """Information (p, p) about the free parameters after a profile, with unknown start position and zero.

    Args:
        predictor: the explanation, with its information from the measured data.
        prediction: its readings on the profile's grid, with their Jacobian.
        weight: (n,) weight over noise squared [1/m²].
    """
    rows = prediction.jacobian
    matrix = (rows * weight) @ rows.T
    count = predictor.point.size
    rest = matrix[count:, count:]
    cross = matrix[:count, count:]
    added = matrix[:count, :count] - cross @ np.linalg.pinv(rest, hermitian=True) @ cross.T
    return np.asarray(predictor.contender.information + added)


def discriminate(
    predictors: Sequence[Predictor],
    predictions: Sequence[Prediction],
    on: Grid,
    seen: Sensing,
    shares: FloatArray | None = None,
) -> Discrimination:
    """How well readings on a grid distinguish rivals; for their own probabilities see ``Discrimination.asked``.

    Args:
        predictors: the r rivals.
        predictions: of each, on the grid.
        on: the instants of the readings.
        seen: noise, encoder step and sample period of the rig.
        shares: (r, r) part of the chi² of a linear refit that a real refit leaves; 1 if None.
    """
    count = len(predictors)
    kept = np.ones((count, count)) if shares is None else shares
    loads = [weights(one, on, seen) for one in predictions]
    evidence = np.array([one.contender.evidence for one in predictors])
    share = np.array([_share(*one) for one in zip(predictors, predictions, loads, strict=True)])
    chi, decided = np.zeros((count, count)), np.zeros(count)
    for a, truth in enumerate(predictors):
        drawn = np.concatenate([np.ones((DRAWS, 1)), truth.draws], axis=1)
        lefts = np.empty((count, DRAWS))
        for b, rival in enumerate(predictors):
            rows = differences(predictions[a], predictions[b])
            left = refit(predictions[b].jacobian, loads[a], prior(rival, seen.noise)).left(rows)
            lefts[b] = kept[a, b] * np.maximum(np.einsum("si,ij,sj->s", drawn, left, drawn), 0.0)
        chi[a] = lefts.mean(axis=1)
        others = [b for b in range(count) if b != a]
        if not others:
            decided[a] = 1.0
            continue
        ahead = np.array([evidence[a] - evidence[b] + 0.5 * (lefts[b] - lefts[a]) for b in others])
        ahead += np.array([_ahead(share[a] - share[b], truth, predictors[b]) for b in others])[:, None]
        margins = (ahead - DECISIVE) / np.sqrt(lefts[others] + 1.0)
        decided[a] = float(np.mean(special.ndtr(margins.min(axis=0))))
    return Discrimination(chi, decided, math.nan)


def differences(true: Prediction, rival: Prediction) -> FloatArray:
    """Difference (1 + p, n) between the readings of two rivals, and its derivatives by the true one's free parameters.

    Args:
        true: prediction of the rival that is taken as true, with p free parameters.
        rival: prediction of the other one.
    """
    return np.concatenate([(true.position - rival.position)[None, :], true.jacobian[:-NUISANCES]])


def _share(predictor: Predictor, prediction: Prediction, weight: FloatArray) -> float:
    """Logarithm of the share of the parameter space that a profile leaves of what the data has left [nats]."""
    one = predictor.contender
    return occam(predictor, sharpened(predictor, prediction, weight)) - occam(predictor, one.information)


def _ahead(gain: float, true: Predictor, rival: Predictor) -> float:
    """What the shares of the parameter space add to the evidence of the true rival over another one [nats].

    Beside a special case of the true one it is nothing at most: a law that changes no reading wins nothing by them.
    """
    nested = set(rival.contender.model.effect_names) <= set(true.contender.model.effect_names)
    return min(gain, 0.0) if nested else gain
