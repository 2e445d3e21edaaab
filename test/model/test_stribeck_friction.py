"""Breakaway friction beside sliding friction: from nothing to ten times as much."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import Effect
from msd_ident.model.effects.smooth_stribeck_friction import SmoothStribeckFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.stribeck_shape import StribeckShape

#: The laws, each with the values that follow sliding and breakaway force.
LAWS = ((StribeckFriction, (0.03,)), (StribeckShape, (0.03, 1.2)), (SmoothStribeckFriction, (0.03, 0.002)))


def friction(effect: Effect, speed: float) -> float:
    values = dict(zip((p.name for p in effect.parameters), effect.values, strict=True))
    laws = effect.laws()
    return laws["friction"](speed, **values) if "friction" in laws else laws["force"](speed, **values)


@pytest.mark.parametrize(("law", "rest"), LAWS)
@given(sliding=st.floats(0.0, 2.0), ratio=st.floats(10.0, 1e6), speed=st.floats(0.0, 0.5))
def test_breakaway_counts_up_to_ten_times_the_sliding_force(
    law: type[Effect], rest: tuple[float, ...], sliding: float, ratio: float, speed: float
) -> None:
    beyond, limit = law(sliding, ratio * sliding, *rest), law(sliding, 10.0 * sliding, *rest)
    assert friction(beyond, speed) == friction(limit, speed) <= 10.0 * sliding * (1.0 + 1e-12)
    if sliding > 1e-3:
        below = law(sliding, 9.0 * sliding, *rest)
        assert friction(below, 0.005) < friction(limit, 0.005)
    if "breakaway" in law.laws():
        assert law.laws()["breakaway"](sliding, ratio * sliding) == 10.0 * sliding


@pytest.mark.parametrize(("law", "rest"), LAWS)
def test_no_dry_friction_is_nothing_but_a_peak(law: type[Effect], rest: tuple[float, ...]) -> None:
    assert all(friction(law(0.0, 1.0, *rest), speed) == 0.0 for speed in (0.0, 0.01, 0.1))


@pytest.mark.parametrize(("law", "rest"), LAWS)
def test_a_breakaway_that_counts_less_than_its_value_is_said(law: type[Effect], rest: tuple[float, ...]) -> None:
    assert law(0.1, 0.5, *rest).same_as(None) == ""
    said = "A breakaway friction counts up to ten times the sliding one: here 1."
    assert law(0.1, 1.2, *rest).same_as(None) == said


@pytest.mark.parametrize(("seed", "rate"), [(15, 24.0), (42, 24.0), (19, 40.0), (34, 40.0), (46, 40.0)])
def test_a_cart_that_breaks_away_moves_the_same_at_coarse_and_dense_samples(seed: int, rate: float) -> None:
    """Its acceleration is the rounding of the forces then. With a rate from that, 16 of 180 such runs were off by up to
    6e-4 of the motion.
    """
    rng = np.random.default_rng(seed)
    force_time, force = np.sort(rng.uniform(0.0, 4.0, 25)), rng.uniform(-6.0, 6.0, 25)
    force_time[0] = 0.0
    samples = int(4.0 * rate) + 1
    time = np.arange(samples) / rate
    time[1:-1] += rng.uniform(-0.4, 0.4, samples - 2) / rate
    dense = np.union1d(time, np.linspace(0.0, 4.0, 16 * samples))
    coarse, often = (
        simulate(
            Plant(1.0, 2.0, 400.0) + StribeckFriction(0.8, 1.2, 0.02),
            Record(time=one, position=0.0 * one, force_time=force_time, force=force, hold="linear"),
        ).position
        for one in (time, dense)
    )
    expected = often[np.searchsorted(dense, time)]
    assert np.max(np.abs(coarse - expected)) < 1e-5 * np.ptp(expected)
