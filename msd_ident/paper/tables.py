"""The paper's tables: Table 1 as read, Tables 2 and 3 as printed and as eqs. 3 to 13 give them.

Source: the student report on an ECP Model 210 cart (2014) that this project starts from; equations by its numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from msd_ident.features import equations
from msd_ident.model import Model, Plant
from msd_ident.model.base_model import DryFriction

GRAVITY = 9.81


@dataclass(frozen=True)
class Table1:
    """The six numbers that the paper read off its step response, and its force constant (eq. 8). SI units."""

    first_peak: float = 2.554e-2
    second_peak: float = 2.150e-2
    first_time: float = 0.1120
    second_time: float = 0.3440
    steady_state: float = 1.502e-2
    amplitude: float = 0.15
    newtons_per_unit: float = 69.5


@dataclass(frozen=True)
class Printed:
    """What the paper printed in its Tables 2 and 3, for comparison. SI units."""

    natural_frequency: float = 27.16
    damping_ratio: float = 0.0769
    static_gain: float = 0.1441e-2
    force: float = 10.43
    mass: float = 0.9407
    damping: float = 3.927
    stiffness: float = 694.1
    friction_coefficient: float = 0.0133


@dataclass(frozen=True)
class Derived:
    """Tables 2 and 3 computed from Table 1 by eqs. 3 to 13. SI units."""

    logarithmic_decrement: float
    natural_frequency: float
    damping_ratio: float
    static_gain: float
    force: float
    mass: float
    damping: float
    stiffness: float


@dataclass(frozen=True)
class Losses:
    """Part of the amplitude lost in the first half-swing and in each later one (0 to 1)."""

    first: float
    later: float


def derive(table: Table1) -> Derived:
    """Tables 2 and 3 from Table 1, eqs. 3 to 13."""
    decrement = equations.logarithmic_decrement(table.first_peak, table.second_peak, table.steady_state)
    ratio = equations.damping_ratio(decrement)
    period = equations.damped_period(table.first_time, table.second_time)
    frequency = equations.natural_frequency(equations.damped_frequency(period), ratio)
    force = equations.step_force(table.amplitude, table.newtons_per_unit)
    gain = equations.static_gain(table.steady_state, force)
    stiffness = equations.stiffness(gain)
    return Derived(
        logarithmic_decrement=decrement,
        natural_frequency=frequency,
        damping_ratio=ratio,
        static_gain=gain,
        force=force,
        mass=equations.mass(stiffness, frequency),
        damping=equations.damping(stiffness, frequency, ratio),
        stiffness=stiffness,
    )


def losses(table: Table1) -> Losses:
    """Loss of amplitude a half-swing: the first from xss to the first overshoot, later ones from peak to peak."""
    overshoot, later = table.first_peak - table.steady_state, table.second_peak - table.steady_state
    return Losses(1.0 - overshoot / table.steady_state, 1.0 - math.sqrt(later / overshoot))


def plant(derived: Derived) -> Model:
    """The paper's original model."""
    return Plant(derived.mass, derived.damping, derived.stiffness)


def printed_refined(printed: Printed) -> Model:
    """The refined model as printed: m, b, k and µ, eq. 2."""
    friction = DryFriction(printed.friction_coefficient * printed.mass * GRAVITY)
    return Plant(printed.mass, printed.damping, printed.stiffness) + friction
