"""Steps of every kind: measured forces, staircases, slow rises, steps that come too early, releases."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from steprigs import Rig, record

from msd_ident.data.record import from_samples
from msd_ident.features import Features, extract

RIG = Rig(frequency=27.0, ratio=0.0769, gain=1.44e-3)
STAIRS = [(0.5, 4.0), (3.5, 10.0), (6.5, -5.0), (9.5, 0.0)]
TIME = np.arange(0.0, 12.5, 1e-3)


def tells_the_rig(found: Features, rig: Rig = RIG, sigmas: float = 4.0) -> bool:
    """Whether ωn, ζ and K are right within so many of their standard deviations, and within 1 %."""
    form = found.standard_form
    if form is None or form.static_gain is None:
        return False
    pairs = ((form.natural_frequency, rig.frequency), (form.damping_ratio, rig.ratio), (form.static_gain, rig.gain))
    return all(abs(q.value - true) <= min(sigmas * q.std, 0.01 * abs(true)) for q, true in pairs)


def test_stairs_up_and_down_through_zero_count_each_with_its_own_amplitude() -> None:
    found = extract(record(RIG, TIME, STAIRS, noise=5e-6))
    assert [response.onset for response in found.responses] == pytest.approx([0.5, 3.5, 6.5, 9.5])
    assert [response.amplitude for response in found.responses] == pytest.approx([4.0, 6.0, -15.0, 5.0])
    assert tells_the_rig(found)


@pytest.mark.parametrize("noise", [0.02, 0.3])
def test_measured_force_with_noise_has_the_same_steps(noise: float) -> None:
    clean = record(RIG, TIME, STAIRS, noise=5e-6)
    measured = replace(clean, force=clean.force + noise * np.random.default_rng(3).standard_normal(TIME.size))
    found = extract(measured)
    assert [response.onset for response in found.responses] == pytest.approx([0.5, 3.5, 6.5, 9.5], abs=1e-9)
    assert found.responses[0].amplitude_std > 0.0
    assert tells_the_rig(found)


def test_commands_with_stamps_of_their_own_give_what_a_sampled_force_gives() -> None:
    sampled = record(RIG, TIME, STAIRS, noise=5e-6)
    sparse = replace(sampled, force_time=np.array([at for at, _ in STAIRS]), force=np.array([f for _, f in STAIRS]))
    assert extract(sparse).standard_form == extract(sampled).standard_form


def test_force_between_linear_samples_steps_in_the_middle_of_the_interval() -> None:
    time = np.arange(0.0, 6.0, 4e-3)
    found = extract(record(RIG, time, [(0.498, 10.0), (3.498, 0.0)], noise=5e-6, hold="linear"))
    assert [response.onset for response in found.responses] == pytest.approx([0.498, 3.498], abs=1e-6)


def test_force_that_takes_some_samples_to_rise_still_steps() -> None:
    sharp = record(RIG, TIME, [(0.5, 10.0), (6.5, 0.0)], noise=5e-6)
    kernel = np.ones(9) / 9.0
    found = extract(replace(sharp, force=np.convolve(np.pad(sharp.force, 4, mode="edge"), kernel, mode="valid")))
    assert [response.onset for response in found.responses] == pytest.approx([0.5, 6.5], abs=1.1e-3)
    assert tells_the_rig(found)


def test_first_step_that_comes_while_the_cart_moves_is_left_out_and_said() -> None:
    moving = record(RIG, TIME, [(0.5, 8.0), (0.9, 2.0), (6.0, 9.0)], noise=5e-6).window(0.62, 12.5)
    found = extract(moving)
    assert [round(response.onset, 3) for response in found.responses] == [6.0]
    assert any("1 force step left out" in remark for remark in found.remarks)
    assert tells_the_rig(found)


def test_two_peak_values_stand_beside_those_of_all_peaks_and_agree_on_a_linear_rig() -> None:
    found = extract(record(RIG, TIME, STAIRS, noise=5e-6))
    two, every = found.two_peak_form, found.standard_form
    assert two is not None and every is not None
    assert two.damping_ratio.value == pytest.approx(RIG.ratio, abs=4.0 * two.damping_ratio.std)
    assert two.natural_frequency.value == pytest.approx(RIG.frequency, abs=4.0 * two.natural_frequency.std)
    assert every.damping_ratio.std < two.damping_ratio.std, "more peaks tell more"
    first = found.responses[0].peaks
    assert first is not None and first.first.time < first.second.time
    assert first.damped_period.value == pytest.approx(first.second.time - first.first.time)


@settings(max_examples=25, deadline=None)
@given(
    ratio=st.floats(0.005, 5.0),
    frequency=st.floats(5.0, 60.0),
    sign=st.sampled_from([-1.0, 1.0]),
    unit=st.sampled_from([1.0, 1e3, 1e-3]),
)
def test_any_damping_any_sign_any_unit_of_length(ratio: float, frequency: float, sign: float, unit: float) -> None:
    rig = Rig(frequency, ratio, sign * 1e-3 * unit)
    held = 8.0 * rig.period * max(1.0, ratio)
    time = np.arange(0.0, 2.3 * held, rig.period / 100.0)
    found = extract(record(rig, time, [(0.2 * held, 10.0), (1.2 * held, 0.0)], noise=2e-6 * unit, seed=5))
    form = found.standard_form
    assert form is not None and form.static_gain is not None and form.physical is not None
    assert form.static_gain.value == pytest.approx(rig.gain, abs=max(6.0 * form.static_gain.std, 1e-9 * unit))
    assert form.natural_frequency.value == pytest.approx(frequency, abs=6.0 * form.natural_frequency.std)
    assert form.damping_ratio.value == pytest.approx(ratio, abs=6.0 * form.damping_ratio.std)
    assert form.physical.stiffness.value == pytest.approx(1.0 / abs(form.static_gain.value))


@settings(max_examples=15, deadline=None)
@given(noise=st.floats(1e-7, 3e-4), seed=st.integers(0, 1000))
def test_noise_up_to_two_per_cent_of_the_step_costs_precision_and_not_truth(noise: float, seed: int) -> None:
    found = extract(record(RIG, TIME, [(0.5, 10.0), (6.5, 0.0)], noise=noise, seed=seed))
    form = found.standard_form
    assert form is not None and form.static_gain is not None
    assert form.natural_frequency.value == pytest.approx(RIG.frequency, abs=6.0 * form.natural_frequency.std)
    assert form.damping_ratio.value == pytest.approx(RIG.ratio, abs=6.0 * form.damping_ratio.std)
    assert form.static_gain.value == pytest.approx(RIG.gain, abs=6.0 * form.static_gain.std)
    assert form.natural_frequency.value == pytest.approx(RIG.frequency, rel=0.01)


def released(*, slow: bool, force: float = 0.0) -> Features:
    """A cart pulled to 1 cm, held, let go at 2 s: at once, or by a hand that follows for a fifth of a second."""
    rig = Rig(20.0, 0.05, 1e-3)
    time = np.arange(0.0, 8.0, 1e-3)
    away = 1.0 - rig.response(time, [(2.0, 1.0)]) / rig.gain
    if slow:
        # The spring's pull grows on the cart while the hand lets go: the response to a ramp in place of a step.
        ramp = [(2.0 + 0.002 * i, 0.01 * (i + 1)) for i in range(100)]
        away = 1.0 - rig.response(time, ramp) / rig.gain
    pulled = np.minimum(time, 1.0)
    noise = 2e-6 * np.random.default_rng(1).standard_normal(time.size)
    position = np.where(time < 2.0, 0.01 * pulled, 0.01 * away) + noise
    return extract(from_samples(time, np.full(time.size, force), position))


@pytest.mark.parametrize("slow", [False, True])
def test_free_motion_begins_at_a_sharp_release_and_after_a_slow_hand(slow: bool) -> None:
    found = released(slow=slow)
    assert found.kind == "free_decay" and found.standard_form is not None
    onset = found.responses[0].onset
    assert 2.1 < onset < 2.35 if slow else 2.0 <= onset < 2.03
    assert found.standard_form.damping_ratio.value == pytest.approx(0.05, abs=1e-3)
    assert found.standard_form.natural_frequency.value == pytest.approx(20.0, rel=1e-3)


def test_force_that_stays_the_same_leaves_a_free_decay() -> None:
    found = released(slow=False, force=3.0)
    assert found.kind == "free_decay" and found.standard_form is not None and found.standard_form.static_gain is None


def test_drag_makes_damping_fall_with_amplitude_and_dry_friction_makes_it_rise() -> None:
    pytest.importorskip("msd_sim")
    from msd_sim.api import simulate

    def ratios(effect: dict[str, object]) -> list[float]:
        data = simulate({"mass": 1.0, "damping": 1.5, "stiffness": 400.0, "experiment": "release", **effect})
        found = extract(from_samples(data.time, np.zeros(data.time.size), data.position))
        swings = found.responses[0].swings
        assert all(math.isfinite(swing.damping_ratio_std) for swing in swings)
        return [swing.damping_ratio for swing in swings[:6]]

    dry, drag = (
        ratios({"friction_coefficient": 0.02}),
        ratios({"effects": {"quadratic_drag": {"drag_coefficient": 20.0}}}),
    )
    assert dry == sorted(dry) and dry[-1] > 1.1 * dry[0]
    assert drag == sorted(drag, reverse=True) and drag[-1] < 0.9 * drag[0]


def test_a_lag_of_first_order_has_no_natural_frequency() -> None:
    """No reading shows the inertia, so the search for ωn ran away, to 3e12 rad/s."""
    time = np.arange(0.0, 8.0, 5e-3)
    after = [np.maximum(time - at, 0.0) for at in (1.0, 4.5)]
    position = 0.03 * (np.exp(-after[1]) - np.exp(-after[0]))
    noise = 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    force = np.where((time > 1.0) & (time < 4.5), 0.3, 0.0)
    found = extract(from_samples(time, force, position + noise))
    assert found.standard_form is None and found.kind == "none"


def test_an_overdamped_plant_that_the_samples_show_keeps_its_standard_form() -> None:
    rig = Rig(frequency=30.0, ratio=3.0, gain=1e-2)
    form = extract(record(rig, TIME, [(0.5, 4.0), (6.5, 0.0)], noise=5e-6)).standard_form
    assert form is not None and form.natural_frequency.value == pytest.approx(30.0, rel=0.05)


def test_a_cart_that_sticks_as_the_record_begins_is_at_rest() -> None:
    """The record begins with the step, and a coarse encoder shows nothing of the first tenth of the way."""
    time = np.arange(0.0, 8.0, 5e-3)
    clean = record(Rig(frequency=2.04, ratio=0.06, gain=11.3), time, [(0.005, 0.018)])
    step = 2.0 * np.pi / 2048.0
    late = np.roll(clean.position, 14)
    late[:14] = 0.0
    (response,) = extract(replace(clean, position=step * np.round(late / step))).responses
    assert response.form is not None and response.shape is None
    assert response.form.natural_frequency.value == pytest.approx(2.04, rel=0.01)
    assert response.form.static_gain is not None and response.form.static_gain.value == pytest.approx(11.3, rel=0.03)


@pytest.mark.parametrize("seed", range(4))
def test_a_jolt_before_the_motion_is_no_swing_of_it(seed: int) -> None:
    """A drive shakes its sensor as it starts: turning points that shrink, before the slow swing begins."""
    rig = Rig(frequency=2.0, ratio=0.06, gain=11.3)
    time = np.arange(0.0, 20.0, 5e-3)
    rng = np.random.default_rng(seed)
    clean = record(rig, time, [(0.5, 0.018)])
    after = np.maximum(time - 0.5, 0.0)
    shaken = -0.05 * np.exp(-after / 0.08) * np.sin(50.0 * after) + 4e-4 * rng.standard_normal(time.size)
    (response,) = extract(replace(clean, position=clean.position + shaken)).responses
    assert response.form is not None and response.form.natural_frequency.value == pytest.approx(2.0, rel=0.02)
    assert response.turns == () and response.peaks is None


@pytest.mark.parametrize(("noise", "step"), [(0.0, 0.0), (0.02, 0.0), (0.0, 0.05), (0.0, 0.2)])
def test_a_cart_that_moves_evenly_as_the_record_begins_is_not_at_rest(noise: float, step: float) -> None:
    """Whatever hides its first samples; ``noise`` and encoder ``step`` are parts of the way."""
    time = np.arange(0.0, 8.0, 5e-3)
    rested = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        clean = record(Rig(frequency=2.04, ratio=0.06, gain=1.0), time, [(0.005, 1.0)])
        size = rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 0.8)
        moving = clean.position + size * np.exp(-0.12 * time) * np.sin(2.04 * time)
        moving += noise * rng.standard_normal(time.size)
        moving = step * np.round(moving / step) if step else moving
        rested += bool(extract(replace(clean, position=moving)).responses)
    assert rested <= 3, "noise of 2 % hides a start of a few samples"
