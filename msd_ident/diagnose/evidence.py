"""How strongly the data speaks for a set of causes, and what cannot be told from what.

The evidence of a set is Laplace's: its likelihood at the best parameters, times the share of the plausible parameter
space that the data leaves, det(I + S H S)^(-1/2), where H is the information matrix and S the natural size of each
parameter. A parameter that the data does not see costs nothing and gains nothing; one that it pins down must earn its
place. (MacKay 1992; Kass and Raftery 1995.)

Where even the best set leaves more than the noise, the model is wrong somehow, and no likelihood can be taken at its
word: chi² is then counted in units of what the best set leaves, and its correlated samples by how many are independent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from msd_ident.diagnose.candidates import Causes, Fitted
from msd_ident.diagnose.readings import Readings
from msd_ident.model.effects import by_name
from msd_ident.record import FloatArray

#: Odds, before any data, that a given cause acts.
PRIOR_ODDS = 1.0 / 20.0
#: Evidence [nats] below which one set is not decisively better than another: about 30 to 1.
DECISIVE = 3.5
#: Part of the sliding force by which a breakaway force must be larger for a law of its own: the parameters of a smaller
#: peak are seen by nothing, so they would cost nothing.
_NO_PEAK = 0.01
#: Sets whose residuals tell how errors are correlated.
_CLOSEST = 5


@dataclass(frozen=True)
class Scale:
    """How a likelihood is to be read: ``inflation`` (>= 1) of chi², and ``independence`` (0 to 1) of its pieces."""

    inflation: float = 1.0
    independence: float = 1.0
    pieces: float = math.inf

    def log_likelihood(self, chi: float) -> float:
        """Log likelihood but for a constant; with an unknown error scale it grows only as the logarithm."""
        if self.inflation <= 1.0:
            return -0.5 * chi
        return -0.5 * self.independence * self.pieces * math.log(max(chi, 1e-300) / self.pieces)

    def informed(self, information: FloatArray) -> FloatArray:
        """The information matrix in this scale."""
        return information * (self.independence / self.inflation)


def scale_from(sets: Sequence[Fitted], readings: Sequence[Readings]) -> Scale:
    """The scale that the residuals of the closest sets suggest.

    How many pieces are independent is read off several of them: one may happen to leave nothing but a slow drift, and
    would make the others' swings count for nothing.
    """
    closest = sorted(sets, key=lambda fitted: fitted.chi)[:_CLOSEST]
    pieces = sum(part.evidence for part in readings)
    inflation = closest[0].chi / pieces
    # A few per cent above the noise may be the noise floor's own error; beyond that the model is at fault.
    if inflation < 1.0 + 5.0 * math.sqrt(2.0 / pieces) + 0.05:
        return Scale(1.0, 1.0, pieces)
    return Scale(inflation, max(independence(fitted.residuals(), readings) for fitted in closest), pieces)


def independence(residuals: Sequence[FloatArray], readings: Sequence[Readings]) -> float:
    """Independent pieces of evidence for each piece that ``Readings`` counts, from the residual's correlation.

    One over the integrated autocorrelation time, summed up to the first lag at which the correlation is gone.
    """
    total, independent = 0.0, 0.0
    for residual, part in zip(residuals, readings, strict=True):
        values = part.by_run(residual)
        total += values.size
        independent += values.size / _correlation_time(values)
    return independent / total


def _correlation_time(values: FloatArray) -> float:
    count = values.size
    if count < 30 or not np.any(values):
        return 1.0
    spectrum = np.abs(np.fft.rfft(values, 2 * count)) ** 2
    correlation = np.fft.irfft(spectrum)[:count]
    correlation /= correlation[0]
    gone = np.flatnonzero(correlation < 0.05)
    return max(1.0 + 2.0 * float(correlation[1 : int(gone[0]) if gone.size else count].sum()), 1.0)


def log_evidence(fitted: Fitted, scale: Scale) -> float:
    """Log evidence [nats] of a set, prior included."""
    size = fitted.problem.scale
    information = scale.informed(fitted.information) * np.outer(size, size)
    information[np.diag_indices_from(information)] += 1.0
    sign, occam = np.linalg.slogdet(information)
    penalty = 0.5 * float(occam) if sign > 0 else 1e6
    return scale.log_likelihood(fitted.chi) - penalty + len(fitted.causes) * math.log(PRIOR_ODDS)


@dataclass(frozen=True)
class Ranking:
    """Sets by falling evidence, with their posterior probability (each in the order of ``sets``).

    ``left`` is what every set that was fitted leaves, in noise floors, those too that were searched on a part of the
    data alone.
    """

    sets: tuple[Fitted, ...]
    evidence: tuple[float, ...]
    probability: tuple[float, ...]
    left: Mapping[Causes, float] = field(default_factory=dict)

    @property
    def best(self) -> Fitted:
        """The leading set: of those that the data cannot tell from the likeliest, the simplest."""
        return self.sets[0]

    def led_by(self, leader: Fitted) -> Ranking:
        """The same with one of its sets first."""
        order = sorted(range(len(self.sets)), key=lambda i: self.sets[i] is not leader)
        return replace(
            self,
            sets=tuple(self.sets[i] for i in order),
            evidence=tuple(self.evidence[i] for i in order),
            probability=tuple(self.probability[i] for i in order),
        )

    def of_cause(self, name: str) -> float:
        """Probability that a cause acts: of all sets that hold it together."""
        return sum(p for fitted, p in zip(self.sets, self.probability, strict=True) if name in fitted.causes)

    def within(self, nats: float) -> list[Fitted]:
        """Sets whose evidence is not more than this below the leading one."""
        least = self.evidence[0] - nats
        return [fitted for fitted, value in zip(self.sets, self.evidence, strict=True) if value >= least]


def _same_as(fitted: Fitted) -> set[Causes]:
    """Simpler sets that the fitted model is: an effect ended without strength, or Stribeck's law without its peak."""
    model, found = fitted.model, set()
    for name in fitted.causes:
        if all(model[parameter] == value for parameter, value in by_name(name).neutral):
            found.add(fitted.causes - {name})
    if "stribeck_friction" in fitted.causes and model["static_force"] <= (1.0 + _NO_PEAK) * model["coulomb_force"]:
        found.add(fitted.causes - {"stribeck_friction"} | {"coulomb_friction"})
    return found


