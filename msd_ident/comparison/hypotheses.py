"""Which parameters differ, and with what: the group, or something else that differed between the records.

The estimates θ of record r are taken as

    θ_rp = µ_p + Σ_c β_pc x_rc + ε_r,    ε_r ~ N(0, C_r + diag τ²),

with the fit's own covariance C_r and the scatter τ between records of one group that no covariate explains. A factor c
is the group (one column for each but the first) or a covariate: a temperature in steps of 20 K, the logarithm of a load
or of an amplitude. A hypothesis says which β are not zero; β ~ N(0, (10 % of θ)²). Its evidence is exact, for all is
normal. It is that of a joint fit in which the records share what does not differ, to second order in the parameters;
``joint`` makes that fit for the leading hypotheses. All hypotheses within reach of the best are looked at (Occam's
window, Madigan and Raftery 1994, J. Am. Stat. Assoc. 89).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from msd_ident.comparison.estimates import Estimate
from msd_ident.data.record import FloatArray

#: Size of a difference before any data, as a part of the parameter, and the odds that there is one.
SIZE, ODDS = 0.1, 0.05
#: Evidence [nats] below the best from which a hypothesis is looked further from.
_WINDOW = 8.0
#: Hypotheses that are looked at, at most.
_MOST = 20_000
GROUP = "group"
#: Covariates: the step that may change a parameter as much as another robot does, and the range that counts as none.
#: A step of 1 is one of the logarithm.
_STEPS = {"amplitude": (1.0, 0.05), "temperature": (20.0, 0.5), "load": (1.0, 0.02)}

#: Pairs of a parameter and the factor that it differs with.
Hypothesis = frozenset[tuple[str, str]]


@dataclass(frozen=True)
class Design:
    """Estimates and what they may depend on.

    Attributes:
        names: (p,) parameters.
        groups: names of the groups, the first is the one that the others are compared with.
        values: (r, p) relative to ``reference``.
        covariances: (r, p, p), relative likewise, repeatability included.
        columns: factor → (r, c) columns.
        reference: (p,) what a relative difference of 1 is.
        repeatability: (p,) relative scatter τ between records of one group; NaN where there is no second one.
    """

    names: tuple[str, ...]
    groups: tuple[str, ...]
    values: FloatArray
    covariances: FloatArray
    columns: Mapping[str, FloatArray]
    reference: FloatArray
    repeatability: FloatArray

    @cached_property
    def sums(self) -> tuple[FloatArray, FloatArray, dict[tuple[str, str], list[int]]]:
        """Information matrix and vector of all coefficients, and the places of those of each pair."""
        size = len(self.names)
        blocks = {"": np.ones((len(self.values), 1)), **self.columns}
        places, rows, at = {}, [], 0
        for factor, columns in blocks.items():
            for p, name in enumerate(self.names):
                places[name, factor] = list(range(at, at + columns.shape[1]))
                for column in columns.T:
                    row = np.zeros((len(self.values), size))
                    row[:, p] = column
                    rows.append(row)
                at += columns.shape[1]
        design = np.array(rows)  # (k, r, p)
        information = np.linalg.inv(self.covariances)
        weighted = np.einsum("krp,rpq->krq", design, information)
        matrix = np.einsum("krq,jrq->kj", weighted, design)
        vector = np.einsum("krq,rq->k", weighted, self.values)
        return matrix, vector, places

    def log_evidence(self, hypothesis: Hypothesis) -> float:
        """Log evidence [nats] but for a constant, prior odds included."""
        matrix, vector, places = self.sums
        shared = [place for name in self.names for place in places[name, ""]]
        own = [place for pair in sorted(hypothesis) for place in places[pair]]
        keep = shared + own
        prior = np.concatenate((np.full(len(shared), 1e-6), np.full(len(own), SIZE**-2)))
        total = matrix[np.ix_(keep, keep)] + np.diag(prior)
        gain = 0.5 * float(vector[keep] @ np.linalg.solve(total, vector[keep]))
        size = 1.0 / np.sqrt(np.diag(total))
        occam = 0.5 * (float(np.linalg.slogdet(total * np.outer(size, size))[1]) - 2.0 * float(np.log(size).sum()))
        return gain - occam + 0.5 * float(np.log(prior).sum()) + len(hypothesis) * math.log(ODDS)

    def coefficients(self, hypothesis: Hypothesis) -> dict[tuple[str, str], tuple[FloatArray, FloatArray]]:
        """Differences of each pair and their standard deviations under a hypothesis, relative to the first group."""
        matrix, vector, places = self.sums
        keep = [place for name in self.names for place in places[name, ""]]
        keep += [place for pair in sorted(hypothesis) for place in places[pair]]
        prior = np.where(np.arange(len(keep)) < len(self.names), 1e-6, SIZE**-2)
        inverse = np.linalg.inv(matrix[np.ix_(keep, keep)] + np.diag(prior))
        mean, std = inverse @ vector[keep], np.sqrt(np.diag(inverse))
        at = {place: i for i, place in enumerate(keep)}
        found = {}
        for pair in hypothesis:
            index = [at[place] for place in places[pair]]
            first = 1.0 + mean[at[places[pair[0], ""][0]]]  # values are about the reference
            found[pair] = (mean[index] / first, std[index] / abs(first))
        return found


@dataclass(frozen=True)
class Posterior:
    """Hypotheses by falling probability."""

    hypotheses: tuple[Hypothesis, ...]
    probabilities: tuple[float, ...]

    def of(self, *pairs: tuple[str, str]) -> float:
        """Probability that at least one of the pairs holds."""
        weighted = zip(self.hypotheses, self.probabilities, strict=True)
        return min(sum(p for one, p in weighted if any(pair in one for pair in pairs)), 1.0)


def design(estimates: Sequence[Estimate], groups: Sequence[str]) -> Design:
    """The design of estimates that all have the same free parameters."""
    names = estimates[0].fit.free
    raw = np.array([one.values for one in estimates])
    spread = np.array([one.covariance for one in estimates])
    variance = np.array([np.diag(one) for one in spread])
    weight = 1.0 / variance
    mean = (raw * weight).sum(axis=0) / weight.sum(axis=0)
    reference = np.maximum(np.abs(mean), np.sqrt(variance.min(axis=0)))
    values, covariances = raw / reference, spread / np.outer(reference, reference)
    columns = {GROUP: np.array([[float(one.source.group == group) for group in groups[1:]] for one in estimates])}
    for name in _STEPS:
        column = _covariate(name, estimates)
        if column is not None:
            columns[name] = column
    tau = _repeatability(values, covariances, columns)
    covariances = covariances + np.array([np.diag(np.nan_to_num(tau) ** 2)] * len(values))
    return Design(names, tuple(groups), values - 1.0, covariances, columns, reference, tau)


def _covariate(name: str, estimates: Sequence[Estimate]) -> FloatArray | None:
    """A covariate in its steps, about its mean; ``None`` where a record lacks it or it does not vary."""
    values = np.array([one.source.covariates.get(name, math.nan) for one in estimates])
    if name != "temperature":
        values = np.log(np.where(values > 0.0, values, math.nan))
    step, still = _STEPS[name]
    if not np.all(np.isfinite(values)) or float(np.ptp(values)) < still:
        return None
    return np.asarray(((values - values.mean()) / step)[:, None])


def _repeatability(values: FloatArray, covariances: FloatArray, columns: Mapping[str, FloatArray]) -> FloatArray:
    """(p,) scatter between records beyond their own intervals and all factors, by moments (DerSimonian–Laird)."""
    matrix = np.hstack([np.ones((len(values), 1)), *columns.values()])
    freedom = len(values) - int(np.linalg.matrix_rank(matrix))
    if freedom < 1:
        return np.full(values.shape[1], math.nan)
    found = []
    for p in range(values.shape[1]):
        variance = covariances[:, p, p]
        root = 1.0 / np.sqrt(variance)
        basis = np.linalg.svd(matrix * root[:, None], full_matrices=True)[0][:, len(values) - freedom :]
        left = basis.T @ (values[:, p] * root)
        trace = float(np.sum((basis**2) / variance[:, None]))
        found.append(math.sqrt(max(float(left @ left) - freedom, 0.0) / max(trace, 1e-300)))
    return np.array(found)


def posterior(made: Design) -> Posterior:
    """All hypotheses within reach of the best one, with their probabilities."""
    pairs = [(name, factor) for name in made.names for factor in made.columns]
    empty: Hypothesis = frozenset()
    evidence: dict[Hypothesis, float] = {empty: made.log_evidence(empty)}
    fresh = [empty]
    while fresh and len(evidence) < _MOST:
        best = max(evidence.values())
        near = [one for one in fresh if evidence[one] > best - _WINDOW] or [max(fresh, key=lambda one: evidence[one])]
        fresh = []
        for one in near:
            for pair in pairs:
                other = one ^ {pair}
                if other not in evidence and _sparing(other):
                    evidence[other] = made.log_evidence(other)
                    fresh.append(other)
        if not any(evidence[one] > max(evidence.values()) - _WINDOW for one in fresh):
            break
    order = sorted(evidence, key=lambda one: -evidence[one])
    weights = np.exp(np.array([evidence[one] for one in order]) - evidence[order[0]])
    weights /= weights.sum()
    return Posterior(tuple(order), tuple(float(w) for w in weights))


def _sparing(hypothesis: Hypothesis) -> bool:
    """Whether no parameter differs with more than two things at once."""
    names = [name for name, _ in hypothesis]
    return all(names.count(name) <= 2 for name in names)
