"""A mass that damping stops well within a sample: against scipy's implicit methods, and without thousands of steps."""

from __future__ import annotations

import inspect
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Model, Plant, Simulator
from msd_ident.model.effects import by_name

PERIOD, DAMPING, STIFFNESS = 0.01, 0.07, 0.3
LAWS = {
    "cogging": {"cogging_amplitude": 0.03, "cogging_pitch": 0.5, "cogging_phase": 0.4},
    "direction_dependent_damping": {"damping_difference": 0.02},
    "quadratic_drag": {"drag_coefficient": 0.02},
    "gravity": {"gravity_moment": 0.2},
}


def jumping(stamps: np.ndarray) -> Record:
    """A force that changes with every sample."""
    force = 0.2 * np.sin(4.0 * stamps) + 0.1 * np.random.default_rng(3).standard_normal(stamps.size)
    return from_samples(stamps, force, np.zeros(stamps.size))


def plant(ratio: float) -> Model:
    """Whose damping stops the mass within ``1/ratio`` of a sample."""
    return Plant(DAMPING * PERIOD / ratio, DAMPING, STIFFNESS)


def implicit(model: Model, record: Record, samples: int) -> np.ndarray:
    """Positions of the first samples by scipy's Radau method, sample by sample."""
    (effect,) = model.effects
    given = dict(zip(model.names, model.values.tolist(), strict=True))
    second = effect.values if effect.name == "second_mode" else (1.0, 0.0, 0.0)
    law = effect.laws().get("force")
    names = list(inspect.signature(law).parameters) if law else []

    def slope(t: float, state: np.ndarray, push: float) -> list[float]:
        x, v, y, u = state
        known = given | {"x": x, "v": v, "speed": abs(v), "direction": float(np.sign(v)), "t": t}
        coupling = second[1] * (x - y) + second[2] * (v - u)
        own = law(*(known[name] for name in names)) if law else 0.0
        return [v, (push - DAMPING * v - STIFFNESS * x - own - coupling) / model.mass, u, coupling / second[0]]

    state, found = np.zeros(4), [0.0]
    for i, (begin, end) in enumerate(pairwise(record.time[:samples])):
        run = solve_ivp(slope, (begin, end), state, "Radau", args=(record.force[i],), rtol=1e-8, atol=1e-12)
        state = run.y[:, -1]
        found.append(float(state[0]))
    return np.array(found)


@pytest.mark.parametrize("ratio", [5.0, 80.0, 3000.0])
@pytest.mark.parametrize("name", [*LAWS, "second_mode"])
def test_the_motion_is_that_of_an_implicit_method(name: str, ratio: float) -> None:
    values = LAWS.get(name, {"second_mass": 1e-4, "second_stiffness": 0.05, "second_damping": 1e-3})
    model, record = plant(ratio) + by_name(name).from_values(values), jumping(PERIOD * np.arange(20))
    found, expected = Simulator(model, record).positions(model.values), implicit(model, record, 4)
    assert np.max(np.abs(found[:4] - expected)) < 2e-6 * np.ptp(expected)


@pytest.mark.parametrize("ratio", [5.0, 80.0, 1e5])
def test_uneven_stamps_of_a_linear_plant_are_exact(ratio: float) -> None:
    stamps = np.cumsum(PERIOD * (1.0 + 0.3 * np.sin(7.0 * np.arange(200))))
    model, record = plant(ratio), jumping(stamps - stamps[0])
    found = Simulator(model, record).positions(model.values)
    matrix = np.array([[0.0, 1.0, 0.0], [-STIFFNESS / model.mass, -DAMPING / model.mass, 1.0 / model.mass], [0, 0, 0]])
    state, expected = np.zeros(2), [0.0]
    for step, push in zip(np.diff(record.time), record.force, strict=False):
        state = (expm(matrix * step) @ np.array([*state, push]))[:2]
        expected.append(float(state[0]))
    assert np.max(np.abs(found - np.array(expected))) < 1e-9 * np.ptp(expected)


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_dry_friction_is_the_same_at_any_small_mass(hold: str) -> None:
    """Turns and rest lie between uneven stamps; with a mass of nothing each stretch is known: (F - Fc)/b."""
    stamps = np.cumsum(PERIOD * (1.0 + 0.3 * np.sin(7.0 * np.arange(400))))
    whole = jumping(stamps - stamps[0])
    record = from_samples(whole.time, whole.force, whole.position, hold="linear" if hold == "linear" else "zero")
    ways = []
    for ratio in (200.0, 400.0, 1e5):
        model = plant(ratio) + by_name("coulomb_friction").from_values({"coulomb_force": 0.04})
        ways.append(Simulator(model, record).positions(model.values))
    near, nearer = (float(np.max(np.abs(one - ways[-1]))) for one in ways[:2])
    assert near < 2e-3 * np.ptp(ways[-1])
    assert nearer == pytest.approx(0.5 * near, rel=0.1), "the way lags by m/b"


@pytest.mark.parametrize("lag", [0.002, 0.01])
@pytest.mark.parametrize("ratio", [310.0, 1e4])
def test_a_stop_within_a_segment_is_seen(lag: float, ratio: float) -> None:
    """The force of a lag or a ramp slows such a mass down and speeds it up again between two samples."""
    record = jumping(PERIOD * np.arange(120))
    coarse = from_samples(record.time, record.force, record.position, hold="linear")
    stamps = PERIOD / 20 * np.arange(20 * 119 + 1)
    fine = replace(coarse, time=stamps, position=np.zeros(stamps.size))
    model = plant(ratio) + by_name("coulomb_friction").from_values({"coulomb_force": 0.04})
    model = model + by_name("actuator_lag").from_values({"lag_time": lag})
    found, expected = (Simulator(model, one).positions(model.values) for one in (coarse, fine))
    assert np.max(np.abs(found - expected[::20])) < 1e-6 * np.ptp(expected)


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("lag", [0.0, 0.002])
@pytest.mark.parametrize("name", ["cubic_spring", "quadratic_drag", "fading_damping", "cogging"])
def test_a_mass_of_next_to_nothing_is_followed_to_the_end(name: str, lag: float, hold: str) -> None:
    """Explicit steps gave up as NaN: the budget of a run is some hundred steps a sample."""
    values = {
        "cubic_spring": {"cubic_stiffness": 1.0},
        "fading_damping": {"fading_damping": 3.0, "fading_speed": 0.1, "fading_exponent": 1.0},
        **LAWS,
    }[name]
    whole = jumping(PERIOD * np.arange(2000))
    record = from_samples(whole.time, whole.force, whole.position, hold="linear" if hold == "linear" else "zero")
    model = plant(1e6) + by_name(name).from_values(values)
    if lag:
        model = model + by_name("actuator_lag").from_values({"lag_time": lag})
    assert np.isfinite(Simulator(model, record).positions(model.values)).all()
