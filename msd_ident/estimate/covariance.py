"""Covariance of fitted parameters when residuals are correlated, uneven and quantised.

The estimate is ordinary least squares; its covariance is the sandwich A⁻¹ M A⁻¹ with A = JᵀJ and M = JᵀΓJ, where Γ
is the covariance of the errors (White 1980, Newey and West 1987). Γ has two parts:

* an autoregression fitted to the residual (Yule–Walker, order by BIC), scaled by the residual's local size: a model
  that is slightly wrong leaves an error that rings with the motion, and 3 000 such samples are few pieces of evidence;
* one common error for every stretch in which the cart rests: there an encoder repeats the same rounding error, which
  no number of samples averages away unless noise dithers it (Widrow 1961).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.data import compiled
from msd_ident.data.record import FloatArray
from msd_ident.estimate.levels import FEWEST, LAGS
from msd_ident.estimate.windows import breadths


@dataclass(frozen=True)
class Linearisation:
    """Residual and Jacobian of one record at the solution.

    Attributes:
        residual: (n,) model − data [m], weighted if the loss is robust.
        jacobian: (p, n) derivatives of the residual.
        position: (n,) simulated positions [m].
        encoder_step: [m], 0 if unknown.
    """

    residual: FloatArray
    jacobian: FloatArray
    position: FloatArray
    encoder_step: float


@dataclass(frozen=True)
class Evidence:
    """What one record contributes to the covariance.

    Attributes:
        meat: (p, p) JᵀΓJ, the middle of the sandwich.
        effective_samples: number of independent samples that carry the same information as the correlated ones.
    """

    meat: FloatArray
    effective_samples: float


def rest_phases(position: FloatArray, encoder_step: float) -> list[slice]:
    """Phases of at least ``FEWEST`` samples in which the model rests.

    Args:
        position: (n,) simulated positions [m].
        encoder_step: [m]; with 0 (unknown) there are no such phases.

    Returns:
        Slices of samples within which neighbouring positions differ by less than a thousandth of an encoder step and
        all positions by less than a quarter of one.
    """
    if encoder_step <= 0.0:
        return []
    still = np.abs(np.diff(position)) < 1e-3 * encoder_step
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.view(np.int8), [0]))))
    spans = [slice(int(a), int(b) + 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return [span for span in spans if span.stop - span.start >= FEWEST and np.ptp(position[span]) < 0.25 * encoder_step]


def rounding_variance(encoder_step: float, noise: float) -> float:
    """Variance [m²] of the encoder's rounding error that no averaging over samples at rest removes.

    The mean over all positions of the cart. The noise ahead of the encoder is taken as normal; the rounding error is
    the Fourier series of a saw-tooth with amplitudes q/(πj); the noise damps each harmonic by its characteristic
    function (Widrow 1961).

    Args:
        encoder_step: q [m], positive.
        noise: standard deviation [m] of the noise ahead of the encoder.
    """
    order = np.arange(1, 40)
    damping = np.exp(-((2.0 * np.pi * order * noise / encoder_step) ** 2))
    return float(np.sum(0.5 * (encoder_step / (np.pi * order)) ** 2 * damping))


def evidence(sensed: Linearisation) -> Evidence:
    """The middle of the sandwich for one record.

    Args:
        sensed: residual and Jacobian. The Jacobian is overwritten, so that only one of its size is in memory.
    """
    residual, step = sensed.residual, sensed.encoder_step
    rests = [span for span in rest_phases(sensed.position, step) if abs(float(np.mean(residual[span]))) < step]
    moving = np.ones(residual.size, dtype=bool)
    for span in rests:
        moving[span] = False
    common = 0.0
    if rests:
        white = float(np.var(np.diff(residual))) / 2.0
        common = rounding_variance(step, np.sqrt(max(white - step**2 / 12.0, 0.0)))
    if common < 1e-3 * step**2 or np.count_nonzero(moving) < 5 * LAGS:
        moving[:] = True
    size = _local_size(residual)
    coefficients, variance = autoregression(np.where(moving, residual / size, 0.0), int(np.count_nonzero(moving)))
    meat = np.zeros((sensed.jacobian.shape[0],) * 2)
    for span in rests if common > 0.0 else []:
        total = sensed.jacobian[:, span].sum(axis=1)
        meat += common * np.outer(total, total)
    meat += _coloured(sensed.jacobian, size, coefficients, variance)
    return Evidence(meat, residual.size * _independence(coefficients))


def _local_size(residual: FloatArray) -> FloatArray:
    """Running root mean square over a fifteenth of the record, never below a twentieth of the overall one."""
    reach = max(residual.size // 15, 20) // 2
    squares = np.cumsum(residual**2)
    sums = np.concatenate((np.zeros(reach + 1), squares, np.full(reach, squares[-1])))
    mean = sums[2 * reach + 1 :] - sums[: -2 * reach - 1]
    mean /= breadths(residual.size, reach) + 1.0
    floor = 0.0025 * float(squares[-1]) / residual.size or 1e-300
    return np.asarray(np.sqrt(np.maximum(mean, floor, out=mean), out=mean))


def autoregression(values: FloatArray, count: int) -> tuple[FloatArray, float]:
    """Autoregressive model of a series by the Yule–Walker equations (Levinson–Durbin recursion), its order by BIC.

    Args:
        values: (n,) series of mean 0; samples to be ignored are set to 0.
        count: number of values that are not ignored.

    Returns:
        The coefficients ``[1, a1, …]`` of the prediction-error filter, and the variance of the innovation.
    """
    top = min(LAGS, values.size // 10)
    covariance = np.array([values[: values.size - lag] @ values[lag:] for lag in range(top + 1)]) / max(count, 1)
    best = (np.ones(1), float(covariance[0]))
    if covariance[0] <= 0.0:
        return best
    least = count * np.log(covariance[0])
    polynomial, variance = np.ones(1), float(covariance[0])
    for order in range(1, top + 1):
        reflection = -float(polynomial @ covariance[order:0:-1]) / variance
        if not abs(reflection) < 1.0:
            break
        extended = np.append(polynomial, 0.0)
        polynomial = extended + reflection * extended[::-1]
        variance *= 1.0 - reflection**2
        score = count * np.log(variance) + order * np.log(count)
        if score < least:
            least, best = score, (polynomial, variance)
    return best


def _coloured(jacobian: FloatArray, size: FloatArray, coefficients: FloatArray, variance: float) -> FloatArray:
    """JᵀΓJ for an autoregressive Γ = σ² L⁻¹L⁻ᵀ (L⁻ᵀJ is J filtered backwards in time); ``size`` scales samples."""
    jacobian *= size
    if coefficients.size > 1:
        jacobian = compiled.all_pole(coefficients, jacobian[:, ::-1])
    return np.asarray(variance * (jacobian @ jacobian.T))


def _independence(coefficients: FloatArray) -> float:
    """Number of independent samples per sample: (∫S)²/∫S² of the autoregression's spectrum S."""
    if coefficients.size == 1:
        return 1.0
    spectrum = 1.0 / np.abs(np.fft.rfft(coefficients, 4096)) ** 2
    return float(np.mean(spectrum) ** 2 / np.mean(spectrum**2))


def unit_diagonal(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A normal matrix scaled to unit diagonal, so that units do not decide what is null, and the scale (p,)."""
    diagonal = np.diag(matrix)
    size = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    return np.asarray(matrix / np.outer(size, size)), np.asarray(size)


def inverse_beside(matrix: FloatArray, null: FloatArray) -> FloatArray:
    """Inverse of a normal matrix on the complement of its null directions.

    Args:
        matrix: (p, p), symmetric, positive semidefinite.
        null: (p, q) directions that the data does not determine, as columns; q may be 0.

    Returns:
        (p, p) matrix without variance along the null directions, in the scaling that gives ``matrix`` a unit diagonal.
    """
    scaled, size = unit_diagonal(matrix)
    whole, _ = np.linalg.qr(null * size[:, None], mode="complete")
    rest = whole[:, null.shape[1] :]
    inverse = rest @ np.linalg.pinv(rest.T @ scaled @ rest, rcond=1e-15, hermitian=True) @ rest.T
    return np.asarray(inverse / np.outer(size, size))
