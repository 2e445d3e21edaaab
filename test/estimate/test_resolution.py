"""Ranges that samples can resolve: they follow the units, and only narrow a problem."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import cache

import numpy as np
import pytest
from fitrigs import DEMO, demo_record, measured
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.problem import Problem
from msd_ident.estimate.resolution import ranges, seen, within
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance

#: Powers of force and length in each scale.
POWERS = {
    "mass": (1, -1), "stiffness": (1, -1), "reach": (0, 1), "span": (0, 1), "duration": (0, 0), "period": (0, 0),
    "speed": (0, 1), "rate": (0, 0), "force": (1, 0), "weakest": (1, 0),
}  # fmt: skip


@cache
def record(rate: float = 250.0) -> Record:
    return demo_record(rate=rate)


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3), st.booleans())
def test_scales_follow_the_units_of_force_and_length(force: float, length: float, driven: bool) -> None:
    rig = record() if driven else replace(record(), force=0.0 * record().force)
    other = replace(rig, position=length * rig.position, force=force * rig.force)
    ratio = force / length
    one = asdict(seen([rig], Plant(0.94, 3.9, 694.0)))
    two = asdict(seen([other], Plant(0.94 * ratio, 3.9 * ratio, 694.0 * ratio)))
    assert one.pop("driven") is two.pop("driven") is driven
    for name, (of_force, of_length) in POWERS.items():
        factor = force**of_force * length**of_length
        if name == "force" and not driven:  # made of mass, span and rate
            factor = force
        assert two[name] == pytest.approx(factor * one[name], rel=1e-9), name


def test_the_largest_of_several_records_counts() -> None:
    small, large = (measured(DEMO, {"name": "paper", "force": force, "hold": 0.5}, rate=250.0) for force in (2.0, 8.0))
    both = seen([small, large], DEMO)
    alone = replace(seen([large], DEMO), weakest=2.0)  # the small one's is the force of a tenth of the time and more
    assert both == seen([large, small], DEMO) == alone
    assert both.force == 8.0 and both.span > 3.0 * seen([small], DEMO).span


def test_every_range_is_one_of_a_parameter_and_a_frequency_is_below_half_the_rate() -> None:
    found = ranges([record()], DEMO)
    assert set(found) <= {p.name for effect in LIBRARY for p in effect.parameters}
    assert all(low < high for low, high in found.values())
    assert found["disturbance_frequency"][1] <= np.pi * 250.0
    finer = ranges([record(1000.0)], DEMO)
    assert finer["disturbance_frequency"][1] == pytest.approx(4.0 * found["disturbance_frequency"][1], rel=0.01)


def test_a_limit_of_the_force_lies_above_a_tenth_of_the_commands() -> None:
    """A limit below them all makes a constant of any force, and no written force says anything."""
    time = record().time
    fading = Record(time, record().position, time, 8.0 * np.exp(-time / time[-1]))
    one_size = ranges([record()], DEMO)["force_limit"]
    low, high = ranges([fading], DEMO)["force_limit"]
    sizes = np.abs(fading.force_at(fading.time))
    assert low == pytest.approx(np.quantile(sizes[sizes > 0.0], 0.1)) and high == np.max(np.abs(fading.force))
    assert one_size == pytest.approx((0.1 * one_size[1], one_size[1])), "of one size only the scale is open"


@cache
def posed() -> Problem:
    return formulate(DEMO + PeriodicDisturbance(0.3, 20.0, 0.1), (record(),))


@given(st.floats(-50.0, 50.0), st.floats(0.0, 100.0))
def test_limits_only_narrow_and_only_what_they_name(low: float, width: float) -> None:
    problem = posed()
    narrowed = within(problem, {"disturbance_frequency": (low, low + width), "no such name": (0.0, 1.0)})
    place = problem.names.index("disturbance_frequency")
    others = np.arange(problem.size) != place
    np.testing.assert_array_equal(narrowed.lower[others], problem.lower[others])
    np.testing.assert_array_equal(narrowed.upper[others], problem.upper[others])
    assert narrowed.lower[place] == max(problem.lower[place], low)
    assert narrowed.upper[place] == min(problem.upper[place], low + width)