def _ceilings(
    causes: Causes, own: Mapping[Causes, float], sets: Mapping[Causes, Fitted], scale: Scale
) -> Iterator[float]:
    """What the evidence of a set cannot be more than: that of a smaller set, and what its likelihood is better by.

    The marginal likelihood of a larger model is an average of such values, over the further parameters. Laplace's
    determinant, taken where a law has a knee, may say otherwise.
    """
    for smaller, value in own.items():
        if smaller < causes:
            gain = scale.log_likelihood(sets[causes].chi) - scale.log_likelihood(sets[smaller].chi)
            yield value + max(gain, 0.0) + (len(causes) - len(smaller)) * math.log(PRIOR_ODDS)


def rank(sets: Mapping[Causes, Fitted], scale: Scale) -> Ranking:
    """All sets by evidence; the simplest of those within ``DECISIVE`` of the best is put first.

    A set that turned out to be a simpler one under another name is left out.
    """
    own = {causes: log_evidence(one, scale) for causes, one in sets.items() if not _same_as(one) & set(sets)}
    values = {causes: min([value, *_ceilings(causes, own, sets, scale)]) for causes, value in own.items()}
    order = sorted(values, key=lambda causes: -values[causes])
    top = values[order[0]]
    near = [causes for causes in order if values[causes] >= top - DECISIVE]
    first = min(near, key=lambda causes: (sets[causes].free_parameters, len(causes), -values[causes]))
    order.remove(first)
    order.insert(0, first)
    weights = np.exp(np.array([values[causes] for causes in order]) - top)
    weights /= weights.sum()
    return Ranking(
        tuple(sets[causes] for causes in order),
        tuple(values[causes] for causes in order),
        tuple(float(w) for w in weights),
    )


def alternatives(ranking: Ranking, name: str) -> tuple[str, ...]:
    """Causes that could stand for ``name`` in the leading set without the data objecting, likeliest first."""
    rest = ranking.best.causes - {name}
    found: list[str] = []
    for fitted in ranking.within(DECISIVE):
        if name in fitted.causes or not rest <= fitted.causes:
            continue
        for other in sorted(fitted.causes - rest):
            if other not in found:
                found.append(other)
    return tuple(found)
