"""Bounds follow the units; for a record far slower than its plant they are not those of the slow motion."""

from __future__ import annotations

from dataclasses import replace

import effect_examples
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import fit
from msd_ident.estimate.bounds import bounds
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.estimate.problem import Initial, Nuisance
from msd_ident.model import Plant
from msd_sim import api

MASS, DAMPING, STIFFNESS = 0.8, 2.1, 900.0


def test_mass_is_recovered_from_a_slow_ramp() -> None:
    made = api.simulate(
        {
            "mass": MASS, "damping": DAMPING, "stiffness": STIFFNESS, "friction_coefficient": 0.0,
            "effects": {"force_offset": {"offset_force": 1.2}}, "rate": 250.0, "seed": 1,
            "encoder": {"counts_per_metre": 0.0, "noise": 1e-5},
            "experiment": {"name": "ramp", "force": 15.0, "duration": 16.0, "rate": 250.0},
        }
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)
    found = fit(Plant(1.3 * MASS, 0.7 * DAMPING, 1.3 * STIFFNESS), record)
    for name, truth in (("mass", MASS), ("damping", DAMPING), ("stiffness", STIFFNESS)):
        quantity = found.quantities[name]
        assert abs(quantity.value - truth) < 4.0 * quantity.std
    assert found.see == pytest.approx(1e-5, rel=0.1)


@settings(max_examples=40)
@given(st.sampled_from(sorted(effect_examples.EXAMPLES)), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_bounds_follow_the_units_of_force_and_length(name: str, force: float, length: float) -> None:
    model, records = effect_examples.model(name), (effect_examples.record(),)
    free = tuple(range(len(model.names)))
    one, other = Magnitudes(8.0, 0.01, 0.04), Magnitudes(8.0 * force, 0.01 * length, 0.04)
    factors = np.array([other.of(p.unit) / one.of(p.unit) for p in model.parameters])
    physical = np.array([[p.lower for p in model.parameters], [p.upper for p in model.parameters]])
    before, after = (np.array(bounds(model, free, (), typical, records)) for typical in (one, other))
    np.testing.assert_allclose(after, np.where(before == physical, before, factors * before), rtol=1e-9)


@pytest.mark.parametrize("slower", [1.0, 100.0])
def test_a_mass_swings_no_faster_than_within_a_sample(slower: float) -> None:
    """The natural size of a mass grows with the square of the motion's time, but its least value does not."""
    record = effect_examples.record()
    typical = Magnitudes(8.0, 0.01, 0.04 * slower)
    lower, _ = bounds(Plant(1.0, 2.0, 400.0), (0,), (), typical, (record,))
    swing = 8.0 * record.period**2 / 0.01  # the mass that moves by the length within a sample
    assert lower[0] == pytest.approx(min(swing, 1e-3 * typical.of("kg")))


def test_a_relaxed_spring_is_looked_for_where_its_force_changes_over_the_travel() -> None:
    """Farther away it is a constant force in all digits: one lay at 5e14 m, and no position kept a digit of the travel.

    Readings may be counted from anywhere, and a velocity has no bounds.
    """
    still = effect_examples.record()
    record = replace(still, position=np.linspace(-0.01, 0.02, still.samples))
    beyond = 1e6 * float(np.ptp(record.position))
    entries = (Nuisance(0, "initial position"), Nuisance(0, "initial velocity"), Nuisance(0, "zero"))
    for shift in (0.0, 1e9 * float(np.ptp(record.position))):
        moved = replace(record, position=record.position + shift)
        lower, upper = bounds(Plant(1.0, 2.0, 400.0), (0, 2), entries, Magnitudes(8.0, 0.01, 0.04), (moved,))
        assert lower.size == upper.size == 5
        assert (lower[:2] >= 0.0).all() and (lower[:2] < upper[:2]).all()
        assert np.isneginf(lower[3]) and np.isposinf(upper[3])
        np.testing.assert_allclose(
            [moved.position.min() - lower[4], upper[4] - moved.position.max()], beyond, rtol=1e-6
        )
        assert lower[2] <= moved.position[0] - upper[4] and moved.position[0] - lower[4] <= upper[2]
    assert not still.position.any()
    assert bounds(Plant(1.0, 2.0, 400.0), (), entries, Magnitudes(8.0, 0.01, 0.04), (still,))[1][2] == 1e4


def test_a_spring_that_is_relaxed_out_of_all_digits_comes_back() -> None:
    """One step against a stop was refused, with the pitch of a cogging of 4e-301 m: a model of this kind led there."""
    time = np.arange(1500) / 500.0
    moved = 4e-3 * (1.0 - np.exp(-20.0 * time)) + np.random.default_rng(1).normal(0.0, 5e-6, time.size)
    record = from_samples(time, np.full(time.size, 12.5), moved)
    found = fit(Plant(1.8, 1.0, 2.3e-14), record, search="near", initial=[Initial(-5.4e14, 0.0, 5.4e14)])
    assert abs(found.initial[0].zero) <= 1.01e6 * np.ptp(moved)
