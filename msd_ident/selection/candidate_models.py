"""The explanations that remain, as fitted models: the input for the design of the next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.residuals.noise_model import Readings
from msd_ident.selection import rest_constraint
from msd_ident.selection.evidence import NoiseScale
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import LEADERS, NEAR, Ranking


@dataclass(frozen=True)
class CandidateModel:
    """One explanation with its fitted model and what the data says about its parameters.

    Attributes:
        causes: sorted names of its causes; none for the base model.
        probability: given the data, among all sets that were fitted, lowered as its causes are.
        evidence: log evidence [nats], prior included; only differences mean anything.
        chi: sum of squares that it leaves, in units of the noise.
        model: fitted.
        free: names of the model's parameters that were fitted.
        scale: (p,) natural size of each free parameter.
        information: (p, p) information matrix of the free parameters, the entries of single records eliminated.
        initial: state and zero of each record at its first sample.
        variance: of the error of the best set's laws along its features (``evidence.NoiseScale``), in units of the
            noise's; 1 where they leave only noise.
    """

    causes: tuple[str, ...]
    probability: float
    evidence: float
    chi: float
    model: Model
    free: tuple[str, ...]
    scale: FloatArray
    information: FloatArray
    initial: tuple[Initial, ...]
    variance: float = 1.0


def of_ranking(ranking: Ranking, scale: NoiseScale, readings: Sequence[Readings]) -> tuple[CandidateModel, ...]:
    """The explanations from which the next experiment is designed: the leading one, then the next likely.

    Args:
        ranking: all its sets within half of ``NEAR`` of the best are included, and its leading set in any case.
        scale: variance in which the information about the parameters is stated.
        readings: the records with their weights.

    Returns:
        At most ``LEADERS``.
    """
    top = max(ranking.evidence)
    found = []
    for fitted, value in zip(ranking.sets, ranking.evidence, strict=True):
        if fitted is ranking.best or value >= top - 0.5 * NEAR:
            found.append(_contender(fitted, value, ranking.stated(fitted.causes), (scale, readings)))
    return tuple(found[:LEADERS])


def _contender(
    fitted: Hypothesis, evidence: float, probability: float, data: tuple[NoiseScale, Sequence[Readings]]
) -> CandidateModel:
    scale, readings = data
    count = len(fitted.problem.free)
    fitted = rest_constraint.constrained(fitted, readings, rest_constraint.rest_constraints(fitted))
    known = fitted.problem.balances
    information = fitted.information + rest_constraint.information(fitted.problem, fitted.point, known)
    return CandidateModel(
        causes=tuple(sorted(fitted.causes)),
        probability=probability,
        evidence=evidence,
        chi=fitted.chi,
        model=fitted.model,
        free=fitted.problem.names[:count],
        scale=fitted.problem.scale[:count],
        information=scale.informed(marginal(information, count)),
        initial=fitted.initial,
        variance=scale.variance,
    )


def marginal(information: FloatArray, count: int) -> FloatArray:
    """Information about some parameters when all others are unknown (Schur complement).

    Args:
        information: (p, p) information matrix.
        count: number of parameters to keep, the first ones.

    Returns:
        (count, count), without a direction about which less than nothing is known: rounding may leave one where a
        plant is unstable, whose readings grow without bound with its initial state.
    """
    rest = information[count:, count:]
    cross = information[:count, count:]
    about = np.asarray(information[:count, :count] - cross @ np.linalg.pinv(rest, hermitian=True) @ cross.T)
    known = np.diag(about) > 0.0
    size = np.sqrt(np.where(known, np.diag(about), 1.0))
    values, vectors = np.linalg.eigh(np.where(np.outer(known, known), about, 0.0) / np.outer(size, size))
    if np.all(known) and values[0] >= 0.0:
        return about
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T * np.outer(size, size))
