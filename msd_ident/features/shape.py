"""Fit of the whole step response, for plants that swing too little to show two peaks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.optimize

from msd_ident.data.record import FloatArray
from msd_ident.features.rest_and_turns import run_lengths
from msd_ident.quantity import Quantity

#: Damping ratios that the search starts from.
_STARTS = (0.3, 0.8, 1.5, 4.0)
#: Samples that the search for the right valley uses, and the relative fall of its cost at which it ends.
_SEARCH, _VALLEY = 300, 1e-4
#: Distance to critical damping below which the two roots are moved apart, so that their difference can divide.
_CRITICAL = 1e-6
#: Logarithms beyond this, of ωn and ζ, are of no plant: the search ran away, and the response no longer feels them.
_FAR = 50.0
#: Slopes beyond this are no response any more: the search ran away, as where half of the response is missing.
_SOUND = 1e100


@dataclass(frozen=True)
class Shape:
    """The step response that fits best.

    Attributes:
        natural_frequency: ωn [rad/s].
        damping_ratio: ζ.
        initial, steady_state: start and rest value [m].
        see: standard error [m].
    """

    natural_frequency: Quantity
    damping_ratio: Quantity
    initial: Quantity
    steady_state: Quantity
    see: float


def unit_step_response(time: FloatArray, frequency: float, ratio: float) -> FloatArray:
    """Response (n,) of eq. 10 from rest to a step with K F = 1.

    Args:
        time: (n,) [s] from the step; the response is 0 before it.
        frequency: ωn [rad/s].
        ratio: ζ, larger than 0; above 1 for a response without oscillation.
    """
    return 1.0 - _falling(np.maximum(time, 0.0), frequency, ratio)[0]


def _falling(time: FloatArray, frequency: float, ratio: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What the response still lacks of its end, and the slopes of the response along ωn·t and ζ; each (n,).

    With τ = ωn·t, s = √(1 − ζ²), c = exp(−ζτ)·cos(sτ) and d = exp(−ζτ)·sin(sτ)/s, which for ζ > 1 become hyperbolic,
    these are c + ζ·d, d and (τ·c − d)/s².

    Args:
        time: (n,) [s] from the step, not negative.
        frequency: ωn [rad/s].
        ratio: ζ.
    """
    if abs(ratio - 1.0) < _CRITICAL:
        ratio = 1.0 + _CRITICAL
    angle, square = frequency * time, 1.0 - ratio**2
    root = math.sqrt(abs(square))
    if square > 0.0:
        fade = np.exp(-ratio * angle)
        even, odd = fade * np.cos(root * angle), fade * np.sin(root * angle) / root
    else:
        slow, fast = np.exp(-angle / (ratio + root)), np.exp(-(ratio + root) * angle)
        even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast) / root
    return even + ratio * odd, odd, (angle * even - odd) / square


def fit_shape(time: FloatArray, position: FloatArray, initial: Quantity, onset: float, floor: float) -> Shape | None:
    """Least-squares fit of the step response.

    A run of n equal readings weighs as much as one reading.

    Args:
        time: (n,) [s] from the step.
        position: (n,) readings [m].
        initial: reading before the step, used as one more observation.
        onset: standard deviation of the instant of the step [s].
        floor: noise floor [m].

    Returns:
        None if the fit fails.
    """
    problem = ResponseProblem(time, position, 1.0 / np.sqrt(run_lengths(position)), initial, onset, floor)
    # The early samples tell the fast root, so the search for the valley uses them more densely than the late ones.
    some = np.unique(np.geomspace(1.0, time.size, _SEARCH).astype(int)) - 1
    coarse = ResponseProblem(time[some], position[some], problem.weight[some], initial, onset, floor)
    found = [coarse.solve(start, _VALLEY) for start in problem.starts()]
    finite = [one for one in found if np.all(np.isfinite(one[0]))]
    if not finite:
        return None
    with np.errstate(all="ignore"):  # a record that is no step response may leave more than a float holds
        point, residual = problem.solve(min(finite, key=lambda one: float(one[1] @ one[1]))[0])
        slopes = problem.slopes(point)
    sound = np.all(np.abs(point[:2]) < _FAR) and float(np.max(np.abs(slopes))) < _SOUND
    return _shape(problem, point, residual, slopes) if sound else None


