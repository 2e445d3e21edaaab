"""Inertia that changes along the travel: against scipy, energy kept, found from another start, told from a spring."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record, silent

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import fit
from msd_ident.model import Simulator
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.position_dependent_inertia import PositionDependentInertia
from msd_ident.workflow import pipeline


def linkage(measured: Record, slope: float, dry: float = 0.0) -> np.ndarray:
    """Positions of a rig whose inertia is m·(1 + a·x), by Lagrange's equation and scipy."""

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        net = force - DAMPING * v - STIFFNESS * x - dry * np.tanh(v / 1e-5) - 0.5 * MASS * slope * v * v
        return [v, net / (MASS * (1.0 + slope * x))]

    return followed(rates, measured, states=2, method="LSODA")


@pytest.mark.parametrize(("slope", "dry"), [(10.0, 0.0), (-20.0, 0.0), (10.0, 0.4)])
def test_the_law_is_lagranges(slope: float, dry: float) -> None:
    measured = record(rate=500.0, duration=1.0)
    whole = plant() + PositionDependentInertia(slope)
    whole = whole + CoulombFriction(dry) if dry else whole
    found, expected = Simulator(whole, measured).positions(whole.values), linkage(measured, slope, dry)
    assert np.max(np.abs(found - expected)) < (1e-3 if dry else 1e-6) * np.ptp(expected)


def test_energy_stays() -> None:
    """½·m·(1 + a·x)·v² + ½·k·x²: without damping the cart comes back to where it was let go from."""
    whole = plant().with_values({"damping": 0.0}) + PositionDependentInertia(20.0)
    moved = Simulator(whole, silent(rate=4000.0)).trajectory(whole.values, 0.01, 0.0)
    inertia = MASS * (1.0 + 20.0 * moved.position)
    energy = 0.5 * inertia * moved.velocity**2 + 0.5 * STIFFNESS * moved.position**2
    assert np.ptp(energy) < 1e-6 * energy[0]


def test_its_value_is_found_from_another_start() -> None:
    measured = record(rate=500.0)
    truth = plant() + PositionDependentInertia(8.0)
    seen = replace(measured, position=Simulator(truth, measured).positions(truth.values))
    found = fit(plant().with_values({"mass": 1.05 * MASS}) + PositionDependentInertia(-2.0), seen).model
    assert found["inertia_slope"] == pytest.approx(8.0, rel=1e-3)
    assert found.mass == pytest.approx(MASS, rel=1e-3)


def test_the_inertia_stays_positive_within_its_range() -> None:
    seen = RecordScales(
        MASS, STIFFNESS, reach=0.02, span=0.04, duration=3.0, period=2e-3, speed=0.4, rate=27.0, force=10.0
    )
    least, most = PositionDependentInertia.resolvable(seen)["inertia_slope"]
    assert least == -most
    assert most * 0.04 < 1.0


@pytest.mark.parametrize("slope", [3.0, -6.0])
def test_a_crank_under_a_sine_has_no_bent_spring_and_no_drift(slope: float, asking_about: Callable[..., None]) -> None:
    """A sine whose amplitude grows: an asymmetric spring with 99.8 % and a sensor that drifts with 96 %."""
    asking_about(
        "asymmetric_spring", "sensor_drift", "position_dependent_inertia", "sensor_nonlinearity", "stiffness_drift"
    )
    time = np.arange(1500) / 250.0
    force = (2.0 + 1.6 * time) * np.sin(0.6 * np.sqrt(STIFFNESS / MASS) * time)
    pushed = from_samples(time, force, np.zeros(time.size))
    moved = linkage(pushed, slope)
    noise = np.random.default_rng(4).normal(0.0, 1e-3 * float(np.std(moved)), moved.size)
    (cause,) = pipeline.diagnose([replace(pushed, position=moved + noise)]).causes
    assert cause.name == "position_dependent_inertia"
    assert cause.probability > 0.95
    assert cause.parameters["inertia_slope"].value == pytest.approx(slope, rel=0.05)
