"""FitResult: what a fit found, how well it is known, and what the data leaves open."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.estimate.identifiability import OpenDirection
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.quantity import Quantity


@dataclass(frozen=True)
class FitResult:
    """A fitted model with 95 % intervals.

    Attributes:
        model: the model with the fitted values.
        quantities: every parameter of the model by name: value, standard deviation, unit on this rig. Fixed ones have
            std 0, those that the data leaves open NaN.
        free: names of the fitted parameters, in the order of ``covariance``.
        covariance: (p, p) of the free parameters; along open directions it holds no information (see ``open``).
        plain: (p, p) the part of the readings for a residual of unit variance whose samples are independent: (JᵀJ)⁻¹
            where nothing else is known [1/m²].
        rest: (p, p) the part of the rest at the start (``formulation.balanced``).
        residuals: model − data (n,) of each record, in the position unit.
        see: standard error of estimate over all records, eq. 14.
        noise_floor: rms that noise and encoder step leave with the true model, in the position unit; NaN when the
            records do not tell.
        initial: state and zero of each record at its first sample.
        effective_samples: number of independent samples that carry the same information as the residuals.
        open: directions of the parameter space that the data leaves open.
        open_directions: the same as sentences, with what to measure instead.
        converged: whether the solver converged and the result is finite.
        message: one sentence on how the fit ended.
    """

    model: Model
    quantities: Mapping[str, Quantity]
    free: tuple[str, ...]
    covariance: FloatArray
    plain: FloatArray
    rest: FloatArray
    residuals: tuple[FloatArray, ...]
    see: float
    noise_floor: float
    initial: tuple[Initial, ...]
    effective_samples: float
    open: tuple[OpenDirection, ...]
    open_directions: tuple[str, ...]
    converged: bool
    message: str

    def with_std(self, std: FloatArray) -> FitResult:
        """The same values and correlations with other standard deviations (p,) of the free parameters.

        Open and fixed parameters keep theirs.
        """
        known = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        growth = np.where(known > 0.0, std / np.where(known > 0.0, known, 1.0), 1.0)
        covariance = self.covariance * np.outer(growth, growth)
        covariance.setflags(write=False)
        factor = dict(zip(self.free, growth.tolist(), strict=True))
        quantities = {name: replace(one, std=one.std * factor.get(name, 1.0)) for name, one in self.quantities.items()}
        return replace(self, quantities=quantities, covariance=covariance)

    @property
    def samples(self) -> int:
        """Position samples of all records."""
        return sum(residual.size for residual in self.residuals)

    @property
    def correlation(self) -> FloatArray:
        """Correlation matrix (p, p) of the free parameters."""
        size = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        return np.asarray(self.covariance / np.outer(size, size))

    def derived(self, formula: Callable[[Mapping[str, float]], float], unit: str) -> Quantity:
        """A quantity computed from the parameters, with its standard deviation by linear error propagation.

        A quantity that changes along an open direction is open too (std NaN). A ratio that does not change along it is
        known, even if its numerator and denominator are not.

        Args:
            formula: takes the values by name, e.g. ``lambda p: p["stiffness"] / p["mass"]``.
            unit: unit of the result.
        """
        values = {name: quantity.value for name, quantity in self.quantities.items()}
        value = formula(values)
        limits = {parameter.name: (parameter.lower, parameter.upper) for parameter in self.model.parameters}
        gradient = np.array([_slope(formula, values, name, limits[name]) for name in self.free])
        for direction in self.open:
            shares = dict(direction.shares)
            parts = np.array([shares.get(name, 0.0) for name in self.free]) * gradient
            if abs(parts.sum()) > 1e-3 * np.abs(parts).sum():
                return Quantity(value, math.nan, unit)
        return Quantity(value, math.sqrt(max(float(gradient @ self.covariance @ gradient), 0.0)), unit)


def _slope(
    formula: Callable[[Mapping[str, float]], float],
    values: Mapping[str, float],
    name: str,
    limits: tuple[float, float],
) -> float:
    """Derivative of a formula by a value; from one side where that lies on a limit, beyond which no model is."""
    step = 1e-6 * (abs(values[name]) or 1.0)
    low, high = max(values[name] - step, limits[0]), min(values[name] + step, limits[1])
    return (formula({**values, name: high}) - formula({**values, name: low})) / (high - low)


def scale_known(quantities: Mapping[str, Quantity]) -> bool:
    """Whether mass, damping or stiffness is known to within its value, so that a motion says how large a force is."""
    plant = (quantities[name] for name in ("mass", "damping", "stiffness"))
    return any(one.known and one.std < abs(one.value) for one in plant)