@dataclass(frozen=True)
class ResponseProblem:
    """Unknowns: ln ωn, ln ζ, start and rest value in units of the swing, delay of the step in units of ``onset``."""

    time: FloatArray
    position: FloatArray
    weight: FloatArray
    initial: Quantity
    onset: float
    floor: float

    @cached_property
    def size(self) -> float:
        """The swing: greatest reading minus least [m], never 0."""
        return max(float(np.ptp(self.position)), 1e-300)

    @cached_property
    def reading(self) -> FloatArray:
        """Positions (n,) from the reading before the step, in units of the swing."""
        return (self.position - self.initial.value) / self.size

    def starts(self) -> list[FloatArray]:
        """Points (5,) to search from: each damping ratio of ``_STARTS``, with ωn from the time to half the rise."""
        begin, final = self.initial.value, float(self.position[-1])
        crossed = np.flatnonzero(np.abs(self.position - begin) > 0.5 * abs(final - begin))
        rise = max(float(self.time[crossed[0]]) if crossed.size else 0.0, float(np.median(np.diff(self.time))))
        return [
            np.array([math.log(max(1.0, 1.7 * ratio) / rise), math.log(ratio), 0.0, (final - begin) / self.size, 0.0])
            for ratio in _STARTS
        ]

    def residual(self, point: FloatArray) -> FloatArray:
        """(n + 2,) of eq. 10 at a point (5,): weighted readings, then the reading before the step and the delay.

        All in units of the swing; the last two weigh by how well each is known beside ``floor``.
        """
        frequency, ratio = _plant(point)
        late = self.time - self.onset * point[4]
        curve = point[2] + (point[3] - point[2]) * unit_step_response(late, frequency, ratio)
        misfit = self.weight * (curve - self.reading)
        return np.concatenate((misfit, point[[2, 4]] * self._last_weights))

    def slopes(self, point: FloatArray) -> FloatArray:
        """Jacobian (n + 2, 5) of ``residual``."""
        frequency, ratio = _plant(point)
        late = np.maximum(self.time - self.onset * point[4], 0.0)
        lacking, along, shape = _falling(late, frequency, ratio)
        swing, slopes = point[3] - point[2], np.zeros((self.time.size + 2, 5))
        columns = (swing * along * frequency * late, swing * shape * ratio, lacking, 1.0 - lacking)
        moved = -swing * along * np.where(late > 0.0, frequency * self.onset, 0.0)
        slopes[:-2] = np.stack((*columns, moved), axis=1) * self.weight[:, None]
        slopes[-2, 2], slopes[-1, 4] = self._last_weights
        return slopes

    @cached_property
    def _last_weights(self) -> tuple[float, float]:
        """Weights of the reading before the step and of the delay, beside those of the samples."""
        before = min(self.floor / self.initial.std, 1e3) if self.initial.std > 0.0 else 1.0
        return before, max(self.floor / self.size, 1e-9)

    def solve(self, start: FloatArray, least_fall: float = 1e-8) -> tuple[FloatArray, FloatArray]:
        """Levenberg–Marquardt from a point (5,), until the cost falls by less than a part ``least_fall``.

        Returns:
            The point where it ends, and ``residual`` there.
        """
        with np.errstate(all="ignore"):  # a search that diverges shows in its result
            # Of the two interfaces to MINPACK the one that takes half as long for so small a problem.
            point, _, info, _, _ = scipy.optimize.leastsq(
                self.residual,
                start,
                Dfun=self.slopes,
                full_output=True,
                ftol=least_fall,
                xtol=1e-8,
                gtol=1e-8,
                maxfev=300,
            )
        return point, info["fvec"]


def _plant(point: FloatArray) -> tuple[float, float]:
    """ωn [rad/s] and ζ at a point (5,), never infinite."""
    frequency, ratio = np.exp(np.clip(point[:2], -_FAR, _FAR)).tolist()
    return frequency, ratio


def _shape(problem: ResponseProblem, point: FloatArray, weighted: FloatArray, slopes: FloatArray) -> Shape:
    """The result with intervals; a residual that is correlated in time counts as fewer samples."""
    residual = weighted[:-2] / problem.weight * problem.size
    see = math.sqrt(float(residual @ residual) / max(residual.size - 4, 1))
    readings = max(float(np.sum(problem.weight**2)) - 4.0, 1.0)
    scatter = math.sqrt(float(np.sum(weighted**2)) / readings) * problem.size
    lag = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), 1e-300)
    correlation = min(max(lag, 0.0), 0.999) if see > 1.5 * problem.floor else 0.0
    variance = (max(scatter, problem.floor) / problem.size) ** 2 * (1.0 + correlation) / (1.0 - correlation)
    covariance = np.linalg.pinv(slopes.T @ slopes) * variance
    with np.errstate(invalid="ignore"):  # rounding below 0: not known, NaN
        std = np.sqrt(np.diag(covariance)).tolist()
    frequency, ratio = np.exp(point[:2]).tolist()
    unit, begin = problem.initial.unit, problem.initial.value
    return Shape(
        natural_frequency=Quantity(frequency, frequency * std[0], "rad/s"),
        damping_ratio=Quantity(ratio, ratio * std[1], "1"),
        initial=Quantity(begin + problem.size * float(point[2]), problem.size * std[2], unit),
        steady_state=Quantity(begin + problem.size * float(point[3]), problem.size * std[3], unit),
        see=see,
    )
