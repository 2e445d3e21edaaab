"""Standard form (ωn, ζ, K) and the physical parameters that follow from it, with their intervals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.features import equations
from msd_ident.quantity import Quantity


@dataclass(frozen=True)
class Physical:
    """Mass, damping and stiffness, eqs. 11 to 13."""

    mass: Quantity
    damping: Quantity
    stiffness: Quantity

    @property
    def quantities(self) -> dict[str, Quantity]:
        """By name."""
        return {"mass": self.mass, "damping": self.damping, "stiffness": self.stiffness}


@dataclass(frozen=True)
class StandardForm:
    """x''/ωn² + (2ζ/ωn) x' + x = K F, eq. 10.

    Attributes:
        natural_frequency: ωn [rad/s].
        damping_ratio: ζ.
        static_gain: K [position unit per force unit]; ``None`` after a free decay, which holds no force. Negative
            where a positive force moves the reading downwards.
    """

    natural_frequency: Quantity
    damping_ratio: Quantity
    static_gain: Quantity | None

    @property
    def quantities(self) -> dict[str, Quantity]:
        """By name, the static gain where it is known."""
        known = {"natural_frequency": self.natural_frequency, "damping_ratio": self.damping_ratio}
        return {**known, "static_gain": self.static_gain} if self.static_gain else known

    @property
    def physical(self) -> Physical | None:
        """m, b, k by eqs. 11 to 13 with first-order intervals, of |K|; ``None`` where K is unknown."""
        if self.static_gain is None:
            return None
        frequency, ratio = self.natural_frequency, self.damping_ratio
        gain, position, force = abs(self.static_gain.value), *_units(self.static_gain.unit)
        k = equations.stiffness(gain)
        m = equations.mass(k, frequency.value)
        b = equations.damping(k, frequency.value, ratio.value)
        on_k = self.static_gain.std / gain
        on_frequency = frequency.std / frequency.value
        on_m = math.hypot(on_k, 2.0 * on_frequency)
        on_b = math.hypot(on_k, on_frequency)
        on_ratio = 2.0 * k / frequency.value * ratio.std
        mass_unit = {("m", "N"): "kg", ("rad", "N·m"): "kg·m²"}.get((position, force), f"{force}·s²/{position}")
        return Physical(
            mass=Quantity(m, m * on_m, mass_unit),
            damping=Quantity(b, math.hypot(b * on_b, on_ratio), f"{force}·s/{position}"),
            stiffness=Quantity(k, k * on_k, f"{force}/{position}"),
        )


def _units(gain_unit: str) -> tuple[str, str]:
    position, force = gain_unit.split("/", 1)
    return position, force.strip("()")


def gain_unit(position_unit: str, force_unit: str) -> str:
    """Unit of K: ``m/N``, ``rad/(N·m)``, ``m/V`` …"""
    return f"{position_unit}/({force_unit})" if "·" in force_unit else f"{position_unit}/{force_unit}"


def combine(quantities: Sequence[Quantity]) -> Quantity:
    """Weighted mean of estimates of one quantity.

    If they scatter more than their standard deviations allow, the standard deviation of the mean is increased
    accordingly.
    """
    if len(quantities) == 1:
        return quantities[0]
    values = np.array([quantity.value for quantity in quantities])
    std = np.array([quantity.std for quantity in quantities])
    std = np.maximum(std, 1e-12 * np.abs(values) + 1e-300)
    weight = std**-2.0 / np.sum(std**-2.0)
    mean = float(weight @ values)
    formal = float(np.sum(std**-2.0)) ** -0.5
    excess = float(np.sum(((values - mean) / std) ** 2)) / (values.size - 1)
    return Quantity(mean, formal * math.sqrt(max(excess, 1.0)), quantities[0].unit)


def combine_chain(quantities: Sequence[Quantity], links: Sequence[float]) -> Quantity:
    """Weighted mean as in ``combine``, of estimates of which neighbours share a part of their error.

    Args:
        quantities: n estimates of one quantity.
        links: (n − 1,) covariances of neighbours.
    """
    std = np.array([quantity.std for quantity in quantities])
    covariance = np.diag(std**2) + np.diag(links, 1) + np.diag(links, -1)
    scale = float(np.mean(std**2))
    if len(quantities) == 1 or not scale > 0.0 or np.linalg.eigvalsh(covariance)[0] < 1e-9 * scale:
        return combine(quantities)
    values = np.array([quantity.value for quantity in quantities])
    inverse = np.linalg.inv(covariance)
    formal = 1.0 / float(np.sum(inverse))
    mean = float(np.sum(inverse @ values)) * formal
    excess = float((values - mean) @ inverse @ (values - mean)) / (values.size - 1)
    return Quantity(mean, math.sqrt(formal * max(excess, 1.0)), quantities[0].unit)


def pool(found: Iterable[StandardForm | None]) -> StandardForm | None:
    """One standard form from those found of the same plant; ``None`` where none was."""
    forms = [form for form in found if form is not None]
    if not forms:
        return None
    gains = [form.static_gain for form in forms if form.static_gain is not None]
    return StandardForm(
        combine([form.natural_frequency for form in forms]),
        combine([form.damping_ratio for form in forms]),
        combine(gains) if gains else None,
    )
