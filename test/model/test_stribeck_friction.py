"""Breakaway friction beside sliding friction: from nothing to ten times as much."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

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
