"""Evidence of a fitted set of causes.

No model of a real rig is exact, and what a model misses is not noise: the error of a law is the same in every swing. So
a record of a hundred swings holds not a hundred pieces of evidence about the shape of that error but a few. The
residual of a set is modelled as white noise plus an error of unknown shape, which lies, in each octave of frequency
(see ``residuals.octaves``), along ν unknown directions of the sample space. With the variance v of the residual along
these directions, in units of the noise, the log likelihood is a sum over the octaves o,

    −½ ν Σ log v_o + constant,    v_o = 1 + (χ²_o − N_o) / ν,    ν = OCTAVE_SHAPES.

Where a law is exact, χ² is that of N samples of noise, v is 1, and a set that leaves more loses ½ ν log v. Where no law
is exact, only the ratio of what two sets leave counts, and structure that repeats with the motion is counted once in
each octave. (A variance component with ν degrees of freedom in the place of the Gaussian process of Kennedy and O'Hagan
2001, J. R. Stat. Soc. B 63.) What a model moves while the cart stands still (``residuals.standstill``) is one octave
more.

The evidence of a set is Laplace's approximation: this likelihood at the best parameters, times the share of the
plausible space of its causes' parameters that the data leaves, det(I + S H S / v)^(-1/2). H is the information about
them with an unknown plant, S the prior width of each, and v the set's own variance along ``SHAPES`` directions of all
frequencies. A parameter that the data does not determine changes the evidence little; one that it determines sharply
lowers it, and must improve the likelihood by more. (MacKay 1992; Kass and Raftery 1995.) As no law is exact, no
parameter counts as known better than to a part of its prior width, however low the noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import MOST_OF, NATURAL_RANGE, SHAPES, TENTH
from msd_ident.model.effects import by_name
from msd_ident.residuals.noise_model import NOISE_ERROR, Readings
from msd_ident.residuals.noise_spectrum import NoiseSpectrum
from msd_ident.residuals.octaves import OCTAVE_SHAPES
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.tuning import tuned

LEAST_SPREAD = tuned(
    0.03, unit="1", why="part of its prior width that a parameter of a law is never known better than", chosen="by hand"
)


@dataclass(frozen=True)
class NoiseScale:
    """How the chi² of a set is turned into a likelihood.

    Attributes:
        noise: chi² that noise alone leaves; 0 if nobody knows.
        variance: v of the best set, in which information about parameters is stated.
        shapes: ν, the number of independent features of a model's error.
        pieces: pieces of evidence in the readings.
        spectrum: of the noise, where the best set leaves nothing else; None where it is taken as white.
    """

    noise: float = 0.0
    variance: float = 1.0
    shapes: float = SHAPES
    pieces: float = 0.0
    spectrum: NoiseSpectrum | None = None

    @property
    def other_noise(self) -> NoiseSpectrum | None:
        """The noise of the best set's residual, if it is more or less, or of another colour, than the readings told."""
        return self.spectrum if self.spectrum is not None and self.spectrum.differs else None

    @property
    def most(self) -> float:
        """Greatest chi² that noise alone may leave."""
        return self.noise or self.pieces

    def spread(self, chi: float) -> float:
        """Variance v of a model's error along its features, in units of the noise's."""
        return self._at_motion + max(chi - self.noise, 0.0) / self.shapes

    def unseen(self, chi: float) -> float:
        """Chi² of a difference d between two motions that records of this length are not expected to show.

        With the variance v of what the better one leaves, d²/(2 v) is the log likelihood ratio [nats] that is expected:
        less than ``TENTH``.

        Args:
            chi: sum of squares that the better one leaves.
        """
        return 2.0 * TENTH * self.spread(chi)

    @property
    def _at_motion(self) -> float:
        """Variance of the noise at the frequencies of the motion, where most parameters are seen."""
        return 1.0 if self.spectrum is None else self.spectrum.at_motion

    def log_likelihood(self, chi: float, stirred: float = 0.0) -> float:
        """Log likelihood [nats] of a set, except for a constant.

        Args:
            chi: sum of squares that the set leaves in motion, in units of the noise.
            stirred: the same at rest. It counts by itself, because a model's error in motion says nothing about its
                error at rest.
        """
        at_rest = 1.0 + stirred / self.shapes
        return -0.5 * self.shapes * (math.log(self.spread(chi)) + math.log(at_rest))

    def of(self, fitted: Hypothesis) -> float:
        """Log likelihood [nats] of a fitted set, octave by octave, but for a constant."""
        # The set keeps the spectrum too, so that no other one gets its identity.
        key = ("likelihood", self.noise, self.shapes, id(self.spectrum))
        return fitted.kept(key, lambda: (self._of(fitted), self.spectrum))[0]

    def _of(self, fitted: Hypothesis) -> float:
        if self.spectrum is None:
            white = np.sum([part.evidence * part.octaves.share for part in fitted.readings], axis=0)
            excess = np.maximum(fitted.octaves - white * (self.noise / float(white.sum())), 0.0)
        else:
            excess = np.maximum(fitted.octaves - self.spectrum.left, 0.0) / self.spectrum.size
        features = OCTAVE_SHAPES * self.shapes / SHAPES
        counted = np.append(excess, fitted.creeping)
        bands = -0.5 * features * float(np.sum(np.log1p(counted / features)))
        return bands + self.log_likelihood(self.noise, fitted.stirred)

    def informed(self, information: FloatArray) -> FloatArray:
        """The information matrix in this scale."""
        return information / self.variance


