"""The whole step response at once: for plants that swing too little to show two peaks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray

#: Damping ratios that the search starts from.
_STARTS = (0.3, 0.7, 1.0, 2.0, 5.0)
#: Distance to critical damping below which the two roots are moved apart, so that their difference can divide.
_CRITICAL = 1e-6


@dataclass(frozen=True)
class Shape:
    """ωn [rad/s], ζ, start and rest value [m] of the response that fits best, and its standard error [m]."""

    natural_frequency: Quantity
    damping_ratio: Quantity
    initial: Quantity
    steady_state: Quantity
    see: float


def unit_step_response(time: FloatArray, frequency: float, ratio: float) -> FloatArray:
    """Response (n,) of eq. 10 with K F = 1 from rest, time (n,) [s] from the step; any damping ratio above 0."""
    if abs(ratio - 1.0) < _CRITICAL:
        ratio = 1.0 + _CRITICAL
    root = np.sqrt(complex(ratio**2 - 1.0))
    slow, fast = frequency * (-ratio + root), frequency * (-ratio - root)
    after = np.maximum(time, 0.0)
    shape = 1.0 - (fast * np.exp(slow * after) - slow * np.exp(fast * after)) / (fast - slow)
    real: FloatArray = shape.real.astype(np.float64)
    return real


def fit_shape(time: FloatArray, position: FloatArray, floor: float, unit: str) -> Shape | None:
    """Least squares of the step response on time (n,) [s] from the step and position (n,) [m]; ``None`` if it fails."""
    initial, final = float(np.median(position[: max(3, position.size // 200)])), float(position[-1])
    crossed = np.flatnonzero(np.abs(position - initial) > 0.5 * abs(final - initial))
    rise = max(float(time[crossed[0]]) if crossed.size else 0.0, float(np.median(np.diff(time))))

    def residual(point: FloatArray) -> FloatArray:
        frequency, ratio = np.exp(point[:2])
        return point[2] + (point[3] - point[2]) * unit_step_response(time, frequency, ratio) - position

    size = max(float(np.ptp(position)), 1e-300)
    scale = np.array([1.0, 1.0, size, size])
    best: tuple[float, FloatArray, FloatArray, FloatArray] | None = None
    for ratio in _STARTS:
        start = np.array([math.log(max(1.0, 1.7 * ratio) / rise), math.log(ratio), initial, final])
        found = scipy.optimize.least_squares(residual, start, x_scale=scale, method="lm", max_nfev=400)
        if best is None or found.cost < best[0]:
            best = (float(found.cost), found.x, np.asarray(found.jac, dtype=np.float64), found.fun)
    if best is None or not np.all(np.isfinite(best[1])):
        return None
    return _shape(best[1], best[2], best[3], floor, unit)


def _shape(point: FloatArray, jacobian: FloatArray, residual: FloatArray, floor: float, unit: str) -> Shape:
    """The result with intervals; a residual that is correlated in time counts as fewer samples."""
    see = math.sqrt(float(residual @ residual) / max(residual.size - 4, 1))
    lag = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), 1e-300)
    correlation = min(max(lag, 0.0), 0.999) if see > 1.5 * floor else 0.0
    variance = max(see, floor) ** 2 * (1.0 + correlation) / (1.0 - correlation)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * variance
    std = np.sqrt(np.diag(covariance))
    frequency, ratio = float(np.exp(point[0])), float(np.exp(point[1]))
    return Shape(
        natural_frequency=Quantity(frequency, frequency * float(std[0]), "rad/s"),
        damping_ratio=Quantity(ratio, ratio * float(std[1]), "1"),
        initial=Quantity(float(point[2]), float(std[2]), unit),
        steady_state=Quantity(float(point[3]), float(std[3]), unit),
        see=see,
    )
