"""Damping that fades with the speed, against scipy and against its limit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, plant, record
from scipy.integrate import solve_ivp

from msd_ident.data.record import from_samples
from msd_ident.model import Plant, Simulator
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects.fading_damping import FadingDamping
from msd_ident.model.effects.smooth_friction_turn import SmoothFrictionTurn
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.workflow import pipeline


@pytest.mark.parametrize(("speed", "exponent"), [(0.05, 2.0), (0.15, 1.0), (0.15, 0.7), (0.4, 3.0)])
def test_against_scipy(speed: float, exponent: float) -> None:
    measured = record(rate=500.0, duration=1.5)
    model = plant() + FadingDamping(3.0, speed, exponent)

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        fading = 3.0 * v / (1.0 + (abs(v) / speed) ** exponent)
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        return [v, (force - DAMPING * v - fading - STIFFNESS * x) / MASS]

    found = Simulator(model, measured).positions(model.values)
    state, expected = [0.0, 0.0], [0.0]
    for begin, end in zip(measured.time[:-1], measured.time[1:], strict=True):
        state = solve_ivp(slope, (begin, end - 1e-12), state, rtol=1e-10, atol=1e-14).y[:, -1].tolist()
        expected.append(state[0])
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)


def test_far_below_its_speed_it_is_damping() -> None:
    measured = record()
    slow, same = plant() + FadingDamping(3.0, 1e4, 3.0), Plant(MASS, DAMPING + 3.0, STIFFNESS)
    found = Simulator(slow, measured).positions(slow.values)
    expected = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < 1e-6 * np.ptp(expected)


def test_a_brake_far_beyond_its_peak_is_not_taken_for_stribeck_friction(asking_about: Callable[..., None]) -> None:
    """The force falls as 1/v over most of the record, and turns round with the speed."""
    asking_about("coulomb_friction", "stribeck_friction", "stribeck_shape", "fading_damping")
    time, peak = np.arange(2000) / 250.0, 0.4
    levels = 4.0 * np.array([0.0, 0.8, -0.8, 1.5, -0.4, 1.2, 0.0, -1.5])
    force = levels[np.minimum(time.astype(int), levels.size - 1)]

    def slope(t: float, state: np.ndarray, pushed: float) -> list[float]:
        x, v = state
        return [v, (pushed - 60.0 * x - 0.8 * v / (1.0 + (v / peak) ** 2)) / 0.1]

    state, reached = [0.0, 0.0], [0.0]
    for begin, end, pushed in zip(time[:-1], time[1:], force[:-1], strict=True):
        state = solve_ivp(slope, (begin, end), state, args=(pushed,), rtol=1e-9, atol=1e-12).y[:, -1].tolist()
        reached.append(state[0])
    noise = np.random.default_rng(1).normal(0.0, 1e-5, time.size)
    (cause,) = pipeline.diagnose([from_samples(time, force, np.array(reached) + noise)]).causes
    assert cause.name == "fading_damping" and cause.probability > 0.99
    assert cause.parameters["fading_speed"].value == pytest.approx(peak, rel=0.05)


def test_slow_fading_is_friction_with_the_slowest_turn() -> None:
    """b1·v/(1 + v/v0) = Fc·v/(v + vc)."""
    fading = plant() + FadingDamping(3.0, 0.05, 1.0)
    turned = SmoothFrictionTurn.in_place_of(fading.effects[0], fading)
    assert turned is not None
    assert turned.effects == (SmoothFrictionTurn(3.0 * 0.05, 0.05, 1.0),)
    for speed in (1e-3, 0.05, 0.7):
        assert FadingDamping.force(speed, speed, 3.0, 0.05, 1.0) == pytest.approx(
            SmoothFrictionTurn.force(speed, *turned.effects[0].values), rel=1e-12
        )
    beside = fading + StribeckFriction(0.3, 0.4, 0.02)
    assert SmoothFrictionTurn.in_place_of(beside.effect("fading_damping"), beside) is None, "two laws of dry friction"


def test_a_damping_that_has_faded_at_most_speeds_is_out_of_its_range() -> None:
    """It was named beside friction that creeps in another way."""
    seen = RecordScales(
        MASS, STIFFNESS, reach=0.02, span=0.04, duration=3.0, period=2e-3, speed=0.4, rate=27.0, force=10.0
    )
    assert FadingDamping.resolvable(seen)["fading_speed"][0] >= 0.15 * seen.speed


@pytest.mark.parametrize("exact", [True, False])
def test_a_force_that_rises_no_more_may_be_dry_friction(exact: bool) -> None:
    """Where more than noise is left, the curve is not this one."""
    assert bool(FadingDamping(3.0, 0.2, 1.3).may_be(1.0, exact)) is not exact
    assert not FadingDamping(3.0, 0.34, 1.3).may_be(1.0, exact)
