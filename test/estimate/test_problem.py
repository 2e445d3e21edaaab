"""The fitting problem: what its vector means, its residual, and the same on fewer samples."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fitrigs import DEMO, measured
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.posing import build
from msd_ident.estimate.problem import Initial, Problem, RestConstraint
from msd_ident.model import Plant, Simulator
from msd_ident.model.effects.force_offset import ForceOffset

CLEAN = {"counts_per_metre": 0.0}


@cache
def posed() -> Problem:
    """Two records: one from rest, one from the middle of a swing."""
    first = measured(DEMO, {"name": "paper", "hold": 0.5}, rate=250.0, encoder=CLEAN)
    second = measured(DEMO, {"name": "release", "position": 0.02, "duration": 1.0}, rate=250.0, encoder=CLEAN)
    return formulate(DEMO, (first, second.window(0.1, 1.0)))


def true_vector(*initial: Initial) -> np.ndarray:
    return posed().vector(dict(zip(DEMO.names, DEMO.values, strict=True)), initial)


def sizes(least: float, most: float) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(least, most), min_size=4, max_size=4)


@given(sizes(0.1, 10.0), st.lists(st.floats(-0.1, 0.1), min_size=5, max_size=5))
def test_a_vector_gives_back_what_it_was_made_of(values: list[float], states: list[float]) -> None:
    problem = posed()
    initial = (Initial(states[0], 0.0, states[1]), Initial(*states[2:]))
    vector = problem.vector(dict(zip(DEMO.names, values, strict=True)), initial)
    assert vector.size == problem.size == len(problem.names)
    assert problem.values(vector).tolist() == values
    assert problem.initials(vector) == initial


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_zero_shifts_the_readings_of_its_own_record_alone(first: float, second: float) -> None:
    problem = posed()
    plain, moved = true_vector(Initial(), Initial()), true_vector(Initial(0, 0, first), Initial(0, 0, second))
    for record, zero in enumerate((first, second)):
        shift = problem.residual(moved, record) - problem.residual(plain, record)
        np.testing.assert_allclose(shift, zero, atol=1e-12)
        assert problem.linearised(moved, record, problem.first_steps())[1][-1].tolist() == [1.0] * shift.size


def test_the_truth_leaves_nothing() -> None:
    problem = posed()
    assert np.max(np.abs(problem.residual(true_vector(Initial(), Initial()), 0))) < 1e-7


def test_forward_and_central_differences_agree_and_stay_inside_the_bounds() -> None:
    problem = posed()
    point = true_vector(Initial(), Initial(0.01, 0.1, 0.0))
    steps = problem.first_steps()
    for record in range(2):
        residual, ahead = problem.linearised(point, record, steps)
        again, central = problem.central(point, record, steps)
        np.testing.assert_array_equal(residual, again)
        for one, other in zip(ahead, central, strict=True):
            assert np.max(np.abs(one - other)) < 2e-2 * np.max(np.abs(other))
    low = replace(problem, lower=np.where(np.arange(problem.size) == 1, point, problem.lower))
    forward = problem.linearised(point, 0, steps)[1][1]
    np.testing.assert_array_equal(low.central(point, 0, steps)[1][1], forward)


def test_a_simulation_that_blows_up_is_large_and_finite() -> None:
    problem = posed()
    point = true_vector(Initial(), Initial())
    point[problem.names.index("damping")] = -300.0
    residual = problem.residual(point, 0)
    assert np.isfinite(residual).all()
    assert 1e3 * problem.typical.length < np.max(np.abs(residual)) <= 1e6 * problem.typical.length


def drawn_force(samples: int, rate: float) -> Record:
    """A slow plant under a force that changes with every sample."""
    time = np.arange(samples) / rate
    force = np.random.default_rng(1).normal(size=samples)
    plant = Plant(1.0, 2.0, 40.0)
    still = from_samples(time, force, np.zeros(samples))
    return replace(still, position=Simulator(plant, still).positions(plant.values))


def test_thinned_samples_keep_their_places_and_the_impulse() -> None:
    record = drawn_force(8000, 1000.0)
    problem = build(Plant(1.0, 2.0, 40.0), (record,), frozenset(), ())
    few = problem.thinned(1000)
    (left,) = few.records
    every = record.samples // left.samples
    assert every == 8
    np.testing.assert_array_equal(left.position, record.position[::every])
    np.testing.assert_allclose(np.cumsum(left.force) * every, np.cumsum(record.force)[every - 1 :: every], atol=1e-9)
    misfit = few.residual(few.vector({"mass": 1.0, "damping": 2.0, "stiffness": 40.0}, [Initial()]), 0)
    assert np.std(misfit) < 0.03 * np.std(left.position), "the mean force moves the plant in the same way"


def test_what_is_short_already_is_not_thinned() -> None:
    problem = build(Plant(1.0, 2.0, 40.0), (drawn_force(700, 1000.0),), frozenset(), ())
    assert problem.thinned(10) is problem


@given(st.floats(0.01, 1.0))
def test_a_part_is_the_first_of_the_record_and_never_nothing(share: float) -> None:
    whole = posed().records[0]
    part = posed().shortened(share).records[0]
    assert part.samples == max(int(share * whole.samples), 40)
    np.testing.assert_array_equal(part.position, whole.position[: part.samples])


def test_the_balance_at_rest_and_its_slope() -> None:
    model = DEMO + ForceOffset(1.5)
    problem = formulate(model, posed().records[:1])
    balance = RestConstraint(0, 1e-3, 1e-5)
    point = problem.vector(dict(zip(model.names, model.values, strict=True)), [Initial(-1.5 / DEMO["stiffness"])])
    value, slope = problem.imbalance(point, balance)
    assert value == pytest.approx(0.0, abs=1e-15)
    for entry in range(problem.size):
        step = np.zeros(problem.size)
        step[entry] = 1e-6 * problem.scale[entry]
        ahead, behind = (problem.imbalance(point + sign * step, balance)[0] for sign in (1.0, -1.0))
        assert slope[entry] == pytest.approx((ahead - behind) / (2.0 * step[entry]), rel=1e-5, abs=1e-12)


def test_parts_of_a_loose_problem_are_as_loose_and_its_steps_are_above_its_errors() -> None:
    exact = build(Plant(1.0, 2.0, 40.0), (drawn_force(8000, 1000.0),), frozenset(), ())
    loose = exact.on(exact.records, 100.0)
    for one in (loose, loose.shortened(0.5), loose.thinned(1000)):
        assert [simulator.slack for simulator in one.simulators] == [100.0]
    np.testing.assert_allclose(loose.first_steps(), 10.0 * exact.first_steps())
