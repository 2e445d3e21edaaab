"""Bad data: the numbers are right, or said to be in doubt. ``make fuzz`` tries many more seeds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim

from bench.reliability import datafaults, estimates
from bench.reliability.datafaults import Fault, clean
from msd_ident.data import quality
from msd_ident.data.record import Record, from_samples
from msd_ident.workflow import pipeline
from msd_sim.api import simulate

#: Faults that cost nothing: the estimate is right, always.
HARMLESS = ("dropped", "outliers", "outliers_of_any_size", "jitter", "zero_shift", "small_zero_shift", "first_half")

#: Causes that come nearest to a push: forces that come and go, a drift, a stop, a second mass, friction.
PUSHING = (
    "coulomb_friction", "force_offset", "periodic_disturbance", "two_tone_disturbance", "sensor_drift", "end_stop",
    "second_mode",
)  # fmt: skip


@pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see it, and could not tell what it is about
@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("fault", datafaults.FAULTS, ids=lambda fault: fault.spoil.__name__)
def test_bad_data_never_gives_a_confident_wrong_number(fault: Fault, seed: int) -> None:
    found = estimates.judge(fault, seed)
    assert found.outcome != "fooled", (found.worst, found.said)
    if fault.spoil.__name__ in HARMLESS:
        assert found.outcome == "right", (found.worst, found.said)


def findings(fault: datafaults.Spoil, seed: int) -> tuple[Record, dict[str, str]]:
    spoiled = fault(clean(), np.random.default_rng(seed))
    return spoiled, {one.code: one.sentence for one in quality.check(spoiled)}


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_wild_readings_are_left_out_and_counted(seed: int) -> None:
    spoiled, found = findings(datafaults.outliers, seed)
    assert set(found) == {"outliers"}, "not stuck, no clocks apart"
    wild = np.flatnonzero(np.abs(spoiled.position - clean().position) > 1e-3)
    left = quality.clean(spoiled)
    assert set(wild) <= set(left.wild.tolist())
    assert left.wild.size < 1.2 * wild.size + 3
    begins = f"{left.wild.size} single readings jump away from their neighbours, by up to 0.189"
    assert found["outliers"].startswith(begins)


def test_a_single_wild_reading_is_one_warning() -> None:
    position = clean().position.copy()
    position[2000] += 0.5
    (found,) = quality.check(replace(clean(), position=position))
    assert found.sentence.startswith("1 single reading jumps away from its neighbours, by up to 0.5")
    assert "(at 2.000 s): left out" in found.sentence


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_zero_that_moves_is_found_with_its_place_and_size(seed: int) -> None:
    spoiled, found = findings(datafaults.zero_shift, seed)
    truth = spoiled.position - clean().position
    (jump,) = quality.clean(spoiled).jumps
    assert truth[jump.index - 1] == 0.0 and jump.size == pytest.approx(truth[jump.index], abs=1e-5)
    assert f"at {clean().time[jump.index]:.3f} s and goes on with the same speed" in found["zero_shift"]


@pytest.mark.parametrize(("hears", "slips"), [(-6e-5, 0.0), (0.0, 1e-3), (-6e-5, 8e-3)])
def test_a_jump_with_the_force_is_a_zero_that_moved_where_other_jumps_of_the_force_make_none(
    hears: float, slips: float
) -> None:
    time = np.arange(4000) / 500.0
    force = np.random.default_rng(5).uniform(-6.0, 6.0, 10)[np.arange(time.size) // 400]
    _, position, _ = lsim(([1.0], [0.94, 3.9, 694.0]), force, time, interp=False)
    position += hears * force + np.random.default_rng(6).normal(0.0, 2e-5, time.size)
    largest = int(np.argmax(np.abs(np.diff(force)))) + 1
    position[largest:] += slips
    jumps = quality.clean(from_samples(time, force, position)).jumps
    assert [jump.index for jump in jumps] == ([largest] if slips else [])


def test_a_zero_that_moves_is_found_where_no_force_acts() -> None:
    time = np.arange(1000) / 250.0
    decay = 0.01 * np.exp(-0.5 * time) * np.cos(20.0 * time) + np.random.default_rng(6).normal(0.0, 1e-5, time.size)
    decay[600:] += 2e-3
    (jump,) = quality.clean(from_samples(time, np.zeros(time.size), decay)).jumps
    assert jump.index == 600 and jump.size == pytest.approx(2e-3, rel=0.05)


@pytest.mark.parametrize("rate", [1000.0, 250.0, 60.0])
@pytest.mark.parametrize("rig", ["ecp", "sticky", "backlash", "end_stop", "odd"])
def test_nothing_is_cleaned_where_nothing_is_wrong(rig: str, rate: float) -> None:
    for name in ("paper", "release", "sweep", "random_steps"):
        found = simulate({"rig": rig, "experiment": name, "rate": rate})
        record = Record(found.time, found.position, found.force_time, found.force, found.hold)
        cleaned = quality.clean(record)
        assert cleaned.record is record, (name, cleaned.wild, cleaned.jumps)


@pytest.mark.parametrize("samples", [1, 2, 4, 7, 12])
def test_a_record_that_ends_just_after_a_push_loses_no_motion(samples: int) -> None:
    """At 100 Hz the cart moves from rest by a thousand times the noise between two samples."""
    found = simulate({"rig": "ecp", "force_time": [0.0, 3.0], "force": [10.425, 0.0], "duration": 4.0, "rate": 100.0})
    last = int(np.searchsorted(found.time, 3.0)) + 1 + samples
    record = Record(found.time[:last], found.position[:last], found.force_time, found.force, found.hold)
    assert quality.clean(record).wild.size <= (samples == 1), "a single sample may be a wild one, for all that is known"


@pytest.mark.parametrize("begin", range(107, 117))
def test_a_record_may_begin_anywhere_in_a_swing(begin: int) -> None:
    """Also at its top, where ten samples of 23 a swing have no slope: the cart does not rest there."""
    found = simulate({"rig": "ecp", "force_time": [0.0, 2.5], "force": [10.425, 0.0], "duration": 5.0, "rate": 100.0})
    force = np.where(found.time < 2.5, 10.425, 0.0)
    result = pipeline.identify(
        [from_samples(found.time[begin:] - found.time[begin], force[begin:], found.position[begin:])]
    )
    assert result.refined.see < 2.0 * result.noise_floor, result.refined.initial


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_push_is_named_with_its_instant(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = rng.uniform(0.1, 0.9) * clean().time[-1]
    impulse = rng.choice([-1.0, 1.0]) * rng.uniform(2.0, 20.0) * 0.02
    found = pipeline.identify([datafaults.bump(clean(), np.random.default_rng(seed))])
    (said,) = [sentence for sentence in found.warnings if sentence.startswith("Something pushed the cart at ")]
    words = said.split()
    assert float(words[5]) == pytest.approx(at + 0.01, abs=0.01)
    assert float(words[9]) == pytest.approx(impulse, rel=0.1)


def test_stamps_of_a_coarse_clock_are_told() -> None:
    found = pipeline.identify([datafaults.rounded_stamps(clean(), np.random.default_rng(0))])
    assert any("their clock ticks every 0.01 s, so force and position may be as far apart" in s for s in found.warnings)


# A force that acts in the first line of a table.


def held(force: float, begin: float, rate: float = 250.0) -> Record:
    """The demo's rig under a force from long before the record, released after 2 s; from ``begin`` [s] on."""
    found = simulate({"rig": "ecp", "force_time": [0.0, 2.0], "force": [force, 0.0], "duration": 4.0, "rate": rate})
    chosen = found.time >= begin
    return from_samples(
        found.time[chosen] - begin, np.where(found.time < 2.0, force, 0.0)[chosen], found.position[chosen]
    )


