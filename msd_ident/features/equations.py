"""Equations 3 to 13 of the paper, one function each, by number."""

from __future__ import annotations

import math


def logarithmic_decrement(first_peak: float, second_peak: float, steady_state: float) -> float:
    """δ = ln((x1 − xss)/(x2 − xss)), eq. 3.

    Args:
        first_peak, second_peak: readings [m] of two peaks on the same side, one period apart.
        steady_state: reading at rest [m].
    """
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
    """ωn = ωd/√(1 − ζ²) [rad/s], eq. 7.

    Args:
        damped: ωd [rad/s].
        ratio: damping ratio ζ, less than 1.
    """
    return damped / math.sqrt(1.0 - ratio**2)


def step_force(amplitude: float, newtons_per_unit: float) -> float:
    """F = (newtons per unit)·(step amplitude) [N], eq. 8.

    Args:
        amplitude: of the step, in units of the command.
        newtons_per_unit: gain of the actuator [N]; 69.5 in the paper.
    """
    return newtons_per_unit * amplitude


def static_gain(steady_state: float, force: float) -> float:
    """K = xss/F [m/N], eq. 9.

    Args:
        steady_state: displacement at rest [m].
        force: [N], not 0.
    """
    return steady_state / force


def stiffness(gain: float) -> float:
    """k = 1/K [N/m], eq. 11."""
    return 1.0 / gain


def mass(stiffness_: float, frequency: float) -> float:
    """m = k/ωn² [kg], from eq. 12.

    Args:
        stiffness_: k [N/m].
        frequency: natural frequency ωn [rad/s].
    """
    return stiffness_ / frequency**2


def damping(stiffness_: float, frequency: float, ratio: float) -> float:
    """b = 2ζk/ωn [N·s/m], from eq. 13.

    Args:
        stiffness_: k [N/m].
        frequency: natural frequency ωn [rad/s].
        ratio: damping ratio ζ.
    """
    return 2.0 * ratio * stiffness_ / frequency
