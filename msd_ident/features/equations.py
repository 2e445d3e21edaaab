"""Equations 3 to 13 of the paper, one function each, by number."""

from __future__ import annotations

import math


def logarithmic_decrement(first_peak: float, second_peak: float, steady_state: float) -> float:
    """δ = ln((x1 − xss)/(x2 − xss)), eq. 3, of two peaks [m] on the same side, one period apart."""
    return math.log((first_peak - steady_state) / (second_peak - steady_state))


def damping_ratio(decrement: float) -> float:
    """ζ = δ/√(δ² + 4π²), eq. 4."""
    return decrement / math.hypot(decrement, 2.0 * math.pi)


def damped_period(first_time: float, second_time: float) -> float:
    """Td = t2 − t1 [s], eq. 5."""
    return second_time - first_time


def damped_frequency(period: float) -> float:
    """ωd = 2π/Td [rad/s], eq. 6."""
    return 2.0 * math.pi / period


def natural_frequency(damped: float, ratio: float) -> float:
    """ωn = ωd/√(1 − ζ²) [rad/s], eq. 7, for ζ < 1."""
    return damped / math.sqrt(1.0 - ratio**2)


def step_force(amplitude: float, newtons_per_unit: float) -> float:
    """F = (newtons per unit)·(step amplitude) [N], eq. 8; 69.5 N per unit in the paper."""
    return newtons_per_unit * amplitude


def static_gain(steady_state: float, force: float) -> float:
    """K = xss/F [m/N], eq. 9."""
    return steady_state / force


def stiffness(gain: float) -> float:
    """k = 1/K [N/m], eq. 11."""
    return 1.0 / gain


def mass(stiffness_: float, frequency: float) -> float:
    """m = k/ωn² [kg], from eq. 12."""
    return stiffness_ / frequency**2


def damping(stiffness_: float, frequency: float, ratio: float) -> float:
    """b = 2ζk/ωn [N·s/m], from eq. 13."""
    return 2.0 * ratio * stiffness_ / frequency
