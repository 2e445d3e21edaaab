"""A force whose gain changes along the travel, against scipy, and found in a record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, plant, record
from scipy.integrate import solve_ivp

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Simulator
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.position_dependent_gain import PositionDependentGain
from msd_ident.workflow import pipeline


def moved(measured: Record, gradient: float, curvature: float, lag: float = 0.0) -> np.ndarray:
    """Positions (n,) of the examples' plant under F·(1 + gradient·x + curvature·x²), F behind a lag [s]."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v, late = state
        if measured.hold == "linear":
            force = float(np.interp(t, measured.force_time, measured.force))
        else:
            force = float(measured.force[np.searchsorted(measured.force_time, t, side="right") - 1])
        acts = late if lag else force
        pushes = acts * (1.0 + gradient * x + curvature * x * x)
        return [v, (pushes - DAMPING * v - STIFFNESS * x) / MASS, (force - late) / lag if lag else 0.0]

    found, state = [0.0], np.zeros(3)
    for begin, end in zip(measured.time[:-1], measured.time[1:], strict=True):
        state = solve_ivp(slope, (begin, end - 1e-12), state, rtol=1e-9, atol=1e-13).y[:, -1]
        found.append(float(state[0]))
    return np.array(found)


@pytest.mark.parametrize("lag", [0.0, 0.02])
@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_against_scipy(hold: str, lag: float) -> None:
    measured = record(rate=250.0, duration=2.0, hold=hold)
    model = plant() + PositionDependentGain(5.0, -400.0)
    model = model + ActuatorLag(lag) if lag else model
    found = Simulator(model, measured).positions(model.values)
    expected = moved(measured, 5.0, -400.0, lag)
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)


def test_a_disturbance_beside_it_does_not_add_up() -> None:
    """Another force moves the cart to where the commanded one has another gain."""
    assert not PositionDependentGain.adds_up()


@pytest.mark.parametrize("experiment", ["steps", "sweep"])
def test_it_is_found(experiment: str, asking_about: Callable[..., None]) -> None:
    asking_about(
        "position_dependent_gain", "force_gain_nonlinearity", "force_gain_asymmetry", "cubic_spring",
        "asymmetric_spring", "coulomb_friction",
    )  # fmt: skip
    time = np.arange(1500) / 250.0
    random = np.random.default_rng(8)
    force = 7.0 * np.sin(2.0 * np.pi * (0.5 * time + 0.6 * time**2))
    if experiment == "steps":
        force = random.uniform(-10.0, 10.0, 12)[np.arange(time.size) // 125]
    hold = "linear" if experiment == "sweep" else "zero"
    measured = from_samples(time, force, np.zeros(time.size), hold=hold)
    readings = moved(measured, 3.0, -400.0) + random.normal(0.0, 1e-5, time.size)
    found = pipeline.diagnose([from_samples(time, force, readings, hold=hold)])
    assert [cause.name for cause in found.causes] == ["position_dependent_gain"]
    model = found.extended.model
    assert (model["mass"], model["stiffness"]) == pytest.approx((MASS, STIFFNESS), rel=5e-3)
    assert (model["gain_gradient"], model["gain_curvature"]) == pytest.approx((3.0, -400.0), rel=0.1)
