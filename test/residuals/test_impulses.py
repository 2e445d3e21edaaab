"""Pushes that are in no force signal."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import DEMO

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model import simulate as simulate_model
from msd_ident.model.effects import by_name
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.residuals import impulses
from msd_ident.residuals.impulses import Push, pushes, sentences
from msd_sim.api import simulate

NOISE, LASTS = 1e-5, 0.02
HARD = Plant(0.8, 6.0, 200.0) + CubicSpring(2e5)


def bumped(*bumps: tuple[float, float], name: str = "record") -> Record:
    """The demo rig under one step and back, with (instant [s], impulse [N·s]) that no signal has."""
    at, force = [0.2, 1.7], [10.0, 0.0]
    made = [(0.2, 10.0), (1.7, 0.0)]
    for instant, impulse in bumps:
        before = 10.0 if 0.2 <= instant < 1.7 else 0.0
        made += [(instant, before + impulse / LASTS), (instant + LASTS, before)]
    stamps, levels = zip(*sorted(made), strict=True)
    found = simulate(
        {
            **{name: DEMO[name] for name in ("mass", "damping", "stiffness")},
            "effects": {"coulomb_friction": {"coulomb_force": DEMO["coulomb_force"]}},
            "encoder": {"counts_per_metre": 0.0, "noise": NOISE}, "seed": 4, "rate": 500.0, "duration": 3.2,
            "force_time": stamps, "force": levels,
        }
    )  # fmt: skip
    return Record(found.time, found.position, np.array(at), np.array(force), name=name)


@pytest.mark.parametrize("impulse", [0.3, -0.3, 0.05])
@pytest.mark.parametrize("instant", [1.1, 2.4])
def test_instant_and_impulse_of_a_bump_are_found(instant: float, impulse: float) -> None:
    (push,) = pushes(bumped((instant, impulse)), DEMO, NOISE, 0.0)
    assert push.time == pytest.approx(instant + 0.5 * LASTS, abs=0.015)
    assert push.impulse == pytest.approx(impulse, rel=0.1)


def test_a_zero_elsewhere_hides_no_bump() -> None:
    record = bumped((1.1, 0.3))
    moved = replace(record, position=record.position + 0.05)
    (here,), (there,) = pushes(record, DEMO, NOISE, 0.0), pushes(moved, DEMO, NOISE, 0.05)
    assert there.time == here.time and there.impulse == pytest.approx(here.impulse)


def test_what_comes_again_and_again_is_a_cause_and_no_bump() -> None:
    assert pushes(bumped(), DEMO, NOISE, 0.0) == ()
    assert len(pushes(bumped((0.9, 0.2), (2.4, 0.2)), DEMO, NOISE, 0.0)) == 2
    assert pushes(bumped((0.7, 0.2), (1.3, 0.2), (2.1, 0.2), (2.7, 0.2)), DEMO, NOISE, 0.0) == ()


def test_without_a_spring_or_in_a_gap_of_the_readings_nothing_is_said() -> None:
    record = bumped((1.1, 0.3))
    assert pushes(record, DEMO.with_values({"stiffness": 0.0}), NOISE, 0.0) == ()
    seen = (record.time < 1.08) | (record.time > 1.15)
    assert pushes(replace(record, time=record.time[seen], position=record.position[seen]), DEMO, NOISE, 0.0) == ()


def test_the_force_of_a_stop_is_no_push() -> None:
    """A model with a stop has a short, strong force of its own."""
    stopped = DEMO + by_name("end_stop").from_values({"stop_position": 1.0, "stop_stiffness": 1e4})
    assert pushes(bumped((1.1, 0.3)), stopped, NOISE, 0.0) == ()


def hardened(push: float) -> Record:
    """A rig with a hardening spring under two steps, and the impulse of a bump [N·s] at 2.0 s that no signal has."""
    time = np.arange(0.0, 6.0, 2e-3)
    force = np.where((time > 0.5) & (time < 3.5), 30.0, 0.0)
    bump = np.where((time >= 2.0) & (time < 2.0 + LASTS), push / LASTS, 0.0)
    asked = from_samples(time, force + bump, np.zeros(time.size))
    noise = NOISE * np.random.default_rng(2).standard_normal(time.size)
    return replace(asked, position=simulate_model(HARD, asked).position + noise, force=force)


@pytest.mark.parametrize(("push", "count"), [(0.0, 0), (0.1, 1), (0.3, 1), (-0.1, 1), (-0.8, 1)])
def test_the_force_of_a_law_of_the_model_is_no_push(push: float, count: int) -> None:
    """A hardening spring is short and strong at the first peak; the model holds it, and is right."""
    record = hardened(push)
    found = fit(HARD, [record], search="near")
    said = sentences([record], found, NOISE)
    assert len(said) == count
    assert all(one.startswith("Something pushed the cart at 2.0") for one in said)
    assert all(" s with an impulse that is in no signal" in one for one in said), "its size is not known to a tenth"
    if not push:
        (alone,) = found.initial
        assert not pushes(record, found.model, NOISE, alone.zero), (
            "what the plant lacks at its first peak looks like one"
        )


def test_the_record_is_named_where_there_are_several() -> None:
    clean, bad = bumped(name="first"), bumped((2.4, 0.3), name="second")
    both = fit(DEMO, [clean, bad], search="near")
    (said,) = sentences([clean, bad], both, NOISE)
    assert said.startswith("Something pushed the cart at 2.4") and " s of second with about 0." in said
    both = replace(both, initial=both.initial[1:], residuals=both.residuals[1:])
    (alone,) = sentences([bad], both, NOISE)
    assert " of second" not in alone
    open_ = {**both.quantities, "mass": replace(both.quantities["mass"], std=math.nan)}
    (unknown,) = sentences([bad], replace(both, quantities=open_), NOISE)
    assert " s with an impulse that is in no signal: a bump" in unknown, "without a mass its size is not known"
    assert "or a stop or a limit of the drive that the model lacks" in unknown


@pytest.mark.parametrize(("part", "count"), [((0.0, 1.105), 0), ((0.0, 1.6), 1), ((1.105, 3.2), 0), ((1.0, 3.2), 1)])
def test_what_begins_or_ends_with_the_record_is_no_push(part: tuple[float, float], count: int) -> None:
    """A pendulum that swings far was "pushed at 0.000 s": the linear model misses its first swing most."""
    assert len(pushes(bumped((1.1, 0.3)).window(*part), DEMO, NOISE, 0.0)) == count


@pytest.mark.parametrize("size", [3e-3, -1e-2])
def test_readings_that_move_alone_are_no_push(size: float) -> None:
    """A potentiometer that moved by 0.02 rad was "pushed by -0.137 N·m·s"."""
    record = bumped()
    slipped = replace(record, position=record.position + np.where(record.time > 1.1, size, 0.0))
    (found,) = pushes(slipped, DEMO, NOISE, 0.0)
    assert found.jump == pytest.approx(size, rel=0.02) and not pushes(bumped((1.1, 0.3)), DEMO, NOISE, 0.0)[0].jump
    (said,) = sentences([slipped], fit(DEMO, [slipped], search="near"), NOISE)
    assert said.startswith(f"The readings move by about {size:.2g} m at 1.1") and " while the speed stays, " in said
    assert "the encoder slipped or missed counts, or its scale is uneven there" in said


def test_what_the_force_lacks_where_the_cart_is_but_once_is_no_push() -> None:
    """A rope that went slack at the two furthest places of a record was "pushed" there."""
    record = hardened(0.0)
    plain = fit(Plant(0.8, 6.0, 200.0), [record], search="near")
    assert sentences([record], plain, NOISE) == ()
    assert len(sentences([hardened(-0.8)], fit(HARD, [hardened(-0.8)], search="near"), NOISE)) == 1


@pytest.mark.parametrize("late", [1, 2])
def test_a_force_whose_stamps_are_late_is_no_push(late: int) -> None:
    """Each change of the setpoint of a controller that acted 5 ms late "pushed the cart"."""
    record = bumped()
    moved = replace(record, force_time=record.force_time - late * record.period)
    assert pushes(moved, DEMO, NOISE, 0.0) == ()
    assert len(pushes(bumped((0.204, 0.3)), DEMO, NOISE, 0.0)) == 1, "a bump beside a step of the force is one"


def test_what_answers_a_rare_change_of_the_force_is_no_push_to_and_fro() -> None:
    """Of two pulses of a cart that started late in the first one, the end of the second "pushed the cart"."""
    time = np.arange(0.0, 6.0, 0.002)
    pulses = np.where((time % 3.0 >= 0.5) & (time % 3.0 < 0.54), np.where(time < 3.0, 30.0, 20.0), 0.0)
    lagged = np.where((time >= 3.5) & (time < 3.6), 2.0 * np.sin(2.0 * np.pi * (time - 3.5) / 0.1), 0.0)
    moved = simulate_model(DEMO, from_samples(time, pulses + lagged, 0.0 * time)).position
    noise = NOISE * np.random.default_rng(2).standard_normal(time.size)
    record = from_samples(time, pulses, moved + noise)
    assert pushes(record, DEMO, NOISE, 0.0) == ()
    elsewhere = from_samples(time, np.roll(pulses, 400), moved + noise)
    apart = simulate_model(DEMO, from_samples(time, np.roll(pulses, 400) + lagged, 0.0 * time)).position + noise
    assert len(pushes(replace(elsewhere, position=apart), DEMO, NOISE, 0.0)) == 1


def test_a_push_to_and_fro_moves_the_cart_and_not_the_readings() -> None:
    """A knock and its rebound moved a cart by 7 mm; the "encoder slipped by -9.4e-05 m"."""
    for apart in (0.03, 0.05):
        record = bumped((1.1, 0.3), (1.1 + apart, -0.3))
        (found,) = pushes(record, DEMO, NOISE, 0.0)
        assert not found.jump and math.isnan(found.impulse)
        (said,) = sentences([record], fit(DEMO, [record], search="near"), NOISE)
        assert said.startswith("Something pushed the cart at 1.1") and " with an impulse that is in no signal" in said


@pytest.mark.parametrize("rate", [50.0, 100.0])
def test_a_push_under_a_force_that_changes_often_is_told(rate: float) -> None:
    """Levels that change each 0.1 s, read at 50 Hz: 4 of 12 bumps were told."""
    rng, time = np.random.default_rng(8), np.arange(0.0, 12.0, 0.001)
    force = 8.0 * np.repeat(rng.choice([-1.0, 1.0], 120), 100)
    told = 0
    for instant in np.arange(1.03, 11.0, 0.83):
        bump = np.where((time >= instant) & (time < instant + LASTS), 0.9 / LASTS, 0.0)
        asked = from_samples(time, force + bump, np.zeros(time.size))
        every = round(1000.0 / rate)
        moved = simulate_model(DEMO, asked).position[::every] + NOISE * rng.standard_normal(time[::every].size)
        record = replace(asked, time=time[::every], position=moved, force=force)
        told += bool(pushes(record, DEMO, NOISE, 0.0))
    assert told >= 11


def test_a_push_in_a_record_of_two_swings_is_told() -> None:
    record = bumped((1.1, 0.3)).window(0.95, 1.4)
    assert len(pushes(record, DEMO, NOISE, 0.0)) == 1


def test_a_step_of_the_force_is_looked_for_as_many_samples_before_a_push_as_after() -> None:
    time = 0.05 * np.arange(60)
    stepped = from_samples(time, 5.0 * (time > 0.99), 0.0 * time)
    first = int(np.argmax(stepped.force > 0.0))
    near = [impulses._is_timing(stepped, Push(float(time[first + late]), 0.3), 1) for late in range(-5, 6)]
    assert near == 2 * [False] + 7 * [True] + 2 * [False]