def test_a_cart_that_rests_under_the_first_force_was_pushed_before() -> None:
    found = pipeline.identify([held(10.0, 1.5)])
    assert any("is assumed to have acted before the record began" in said for said in found.warnings)
    assert found.refined.see < 2.0 * found.noise_floor
    assert found.refined.parameters["stiffness"].value == pytest.approx(694.1, rel=0.02)
    assert len(found.features[0].responses) == 1
    whole = pipeline.identify([held(10.0, 0.0)])
    assert not any("acted before" in said for said in whole.warnings), "here it stepped in the first line"


def test_a_cart_that_leaves_its_place_under_the_first_force_is_not_taken_to_rest_under_it() -> None:
    """An axis without a spring runs on, less for its force than later; a first step is followed by much larger ones."""
    axis = {"mass": 4e-4, "damping": 2.5e-4, "stiffness": 0.0, "friction_coefficient": 0.0}
    cases = (
        (axis, [0.0, 10.0], [-0.03, -0.04]),
        ({"rig": "ecp"}, [0.0, 3.0, 3.5, 4.0, 4.5], [3.0, 4.0, -9.0, 9.0, -9.0]),
    )
    for rig, times, forces in cases:
        made = simulate({**rig, "force_time": times, "force": forces, "duration": 2.0 * times[1], "rate": 200.0})
        force = np.array(forces)[np.searchsorted(times, made.time + 1e-9, side="right") - 1]
        record = from_samples(made.time, force, made.position)
        assert quality.begins_pushed(record) and not quality.rests_under_force(record)


@pytest.mark.parametrize("setpoint", [0.1, 0.2])
def test_a_controller_that_brings_a_cart_from_rest_did_not_push_it_before(setpoint: float) -> None:
    """Its first force changes only because the cart has moved; a measured cart under it was taken to rest till then."""
    mass, damping, gain, step, period = 0.7, 7.0, 100.0, 2.3e-5, 1e-3
    position, force, x, v = np.zeros(1000), np.zeros(1000), 0.0, 0.0
    fade = np.exp(-damping * period / mass)
    for i in range(position.size):
        position[i] = step * np.floor(x / step)
        force[i] = gain * (setpoint - position[i])
        end = force[i] / damping
        x, v = x + end * period + (v - end) * (1.0 - fade) * mass / damping, end + (v - end) * fade
    record = from_samples(period * np.arange(position.size), force, position)
    assert quality.begins_pushed(record) and not quality.rests_under_force(record)
    # One that held the cart against a load, until it gets another setpoint, had pushed before.
    load = 0.5 * gain * setpoint + np.concatenate((np.zeros(500), record.force))
    held = from_samples(period * np.arange(load.size), load, np.concatenate((np.zeros(500), position)))
    assert quality.rests_under_force(held)