def scale_from(sets: Sequence[Hypothesis], readings: Sequence[Readings], shapes: float = SHAPES) -> NoiseScale:
    """The noise scale of an experiment.

    Where the best set leaves nothing but noise of some level and colour (``residuals.noise_spectrum``), this is the
    noise. If not, the chi² of the noise is the number of pieces of evidence; where the best set leaves little more than
    that, or less, it is the chi² of that set. Where the best set leaves less than half of it, the noise is
    overestimated and counts as unknown (0).

    Args:
        sets: fitted sets.
        readings: the records with their weights.
        shapes: ν, the number of independent features of a model's error.
    """
    pieces = sum(part.evidence for part in readings)
    best = min(sets, key=lambda fitted: fitted.chi)
    least, spectrum = best.chi, best.noise_spectrum
    if spectrum is not None:
        scale = NoiseScale(spectrum.chi, shapes=shapes, pieces=pieces, spectrum=spectrum)
        return replace(scale, variance=scale.spread(least))
    noise = least if least < (1.0 + NOISE_ERROR) * pieces else pieces
    if least < MOST_OF * pieces:
        noise = 0.0  # the readings look noisier than they are, so that nobody knows what the noise leaves
    return NoiseScale(noise, NoiseScale(noise, shapes=shapes).spread(least), shapes, pieces)


def log_evidence(fitted: Hypothesis, scale: NoiseScale) -> float:
    """Log evidence [nats] of a set: log likelihood, Occam factor and log prior.

    Args:
        fitted: the set.
        scale: noise and number of features of the error.
    """
    variance = scale.spread(fitted.chi)
    cost = fitted.kept(("occam", variance), lambda: occam(fitted, variance))
    return scale.of(fitted) - cost + log_prior(fitted.causes)


def occam(fitted: Hypothesis, variance: float) -> float:
    """Occam factor of a set: what the parameters of its causes cost [nats], with those of plant and records unknown.

    It is −½ log det C, where C is the covariance of the causes' parameters in units of their prior widths (MacKay
    1992). As no law is exact, ``LEAST_SPREAD``² is added to each variance, except for frequencies, pitches and phases
    (``Effect.exact``).

    Args:
        fitted: the set.
        variance: v, the variance of the model's error in units of the noise's.

    Returns:
        At least 0; 0 for a set without causes.
    """
    names = np.array(fitted.problem.names)
    own = np.isin(names, _own(fitted))
    if not own.any():
        return 0.0
    size = prior_widths(fitted)
    information = fitted.information * np.outer(size, size) / variance
    information[np.diag_indices_from(information)] += 1.0  # the prior of the plant's
    cross = information[np.ix_(own, ~own)]
    about = information[np.ix_(own, own)] - cross @ _solved(information[np.ix_(~own, ~own)], cross.T)
    exact = {name for cause in fitted.causes for name in by_name(cause).exact}
    wander = np.array([0.0 if name in exact else LEAST_SPREAD**2 for name in names[own]])
    covariance = np.linalg.pinv(about, hermitian=True) + np.diag(wander)
    return max(-0.5 * float(np.linalg.slogdet(covariance)[1]), 0.0)


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solution (n, m) of a symmetric system (n, n), the shortest one if rounding leaves none to the matrix."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrix, hermitian=True) @ right)


def log_prior(causes: Causes) -> float:
    """Log odds [nats] of a set before any data."""
    return math.fsum(math.log(by_name(name).prior_odds) for name in causes)


def _own(fitted: Hypothesis) -> tuple[str, ...]:
    """Names of what a set has beyond the plant: parameters, and zeros that no spring has."""
    problem = fitted.problem
    plain = fitted.model.stiffness == 0.0 and "stiffness" not in problem.names
    zeros = problem.names[len(problem.free) :] if plain else ()
    parameters = tuple(p.name for cause in fitted.causes for p in by_name(cause).parameters)
    return parameters + tuple(name for name in zeros if name.startswith("zero of"))


def prior_widths(fitted: Hypothesis) -> FloatArray:
    """Prior width (p,) of each entry of a set's vector.

    It is the natural size of the entry, or its value where that is larger. The strength of a cause may be of any order
    of magnitude; its width is that of a prior uniform in the logarithm where this is narrower than the natural size.
    """
    problem, point = fitted.problem, fitted.point
    sizes = np.maximum(problem.scale, np.abs(point[: problem.scale.size]))
    strengths = {name for cause in fitted.causes for name, value in by_name(cause).neutral if math.isfinite(value)}
    decade = math.log(NATURAL_RANGE) / math.sqrt(2.0 * math.pi)
    for place, index in enumerate(problem.free):
        if problem.model.names[index] in strengths:
            sizes[place] = min(problem.scale[place], decade * abs(point[place]))
    return np.asarray(sizes)
