"""The family of profiles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.design.library import TimeScale, family, turned, why


def test_the_family_keeps_to_the_time_and_to_unit_force() -> None:
    for period in (0.1, 0.5, 3.0):
        made = family(TimeScale(period, 20.0))
        assert len({one.name for one in made}) == len(made) > 8
        for one in made:
            assert one.duration <= 20.0 + 1e-9
            assert max(map(abs, one.extremes)) <= 1.0 + 1e-12
            assert one.force_at(np.array([0.0]))[0] == 0.0, "every experiment begins at rest"
            assert why(one.name) != why("something unheard of")


@settings(max_examples=8)
@given(st.floats(0.3, 10.0))
def test_the_family_follows_the_period_of_the_plant(scale: float) -> None:
    """A plant that is slower by a factor is asked the same, that much slower."""
    one, other = family(TimeScale(0.5, 40.0)), family(TimeScale(0.5 * scale, 40.0 * scale))
    shortest = 0.125 * min(scale, 1.0) > 0.1  # below it the rest at the start is no part of a period
    forces = {profile.name: profile.extremes for profile in other}
    for profile in one:
        if shortest and profile.name in forces and "prbs" not in {s.kind for s in profile.segments}:
            assert forces[profile.name] == pytest.approx(profile.extremes, abs=0.05)
    if shortest:
        assert len(one) == len(other)


@pytest.mark.parametrize("place", range(0, 40, 5))
def test_a_turned_profile_pushes_the_other_way(place: int) -> None:
    profile = family(TimeScale(0.5, 20.0))[place]
    other = turned(profile)
    time = np.linspace(0.0, profile.duration, 500)
    np.testing.assert_array_equal(other.force_at(time), -profile.force_at(time))
    assert other.name == f"{profile.name}, turned" and why(other.name) == why(profile.name)


def test_no_time_no_profile() -> None:
    assert family(TimeScale(0.5, 0.1)) == []
