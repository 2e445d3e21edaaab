"""Posing the problem: what is free, which records rest at their start, and the vectors to start from."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest
from fitrigs import COUNTS_PER_METRE, DEMO, measured, wrong
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.formulation import (
    balanced,
    formulate,
    guess_vectors,
    own_vectors,
    regressed,
    starts_at_rest,
    starts_unpushed,
    wide_vectors,
)
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.cubic_spring import CubicSpring

WAITING = {"name": "paper", "start": 0.3, "hold": 1.0}
RELEASED = {"name": "release", "position": 0.02, "duration": 2.0}
ENCODERS = ({"counts_per_metre": COUNTS_PER_METRE}, {"counts_per_metre": 0.0, "noise": 2e-5}, {"counts_per_metre": 2e4})


@cache
def waiting(encoder: int = 1) -> Record:
    return measured(DEMO, WAITING, rate=500.0, encoder=ENCODERS[encoder], seed=3)


@cache
def released(encoder: int = 1) -> Record:
    return measured(DEMO, RELEASED, rate=500.0, encoder=ENCODERS[encoder], seed=3)


def from_there(record: Record, begin: float) -> Record:
    """The part of a record from an instant [s] on."""
    return record.window(begin, float(record.time[-1]))


@pytest.mark.parametrize("encoder", range(len(ENCODERS)))
def test_a_cart_that_waits_rests_and_one_that_swings_does_not(encoder: int) -> None:
    assert starts_at_rest(waiting(encoder))
    assert starts_unpushed(waiting(encoder), True)
    for begin in (0.4, 0.45, 0.5):
        assert not starts_at_rest(from_there(waiting(encoder), begin)), begin
    assert not starts_unpushed(released(encoder), False), "no force ever pushes it"


@settings(max_examples=30)
@given(st.floats(1e-3, 1e3), st.floats(-1.0, 1.0), st.sampled_from([0.0, 0.1, 0.4, 0.62]))
def test_rest_does_not_depend_on_the_unit_or_the_zero_of_the_position(scale: float, zero: float, begin: float) -> None:
    record = from_there(waiting(), begin)
    other = replace(record, position=scale * (record.position + zero))
    assert starts_at_rest(other) is starts_at_rest(record) is (begin < 0.3)


def test_a_force_from_before_the_record_is_no_push() -> None:
    record = waiting()
    earlier = replace(record, force_time=record.force_time - 1.0, force=record.force + 1.0)
    assert not starts_unpushed(earlier, True)
    assert not starts_unpushed(replace(record, force=0.0 * record.force), True)


@pytest.mark.parametrize("rate", [100.0, 200.0, 300.0, 333.0, 500.0, 700.0])
def test_a_push_at_the_second_sample_moves_a_cart_that_rests(rate: float) -> None:
    """Whatever rounding makes of the stamps: at 200 Hz the second one is later than the first plus a period."""
    time = np.arange(0.0, 20.0, 1.0 / rate)
    force = np.where(np.arange(time.size) > 0, 10.0, 0.0)
    begun = from_samples(time, force, np.zeros(time.size))
    moved = replace(begun, position=simulate(Plant(1.0, 0.3, 4.0), begun).position)
    assert starts_unpushed(moved, False)
    later = replace(moved, force=np.where(np.arange(time.size) > 2, 10.0, 0.0))
    assert not starts_unpushed(later, False)
    measured_force = replace(moved, force=force + 0.01 * np.random.default_rng(1).standard_normal(time.size))
    assert starts_unpushed(measured_force, False), "its sensor has noise before the push"
    ramp = replace(moved, force=np.linspace(0.0, 10.0, time.size))
    assert not starts_unpushed(ramp, False), "its first value is no push"


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_record_that_begins_in_the_middle_of_a_motion_is_not_at_rest(hold: Literal["zero", "linear"]) -> None:
    """A sum of sines with 8 samples in the shortest period: neighbours differ by motion and not by noise."""
    rng = np.random.default_rng(3)
    time = np.arange(8500) / 8.0
    rates, phases = np.linspace(0.05, 1.0, 40), rng.uniform(0.0, 2.0 * np.pi, 40)
    motion = np.sin(2.0 * np.pi * np.outer(time, rates) + phases).sum(axis=1)
    whole = from_samples(time, np.roll(motion, 2), motion + 1e-4 * rng.normal(size=time.size), hold=hold)
    parts = [from_there(whole, begin) for begin in time[:400]]
    assert sum(starts_unpushed(part, starts_at_rest(part)) for part in parts) <= 2


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_part_of_a_slow_ramp_is_not_at_rest_whatever_the_hold(hold: Literal["zero", "linear"]) -> None:
    """It hardly moves within its first samples, but the force acted before them."""
    time = np.arange(4000) / 250.0
    force = np.interp(time, [0.0, 4.0, 12.0, 16.0], [0.0, 10.0, -10.0, 0.0])
    noise = 1e-6 * np.random.default_rng(1).normal(size=time.size)
    part = from_there(from_samples(time, force, force / 600.0 + noise, hold=hold), 2.0)
    assert not starts_unpushed(part, starts_at_rest(part))
    assert not formulate(DEMO, (part,)).balances


@pytest.mark.parametrize("force", [[10.0], [10.0, 9.0], [10.0, 9.0, 8.5, 8.0]])
def test_few_commands_do_not_go_on_from_before_the_record(force: list[float]) -> None:
    time = np.arange(3000) * 1e-3
    stamps = np.linspace(0.0, 2.0, len(force))
    pushed = Record(time, np.zeros(time.size), stamps, np.array(force))
    noise = 1e-6 * np.random.default_rng(1).normal(size=time.size)
    record = replace(pushed, position=simulate(DEMO, pushed).position + noise)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert starts_unpushed(record, False)


def test_each_record_has_its_start_and_velocity_and_zero_where_they_are_unknown() -> None:
    problem = formulate(DEMO, (waiting(), from_there(released(), 0.1)))
    assert [(n.record, n.kind) for n in problem.nuisances] == [
        (0, "initial position"), (0, "zero"), (1, "initial position"), (1, "initial velocity"), (1, "zero"),
    ]  # fmt: skip
    assert [balance.record for balance in problem.balances] == [0]
    known = formulate(DEMO, (waiting(),), zero="known")
    assert [n.kind for n in known.nuisances] == ["initial position"] and known.balances == ()


def test_a_zero_is_nothing_but_a_start_where_no_force_depends_on_the_place() -> None:
    plain = Plant(1.0, 2.0, 0.0)
    assert [n.kind for n in formulate(plain, (waiting(),), ["stiffness"]).nuisances] == ["initial position"]
    bent = formulate(plain + CubicSpring(1e5), (waiting(),), ["stiffness"])
    assert [n.kind for n in bent.nuisances] == ["initial position", "zero"]


def test_rest_is_known_to_what_friction_and_play_hold() -> None:
    problem = formulate(DEMO, (waiting(),))
    (plain,) = balanced(problem, DEMO, 2e-5, [0]).balances
    (played,) = balanced(problem, DEMO + Backlash(3e-3), 2e-5, [0]).balances
    held = DEMO["coulomb_force"] / DEMO["stiffness"]
    assert plain.spread == pytest.approx(held / np.sqrt(3.0) + 2e-5, rel=1e-6)
    assert played.spread - plain.spread == pytest.approx(3e-3)
    assert plain.weight == pytest.approx((2e-5 / plain.spread) ** 2)


def test_starts_keep_the_values_given_and_take_the_linear_ones_from_a_regression() -> None:
    problem, model = formulate(DEMO, (waiting(),), ["damping"]), wrong(DEMO)
    starts = regressed(problem)
    own = own_vectors(problem, model, starts)
    assert len(own) == len(starts) + 1
    for vector in own:
        np.testing.assert_array_equal(problem.values(vector)[[0, 2, 3]], model.values[[0, 2, 3]])
    for vector in wide_vectors(problem, [model], starts):
        values = dict(zip(DEMO.names, problem.values(vector), strict=True))
        assert values["stiffness"] == pytest.approx(DEMO["stiffness"], rel=0.05)
        assert values["damping"] == DEMO["damping"], "what is fixed stays as the problem's model has it"


def test_a_guess_replaces_the_parameters_of_its_effect_alone() -> None:
    model = DEMO + CubicSpring(5e4)
    problem = formulate(model, (waiting(),))
    best = own_vectors(problem, model, [])[0]
    vectors = guess_vectors(problem, best)
    assert vectors
    places = {i for vector in vectors for i in np.flatnonzero(vector != best)}
    assert {problem.names[i] for i in places} == {"cubic_stiffness", "coulomb_force"}
    assert all(len({problem.names[i] for i in np.flatnonzero(vector != best)}) <= 1 for vector in vectors)
