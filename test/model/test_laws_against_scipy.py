"""Laws that msd_sim does not have and that depend on more than one signal, against scipy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import DAMPING, EXAMPLES, MASS, STIFFNESS, model, plant, record
from scipy.integrate import solve_ivp

from msd_ident.data.record import Record
from msd_ident.model import Simulator, simulate
from msd_ident.model.effects.curved_stiffness_drift import CurvedStiffnessDrift
from msd_ident.model.effects.drive_hysteresis import DriveHysteresis
from msd_ident.model.effects.eccentricity_harmonic import EccentricityHarmonic
from msd_ident.model.effects.growing_damping import GrowingDamping
from msd_ident.model.effects.modulated_disturbance import ModulatedDisturbance
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.position_dependent_damping import PositionDependentDamping
from msd_ident.model.effects.stiffness_drift import StiffnessDrift

#: Forces [N] against +x at t [s], x [m] and v [m/s], of the examples.
FORCES: dict[str, Callable[[float, float, float], float]] = {
    "curved_stiffness_drift": lambda t, x, v: STIFFNESS * (0.05 * t - 0.03 * t**2 + 0.004 * t**3) * x,
    "growing_damping": lambda t, x, v: 100.0 * (math.exp(30.0 * x) - 1.0) / 30.0 * v,
    "modulated_disturbance": lambda t, x, v: (
        0.3 * math.sin(60.0 * t + 0.3) + 0.1 * math.sin(52.0 * t - 0.4) + 0.15 * math.sin(68.0 * t + 0.9)
    ),
    "position_dependent_damping": lambda t, x, v: 100.0 * x * v,
}


def moved(measured: Record, law: Callable[[float, float, float], float], made: Callable[[float], float]) -> np.ndarray:
    """Positions (n,) under a force of the commands."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, (made(t) - law(t, x, v) - DAMPING * v - STIFFNESS * x) / MASS]

    end = float(measured.time[-1])
    return solve_ivp(slope, (0.0, end), [0.0, 0.0], t_eval=measured.time, rtol=1e-10, atol=1e-13, max_step=1e-3).y[0]


@pytest.mark.parametrize("name", sorted(FORCES))
def test_forces_agree(name: str) -> None:
    measured = record(500.0, "linear", 1.0)
    theirs = moved(measured, FORCES[name], lambda t: float(np.interp(t, measured.force_time, measured.force)))
    assert np.max(np.abs(simulate(model(name), measured).position - theirs)) <= 1e-6 * np.max(np.abs(theirs))


def test_a_drive_with_hysteresis_agrees() -> None:
    """Between two commands the loop is a solution of dz/dF = (sign(dF) - z)/Fc."""
    measured = record(500.0, "linear", 2.0)
    kept, last, made, steps = 0.0, 0.0, np.zeros(measured.force.size), 2000
    for index, command in enumerate(measured.force):
        way = math.copysign(1.0, command - last)
        kept = way + (kept - way) * (1.0 - abs(command - last) / 3.0 / steps) ** steps  # so many steps of Euler's
        last = command
        made[index] = command - 0.4 * kept
    theirs = moved(measured, lambda t, x, v: 0.0, lambda t: float(np.interp(t, measured.force_time, made)))
    found = simulate(model("drive_hysteresis"), measured).position
    assert np.max(np.abs(found - theirs)) <= 1e-5 * np.max(np.abs(theirs))


def test_a_held_command_keeps_what_the_drive_made_of_it() -> None:
    """Steps far beyond the loop's width end half a width behind, on the side that they come from."""
    time = np.arange(4000) / 200.0
    force = np.repeat([5.0, 10.0, 5.0, 0.0], 1000)
    measured = Record(time=time, position=0.0 * time, force_time=time, force=force)
    found = simulate(plant() + DriveHysteresis(0.4, 0.01), measured).position
    assert STIFFNESS * found[[999, 1999, 2999, 3999]] == pytest.approx([4.6, 9.6, 5.4, 0.4], abs=1e-3)


def test_an_oval_wheel_agrees() -> None:
    measured = record(500.0)
    once, pitch, phase, twice, other = EXAMPLES["eccentricity_harmonic"].values()
    x = simulate(plant(), measured).position
    theirs = x + once * np.sin(2 * np.pi * x / pitch + phase) + twice * np.sin(4 * np.pi * x / pitch + other)
    found = simulate(plant() + EccentricityHarmonic(once, pitch, phase, twice, other), measured).position
    assert np.max(np.abs(found - theirs)) <= 1e-9 * np.max(np.abs(theirs))


def test_limits() -> None:
    """A curved drift is a steady one, and a growing damping one that is linear in x, without their other terms."""
    measured = record()
    pairs = (
        (CurvedStiffnessDrift(0.02, 0.0, 0.0), StiffnessDrift(0.02)),
        (GrowingDamping(100.0, 0.0), PositionDependentDamping(100.0)),
        (GrowingDamping(100.0, 1e-6), PositionDependentDamping(100.0)),
    )
    for one, other in pairs:
        found, expected = ((Simulator(m, measured)).positions(m.values) for m in (plant() + one, plant() + other))
        assert np.max(np.abs(found - expected)) <= 1e-7 * np.ptp(expected)


def test_sidebands_are_found_beside_a_tone() -> None:
    """Where they are, and how strong, from the force that the plant leaves unexplained."""
    measured = record(1000.0, duration=6.0)
    one = ModulatedDisturbance(0.3, 60.0, 0.3, 8.0, 0.1, -0.4, 0.15, 0.9)
    moved_so = Record(
        time=measured.time, position=simulate(plant() + one, measured).position, force_time=measured.force_time,
        force=measured.force,
    )  # fmt: skip
    found = ModulatedDisturbance.from_simple(PeriodicDisturbance(0.3, 60.0, 0.3), moved_so, plant())[0]
    assert found.modulation_frequency == pytest.approx(8.0, abs=0.5)
    assert (found.lower_sideband_amplitude, found.upper_sideband_amplitude) == pytest.approx((0.1, 0.15), rel=0.3)
