"""Features of responses whose truth is known in closed form, and of records that have none."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.features import extract, pool
from msd_ident.features.shape import unit_step_response
from msd_ident.io import SourceOptions, read
from msd_ident.quantity import Quantity

FREQUENCY, GAIN, FORCE = 27.0, 1.44e-3, 10.0


def step_record(ratio: float, *, noise: float = 0.0, step: float = 0.0, seed: int = 1, force: float = FORCE) -> Record:
    """0.5 s of rest, a step up for 4 s, a step down for 4 s, from the closed form of eq. 10."""
    time = np.arange(0.0, 8.5, 1e-3)
    position = (
        GAIN
        * force
        * (unit_step_response(time - 0.5, FREQUENCY, ratio) - unit_step_response(time - 4.5, FREQUENCY, ratio))
    )
    command = np.where((time >= 0.5) & (time < 4.5), force, 0.0)
    position = position + noise * np.random.default_rng(seed).standard_normal(time.size)
    return from_samples(time, command, np.round(position / step) * step if step else position)


def near(quantity: Quantity | None, truth: float, relative: float) -> bool:
    """Within the tolerance and within five of its own standard deviations (or a millionth)."""
    assert quantity is not None
    off = abs(quantity.value - truth)
    return off <= relative * abs(truth) and off <= 5.0 * quantity.std + 1e-6 * abs(truth)


@pytest.mark.parametrize("ratio", [0.005, 0.02, 0.0769, 0.2, 0.4])
@pytest.mark.parametrize("force", [FORCE, -FORCE])
def test_swinging_plant_is_read_from_its_turning_points(ratio: float, force: float) -> None:
    found = extract(step_record(ratio, noise=1e-6, step=4e-6, force=force))
    assert found.kind == "step" and len(found.responses) == 2 and "turning points" in found.route
    form = found.standard_form
    assert form is not None
    assert form.natural_frequency.value == pytest.approx(FREQUENCY, rel=2e-3)
    assert form.damping_ratio.value == pytest.approx(ratio, rel=0.02)
    assert form.static_gain is not None and form.static_gain.value == pytest.approx(GAIN, rel=5e-3)


@pytest.mark.parametrize("ratio", [0.75, 0.9, 1.0, 1.3, 2.0, 5.0])
def test_plant_that_hardly_swings_is_read_from_the_whole_response_and_the_route_says_so(ratio: float) -> None:
    found = extract(step_record(ratio, noise=1e-6, step=4e-6))
    assert found.kind == "step"
    assert "Fewer than three clear turning points" in found.route and "least-squares fit" in found.route
    form = found.standard_form
    assert form is not None
    assert near(form.natural_frequency, FREQUENCY, 0.02)
    assert near(form.damping_ratio, ratio, 0.02)
    assert near(form.static_gain, GAIN, 2e-3)


def test_peaks_are_read_between_samples_and_between_encoder_counts() -> None:
    ratio = 0.0769
    peaks = extract(step_record(ratio, step=5e-5)).responses[0].peaks
    assert peaks is not None
    damped = FREQUENCY * math.sqrt(1.0 - ratio**2)
    assert peaks.first.time - 0.5 == pytest.approx(math.pi / damped, abs=3e-4)
    overshoot = GAIN * FORCE * (1.0 + math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2)))
    assert peaks.first.value == pytest.approx(overshoot, abs=2e-5)
    assert peaks.second.time - peaks.first.time == pytest.approx(2.0 * math.pi / damped, abs=5e-4)


def test_step_at_the_first_sample_counts_and_so_does_one_before_which_nothing_was_sent() -> None:
    record = step_record(0.0769)
    tail = record.time >= 0.5
    begun = from_samples(record.time[tail] - 0.5, record.force[tail], record.position[tail])
    assert [round(r.onset, 3) for r in extract(begun).responses] == [0.0, 4.0]
    sparse = replace(begun, force_time=np.array([0.0, 4.0]), force=np.array([FORCE, 0.0]))
    assert extract(sparse).standard_form == extract(begun).standard_form


def test_the_end_of_a_short_push_is_no_step_for_a_cart_that_moves_late() -> None:
    """A pulse of 0.2 s, and a cart that answers it 0.5 s after its begin: it went where the pulse pushed."""
    time = np.arange(4000) / 1000.0
    force = 3.0 * ((time >= 1.0) & (time < 1.2))
    since = np.maximum(time - 1.5, 0.0)
    moved = 0.19 * (1.0 - np.exp(-6.0 * since) * (1.0 + 6.0 * since))
    assert extract(from_samples(time, force, moved)).standard_form is None
    at_once = np.append(moved[290:], np.full(290, moved[-1]))  # the same way, 10 ms after the end of the pulse
    form = extract(from_samples(time, force, at_once)).standard_form
    assert form is not None and form.static_gain is not None


def test_window_that_begins_in_mid_swing_has_no_step_at_its_start() -> None:
    record = step_record(0.0769).window(0.65, 8.5)
    assert [round(r.onset, 3) for r in extract(record).responses] == [4.5]


def test_dry_friction_widens_the_interval_of_the_static_gain() -> None:
    pytest.importorskip("msd_sim")
    from msd_sim.api import simulate

    data = simulate({"rig": "ecp", "experiment": "paper", "seed": 1})
    rubbing = Record(time=data.time, position=data.position, force_time=data.force_time, force=data.force)
    form = extract(rubbing).standard_form
    assert form is not None and form.static_gain is not None
    assert abs(form.static_gain.value - 1 / 694.1) < 2.5 * form.static_gain.std
    assert form.static_gain.std > 1e-3 * form.static_gain.value
    swings = extract(rubbing).responses[0].swings
    assert swings[-1].damping_ratio > 1.2 * swings[0].damping_ratio, "ζ rises as A falls: dry friction"


def test_free_decay_after_a_hand_pull_begins_at_the_release() -> None:
    time = np.arange(0.0, 6.0, 1e-3)
    decay = np.exp(-0.05 * 20.0 * (time - 2.0)) * np.cos(20.0 * math.sqrt(1 - 0.05**2) * (time - 2.0))
    position = np.where(time < 1.0, 0.01 * time, np.where(time < 2.0, 0.01, 0.01 * decay))
    found = extract(from_samples(time, np.zeros(time.size), position))
    assert found.kind == "free_decay" and "no static gain" in found.route
    assert found.remarks and "pulled by hand" in found.remarks[0]
    assert found.responses[0].onset == pytest.approx(2.0, abs=0.03)
    form = found.standard_form
    assert form is not None and form.static_gain is None and form.physical is None
    assert form.natural_frequency.value == pytest.approx(20.0, rel=2e-3)
    assert form.damping_ratio.value == pytest.approx(0.05, rel=0.03)


def test_sweep_has_no_step_response_and_the_route_says_so() -> None:
    time = np.arange(0.0, 10.0, 1e-3)
    force = np.sin(2.0 * np.pi * (0.2 + 0.3 * time) * time)
    found = extract(from_samples(time, force, np.roll(force, 20) * 1e-3))
    assert found.kind == "none" and found.standard_form is None
    assert "a step response does not apply" in found.route


def test_no_force_and_no_motion_is_said() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    found = extract(from_samples(time, np.zeros(time.size), np.full(time.size, 0.5)))
    assert found.kind == "none" and "nothing swings" in found.route


@settings(max_examples=15, deadline=None)
@given(shift=st.floats(-50.0, 50.0), ratio=st.floats(0.01, 0.5))
def test_time_shift_moves_onsets_and_nothing_else(shift: float, ratio: float) -> None:
    record = step_record(ratio, noise=1e-6)
    moved = replace(record, time=record.time + shift, force_time=record.force_time + shift)
    one, other = extract(record), extract(moved)
    assert one.standard_form is not None and other.standard_form is not None
    assert [r.onset + shift for r in one.responses] == pytest.approx([r.onset for r in other.responses], abs=1e-6)
    for name, quantity in one.standard_form.quantities.items():
        assert other.standard_form.quantities[name].value == pytest.approx(quantity.value, rel=1e-5)


@settings(max_examples=15, deadline=None)
@given(scale=st.sampled_from([1e-3, 1e3, 0.37]), ratio=st.floats(0.01, 3.0))
def test_unit_of_length_scales_the_gain_alone(scale: float, ratio: float) -> None:
    record = step_record(ratio, noise=1e-6)
    one = extract(record).standard_form
    other = extract(replace(record, position=record.position * scale)).standard_form
    assert one is not None and other is not None and one.static_gain is not None and other.static_gain is not None
    assert other.natural_frequency.value == pytest.approx(one.natural_frequency.value, rel=1e-4)
    assert other.damping_ratio.value == pytest.approx(one.damping_ratio.value, rel=1e-4)
    assert other.static_gain.value == pytest.approx(scale * one.static_gain.value, rel=1e-4)


@pytest.mark.parametrize(("turn_force", "turn_position"), [(-1, 1), (1, -1), (-1, -1)])
def test_sign_of_force_and_position_turns_the_gain_alone(turn_force: int, turn_position: int) -> None:
    record = step_record(0.0769, noise=1e-6)
    turned = replace(record, force=turn_force * record.force, position=turn_position * record.position)
    one, other = extract(record).standard_form, extract(turned).standard_form
    assert one is not None and other is not None and one.static_gain is not None and other.static_gain is not None
    assert other.natural_frequency.value == pytest.approx(one.natural_frequency.value, rel=1e-9)
    assert other.static_gain.value == pytest.approx(turn_force * turn_position * one.static_gain.value, rel=1e-9)
    assert other.physical is not None and other.physical.mass.value > 0.0


ECP = SourceOptions(
    force="control_effort_v", force_unit="V", position="encoder_counts", position_scale=1 / 56000, position_unit="m"
)


@pytest.mark.parametrize("name", ["step_1", "step_2"])
def test_measured_steps_both_count_and_the_sign_is_understood(name: str, shared_data: Path) -> None:
    found = extract(read(shared_data / f"ecp210/{name}.csv", ECP))
    assert found.kind == "step" and len(found.responses) == 2
    assert found.responses[0].amplitude > 0.0 > found.responses[1].amplitude
    form = pool([found.standard_form])
    assert form is not None and form.static_gain is not None
    assert form.static_gain.value < 0.0 and form.static_gain.unit == "m/V"
    assert form.natural_frequency.value == pytest.approx(23.9, abs=0.5)


def test_measured_release_begins_after_the_hand_pull(shared_data: Path) -> None:
    found = extract(read(shared_data / "ecp210/release_1.csv", replace(ECP, force="none", force_unit="")))
    assert found.kind == "free_decay" and found.remarks and "pulled by hand" in found.remarks[0]
    # The acceleration reaches that of a free motion between 1.32 and 1.35 s: before that the hand still held on.
    assert 1.32 < found.responses[0].onset < 1.36
    rising = [swing.damping_ratio for swing in found.responses[0].swings]
    assert rising[-1] > 2.0 * rising[0], "ζ rises as A falls: dry friction"


def test_measured_closed_loop_axis_has_no_step_response(shared_data: Path) -> None:
    found = extract(read(shared_data / "emps/emps_train.csv", SourceOptions()))
    assert found.kind == "none" and "a step response does not apply" in found.route


@pytest.mark.parametrize("force", [FORCE, 0.0])
@pytest.mark.parametrize("backwards", [False, True])
def test_twenty_slow_samples_are_read_or_declined_in_words(force: float, backwards: bool) -> None:
    time = np.arange(20) * 0.04
    position = GAIN * FORCE * unit_step_response(time, FREQUENCY, 0.0769)
    found = extract(from_samples(time, np.full(20, force), position[::-1] if backwards else position))
    assert found.kind in ("step", "free_decay", "none") and found.route


@pytest.mark.filterwarnings("error")
def test_a_gap_of_the_readings_before_a_step_is_no_empty_level() -> None:
    """All readings between two steps of the force are missing: numpy warned of a mean of nothing."""
    time = np.arange(2400) / 400.0
    steps = ((0.5, 1.0), (1.5, -2.0), (3.0, 2.0))
    force = FORCE * sum(size * (time >= at) for at, size in steps)
    position = GAIN * FORCE * sum(size * unit_step_response(time - at, FREQUENCY, 0.0769) for at, size in steps)
    kept = (time < 1.2) | (time > 3.0 - 1e-9)
    found = extract(Record(time=time[kept], position=position[kept], force_time=time, force=force))
    assert found.responses and all(math.isfinite(one.initial.value) for one in found.responses)