def test_a_cart_that_moves_in_its_first_lines_does_not_rest_under_the_first_force() -> None:
    """A table cut out of a running test: the cart leaves its place before the force has changed by much."""
    time = 0.01 * np.arange(700)
    motion, force = 8.0 * np.cos(5.3 * time + 0.8), -250.0 * np.sin(5.3 * time + 1.2)
    running = from_samples(time, force, motion)
    assert quality.begins_pushed(running) and not quality.rests_under_force(running)


def test_a_cart_that_runs_through_its_first_lines_does_not_rest_under_the_first_force() -> None:
    """The second half of a measured sweep of a rack: it ran at 0.63 m/s, and moved as far after a change of 5 %."""
    time = 6.7e-4 * np.arange(400)
    motion, force = 0.1 * np.sin(6.3 * time), 125.0 * np.cos(6.3 * time + 0.3) - 14.0 * np.sin(100.0 * time)
    running = from_samples(time, force, motion)
    assert quality.begins_pushed(running) and not quality.rests_under_force(running)


def test_a_force_that_changes_from_the_first_line_on_holds_no_level_to_rest_under() -> None:
    """A cart that a sweep moves by 42 µm in the first 16 ms "is at rest under" the force of the first line."""
    time = 0.004 * np.arange(2000)
    swept = sum(np.cos(2.0 * np.pi * f * time + 0.2) for f in (0.3, 0.9, 1.7, 2.9, 4.1))
    force = -5.5 * swept / swept[0]
    rig = ([1.0], np.polymul([0.04, 1.0], [2.3, 6.0, 420.0]))
    noise = np.random.default_rng(3).normal(0.0, 3e-6, time.size)
    begun = from_samples(time, force, lsim(rig, force, time)[1] + noise)
    assert quality.begins_pushed(begun) and not quality.rests_under_force(begun)
    # The same force that first stood still for a second, under a cart at rest.
    force = np.concatenate((np.full(250, force[0]), force[:-250]))
    rested = from_samples(time, force, force[0] / 420.0 + lsim(rig, force - force[0], time)[1] + noise)
    assert quality.begins_pushed(rested) and quality.rests_under_force(rested)


def test_a_cart_that_speeds_up_from_its_first_line_does_not_rest_under_the_first_force() -> None:
    """A measured motor under a position loop: 64° came of the first command, of which 2 % in the time of its level."""
    time = 0.002 * np.arange(3000)
    motion = np.where(time < 1.0, 30.0 * time**2, 30.0 + 60.0 * (time - 1.0))
    force = np.where(time < 0.08, -32.0, np.where(time < 1.0, -20.0, 32.0))
    begun = from_samples(time, -force, motion + np.random.default_rng(5).normal(0.0, 1e-4, time.size))
    assert quality.begins_pushed(begun) and not quality.rests_under_force(begun)
    late = np.concatenate((np.full(40, 0.0), motion[:-40]))
    assert quality.rests_under_force(from_samples(time, -force, late)), "it moves when the command changes"


@pytest.mark.parametrize("force", [5.0, -3.0])
def test_a_release_under_a_constant_force_is_no_step(force: float) -> None:
    displaced = float(np.sign(force)) * 0.03
    found = simulate(
        {"rig": "ecp", "force_time": [-1.0], "force": [force], "duration": 3.0, "rate": 250.0,
         "initial_position": displaced}
    )  # fmt: skip
    result = pipeline.identify([from_samples(found.time, np.full(found.time.size, force), found.position)])
    assert any("treated as a release under this force, a free decay" in said for said in result.warnings)
    assert any("known only as ratios" in said for said in result.open)
    assert result.features[0].kind == "free_decay"
    ratio = result.refined.parameters["stiffness"].value / result.refined.parameters["mass"].value
    assert ratio == pytest.approx(694.1 / 0.9407, rel=2e-3)


def test_the_signal_whose_unit_is_unknown_is_named() -> None:
    record = replace(clean(), position=226600.0 * clean().position, position_unit="count")
    (said,) = pipeline.identify([record]).open
    assert said.startswith("The position is in count and its scale in metres is unknown, so mass, damping, stiffness")
    assert "give --position-scale" in said and "gain" not in said


@pytest.mark.parametrize("asked", [PUSHING, pytest.param((), marks=pytest.mark.long)], ids=["likest", "whole library"])
def test_a_push_is_no_cause_of_the_library(asked: tuple[str, ...], asking_about: Callable[..., None]) -> None:
    if asked:
        asking_about(*asked)
    found = pipeline.diagnose([datafaults.bump(clean(), np.random.default_rng(3))])
    assert found.verdict == "unexplained"
    assert any(said.startswith("Something pushed the cart at 1.1") for said in found.warnings)
