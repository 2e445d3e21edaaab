"""Findings before any fit: each fault is found with its numbers, and a clean record has none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim

from msd_ident.data.motion import observe
from msd_ident.data.quality import (
    Finding,
    check,
    encoder,
    encoder_step,
    force_unknown,
    missing_in,
    missing_samples,
    noise_floor,
)
from msd_ident.data.record import FloatArray, Record, from_samples
from msd_ident.data.streams import from_seconds
from msd_ident.io import SourceOptions, read
from msd_sim.api import simulate

STEP = 1 / 226600  # of the ECP plant's encoder [m]


@cache
def experiment(name: str = "paper", rig: str = "ecp", rate: float = 1000.0, start: float = 0.5) -> Record:
    options = {"name": name, "start": start} if name in ("paper", "steps") else {"name": name}
    found = simulate({"rig": rig, "experiment": options, "rate": rate})
    return Record(found.time, found.position, found.force_time, found.force, found.hold)


def serious(record: Record) -> list[Finding]:
    return [finding for finding in check(record) if finding.severity != "info"]


def only(record: Record) -> Finding:
    """The one warning or error of a record."""
    findings = serious(record)
    assert len(findings) == 1, [finding.sentence for finding in findings]
    return findings[0]


def keep(record: Record, places: np.ndarray) -> Record:
    return replace(record, time=record.time[places], position=record.position[places])


@pytest.mark.parametrize("rig", ["ecp", "sticky", "backlash", "end_stop", "odd"])
@pytest.mark.parametrize("name", ["paper", "steps", "release", "sweep", "ramp", "random_steps"])
def test_clean_rigs_have_no_findings(rig: str, name: str) -> None:
    findings = check(experiment(name, rig, rate=500.0))
    assert [finding.code for finding in findings] == (["free_decay"] if name == "release" else [])


@pytest.mark.parametrize("name", ["step_1", "step_2", "release_1"])
def test_a_measured_plant_has_no_findings(shared_data: Path, name: str) -> None:
    options = SourceOptions(force="control_effort_v", position="encoder_counts", position_scale=-1 / 56000)
    record = read(shared_data / "ecp210" / f"{name}.csv", options)
    assert serious(record) == []
    assert encoder_step(record) == pytest.approx(1 / 56000, rel=1e-9)
    assert noise_floor(record) == pytest.approx(1 / 56000 / np.sqrt(12), rel=0.2)
    assert missing_samples(record) == 0


def test_a_measured_axis_has_no_findings(shared_data: Path) -> None:
    record = read(shared_data / "emps" / "emps_train.csv")
    assert check(record) == ()
    assert encoder_step(record) == pytest.approx(5e-8, rel=1e-6)


# Clean records of random plants, from the closed form of the step response.


def response(time: FloatArray, omega: float, zeta: float) -> FloatArray:
    """Answer of x''/ω² + 2ζ/ω x' + x to a unit step at 0 (ζ < 1)."""
    t = np.maximum(time, 0.0)
    damped = omega * np.sqrt(1 - zeta**2)
    decay = np.exp(-zeta * omega * t)
    return 1 - decay * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))


@st.composite
def clean_records(draw: st.DrawFn) -> tuple[Record, float]:
    """A record of a plant that forces of several levels push, and the standard deviation of its noise."""
    omega = draw(st.floats(5.0, 100.0))
    zeta = draw(st.floats(0.005, 0.95))
    travel = draw(st.floats(1e-3, 0.2))
    mass = draw(st.floats(0.05, 50.0))
    rate = omega / (2 * np.pi) * draw(st.floats(16.0, 300.0))
    time = np.arange(draw(st.integers(800, 3000))) / rate
    levels = draw(st.lists(st.sampled_from([-1.0, -0.3, 0.3, 0.7, 1.0]), min_size=1, max_size=4))
    onsets = time[-1] * (0.05 + 0.95 * np.arange(len(levels)) / len(levels))
    jumps = np.diff([0.0, *levels])
    position = travel * sum(j * response(time - t0, omega, zeta) for j, t0 in zip(jumps, onsets, strict=True))
    noise = travel * draw(st.sampled_from([0.0, 1e-4, 1e-3, 3e-3]))
    step = travel * draw(st.sampled_from([0.0, 1 / 3000, 1 / 200]))
    if not noise and not step:
        noise = 1e-5 * travel
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    position = position + noise * rng.standard_normal(time.size)
    if step:
        position = np.round(position / step) * step
    force = travel * mass * omega**2 * np.array(levels)
    return Record(time, position, onsets, force), float(np.hypot(noise, step / np.sqrt(12)))


@given(case=clean_records())
def test_clean_records_have_no_findings(case: tuple[Record, float]) -> None:
    record, _ = case
    assert [finding.sentence for finding in check(record)] == []
    assert missing_samples(record) == 0


@given(case=clean_records())
def test_the_noise_floor_is_that_of_the_noise(case: tuple[Record, float]) -> None:
    record, truth = case
    assert 0.7 * truth < noise_floor(record) < 1.3 * truth


@given(case=clean_records(), shift=st.floats(-1.0, 1.0), scale=st.sampled_from([1e-3, 0.3, -1.0, 56000.0]))
def test_step_and_floor_scale_with_the_unit_and_not_with_the_zero(
    case: tuple[Record, float], shift: float, scale: float
) -> None:
    record, _ = case
    moved = replace(record, position=scale * (record.position + shift))
    assert encoder_step(moved) == pytest.approx(abs(scale) * encoder_step(record), rel=1e-6)
    assert noise_floor(moved) == pytest.approx(abs(scale) * noise_floor(record), rel=0.05)


@given(
    step=st.floats(1e-9, 1e3),
    offset=st.floats(-100.0, 100.0),
    counts=st.lists(st.integers(-500, 500), min_size=20, max_size=200),
)
def test_the_encoder_step_is_found_where_neighbouring_counts_occur(
    step: float, offset: float, counts: list[int]
) -> None:
    counts = [*counts, 0, 1, 2]
    position = step * (offset + np.array(counts, dtype=np.float64))
    record = from_samples(np.arange(len(counts)) / 100, np.zeros(len(counts)), position)
    assert encoder_step(record) == pytest.approx(step, rel=1e-6)


@given(seed=st.integers(0, 2**32))
def test_readings_off_any_grid_have_no_step(seed: int) -> None:
    position = np.random.default_rng(seed).standard_normal(300)
    assert encoder_step(from_samples(np.arange(300) / 100, np.zeros(300), position)) == 0.0


def test_rounded_print_does_not_hide_the_step() -> None:
    """A step of 4.413 µm in a file with 8 decimals."""
    record = experiment()
    printed = replace(record, position=np.round(record.position, 8))
    assert encoder_step(printed) == pytest.approx(STEP, rel=2e-3)


def test_the_floor_at_rest_is_that_of_the_encoder() -> None:
    record = experiment()
    assert noise_floor(record) == pytest.approx(STEP / np.sqrt(12), rel=0.05)


# One fault each.


@given(seed=st.integers(0, 1000), lost=st.integers(1, 600))
def test_missing_samples_are_counted(seed: int, lost: int) -> None:
    record = experiment()
    places = np.sort(np.random.default_rng(seed).permutation(np.arange(1, record.samples - 1))[: record.samples - lost])
    places = np.union1d(places, [0, record.samples - 1])
    sparse = keep(record, places)
    missing = record.samples - sparse.samples
    assert missing_samples(sparse) == missing
    found = check(sparse)
    assert [finding.code for finding in found] == (["missing_samples"] if missing else [])
    if missing:
        assert f"{missing} of 6500 samples" in found[0].sentence


def test_a_gap_is_shown_with_its_place() -> None:
    record = experiment()
    finding = only(keep(record, np.flatnonzero((record.time < 2.0) | (record.time > 2.5))))
    assert finding.code == "missing_samples"
    assert "501 of 6500 samples (7.7 %) are missing (1 gap, the longest 0.502 s at 1.999 s)" in finding.sentence


def test_a_single_lost_sample_is_no_warning() -> None:
    record = experiment()
    (finding,) = check(keep(record, np.delete(np.arange(record.samples), 700)))
    assert (finding.severity, finding.code) == ("info", "missing_samples")


def test_jitter_is_told() -> None:
    record = experiment()
    rng = np.random.default_rng(1)
    jittery = replace(record, time=record.time + rng.uniform(-4e-4, 4e-4, record.samples))
    finding = next(finding for finding in check(jittery) if finding.code == "jitter")
    assert finding.severity == "warning"
    assert "around 1 ms" in finding.sentence or "around 0.99" in finding.sentence or "around 1.00" in finding.sentence
    slight = replace(record, time=record.time + rng.uniform(-1e-4, 1e-4, record.samples))
    (finding,) = [finding for finding in check(slight) if finding.code == "jitter"]
    assert finding.severity == "info"
    assert missing_samples(slight) == 0


def test_a_rate_that_changes_is_told() -> None:
    record = experiment()
    finding = only(keep(record, np.union1d(np.arange(3000), np.arange(3000, 6000, 5))))
    assert finding.code == "two_rates"
    assert "200 Hz" in finding.sentence
    assert "1000 Hz" in finding.sentence


def test_samples_in_pairs_are_told_as_that() -> None:
    """Every third message without a position was "mixed: 33.33 Hz and 33.33 Hz"."""
    record = experiment()
    finding = only(keep(record, np.flatnonzero(np.arange(record.samples) % 3)))
    assert finding.code == "two_rates"
    assert finding.sentence == (
        "samples come in pairs: two sources take turns, at 333.3 Hz and 333.3 Hz, or every third sample is lost: check "
        "that one source alone gives the position, and that each of its messages holds it"
    )


def test_stamps_that_scatter_in_long_runs_are_no_second_rate() -> None:
    """Intervals of a measured joint, 0.7 to 1.8 ms around 1 ms, were called 1000 Hz and 714 Hz."""
    record, rng = experiment(), np.random.default_rng(4)
    slow = np.repeat(rng.random(record.samples // 15 + 1) < 0.1, 15)[: record.samples - 1]
    intervals = 1e-3 * np.where(slow, rng.uniform(1.26, 1.6, slow.size), rng.uniform(0.8, 1.25, slow.size))
    time = np.concatenate(([0.0], np.cumsum(intervals)))
    codes = [one.code for one in check(keep(replace(record, time=time), np.arange(time.size)))]
    assert "two_rates" not in codes and "jitter" in codes


def test_a_second_rate_is_told_beside_lost_samples() -> None:
    record, rng = experiment(), np.random.default_rng(4)
    kept = np.union1d(np.flatnonzero(rng.random(record.samples) > 0.03), [0])
    kept = np.union1d(kept[kept < 5000], np.arange(5000, record.samples, 3))
    assert "two_rates" in [one.code for one in check(keep(record, kept))]


@pytest.mark.parametrize(("every", "words"), [(10, ["1000 Hz", "100 Hz"]), (1, ["1000 Hz and 1000 Hz"])])
def test_two_publishers_on_one_topic_are_told(every: int, words: list[str]) -> None:
    record = experiment()
    other = record.time[:-1:every] + 3e-4
    time = np.concatenate([record.time, other])
    order = np.argsort(time)
    between = STEP * np.round(np.interp(other, record.time, record.position) / STEP)
    position = np.concatenate([record.position, between])[order]
    finding = only(replace(record, time=time[order], position=position))
    assert finding.code == "two_rates"
    for word in words:
        assert word in finding.sentence


def test_a_clipped_encoder_is_told() -> None:
    record = experiment()
    highest = STEP * np.round(0.018 / STEP)
    finding = only(replace(record, position=np.minimum(record.position, highest)))
    assert finding.code == "clipped_position"
    assert f"stops dead at {highest:.4g} m, the end of its range" in finding.sentence


@pytest.mark.parametrize(("then", "codes"), [(0.0, []), (6.0, ["clipped_position"])])
def test_a_motor_that_is_switched_off_hits_no_stop(then: float, codes: list[str]) -> None:
    """Behind a gear it stands within a sample, at the farthest place that it came to: a stop was told."""
    time = np.arange(0.0, 12.0, 0.01)
    drive = np.where(time < 2.0, 0.0, np.where(time < 8.0, 6.0, then))
    driven = np.clip(time - 2.0, 0.0, 6.0)
    begun = 8.0 * driven - 0.8 * (1.0 - np.exp(-10.0 * driven))
    turned = 0.0005 * np.round((begun + 0.01 * np.sin(9.0 * driven)) / 0.0005)
    motor = Record(time, turned, time, drive, force_unit="V", position_unit="rad")
    assert [one.code for one in check(motor) if "position" in one.code] == codes


def test_a_clipped_encoder_is_told_under_a_force_that_switches() -> None:
    """A force that falls just as the readings stop, and comes again while they stand, is no motor's that goes away."""
    time = 0.002 * np.arange(6000)
    rng = np.random.default_rng(8)
    told = 0
    for _ in range(10):
        force = np.repeat(rng.choice([-4.0, 4.0], 400), 15) + 3.0 * np.sin(2.0 * time)
        moved = lsim(([1.0], [0.5, 1.5, 60.0]), force, time)[1]
        seen = 1e-6 * np.round(np.minimum(moved, 0.6 * np.max(moved)) / 1e-6)
        told += "clipped_position" in [one.code for one in check(from_samples(time, force, seen))]
    assert told == 10


def test_a_stop_that_gives_way_a_little_is_the_end_of_the_range() -> None:
    """A cart rests on a soft stop, deeper at first: the encoder is not stuck in the middle of a motion."""
    record = experiment()
    stop, span = STEP * np.round(0.018 / STEP), float(np.ptp(record.position))
    position = np.minimum(record.position, stop)
    position[np.argmax(record.position > stop)] = stop + STEP * np.floor(0.005 * span / STEP)
    assert only(replace(record, position=position)).code == "clipped_position"


def test_a_stuck_encoder_is_told() -> None:
    record = experiment()
    position = record.position.copy()
    position[1050:1090] = position[1050]
    finding = only(replace(record, position=position))
    assert finding.code == "stuck_position"
    assert "for 0.04 s from 1.050 s on" in finding.sentence
    assert "the encoder is stuck or not read, or something holds the cart" in finding.sentence


def test_a_cart_that_sticks_is_no_stuck_encoder() -> None:
    codes = {finding.code for name in ("paper", "steps") for finding in check(experiment(name, "sticky"))}
    assert codes == set()


def test_an_encoder_that_is_read_too_seldom_is_told() -> None:
    record = experiment("sweep")
    finding = only(replace(record, position=np.repeat(record.position[::10], 10)[: record.samples]))
    assert finding.code == "held_samples"
    assert "only every 10 samples (10 ms)" in finding.sentence


def test_an_encoder_that_is_read_at_half_the_rate_is_told() -> None:
    record = uneven(np.zeros(4000, dtype=bool))
    finding = only(replace(record, position=np.repeat(record.position[::2], 2)))
    assert finding.code == "held_samples"
    assert "only every 2 samples (2 ms)" in finding.sentence


@pytest.mark.parametrize("share", [0.03, 0.06, 0.2])
def test_readings_that_repeat_now_and_then_are_no_encoder_that_is_read_too_seldom(share: float) -> None:
    record = uneven(np.random.default_rng(4).random(4000) < share)
    assert np.mean(np.diff(record.position) == 0.0) > 0.5 * share
    assert "held_samples" not in [finding.code for finding in check(record)]


def uneven(repeated: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Record:
    """A free decay of 4 s at 1 kHz, read without steps, in which the marked (4000,) readings repeat the one before."""
    time = 1e-3 * np.arange(4000)
    position = 0.05 * np.exp(-0.3 * time) * np.cos(9.0 * time)
    source = np.maximum.accumulate(np.where(repeated, 0, np.arange(4000)))
    return Record(time=time, position=position[source], force_time=time[:1], force=np.zeros(1))


def test_a_rate_too_low_for_the_motion_is_told() -> None:
    finding = only(experiment(rate=36.0))
    assert finding.code == "low_rate"
    assert "one oscillation of 0.2" in finding.sentence
    assert "8.5 samples; expected 12 or more" in finding.sentence or "8.0 samples" in finding.sentence


def test_a_rate_a_little_too_low_is_not_told_as_high_enough() -> None:
    """It was said that there are "only 12.0 samples; expected 12 or more"."""
    motion = replace(observe(experiment()), half_period=0.1)
    few = replace(experiment(), time=experiment().time * (0.2 / 11.96) / experiment().period)
    (finding,) = encoder.rate(few, motion)
    assert "only 11.9 samples; expected 12 or more" in finding.sentence


def test_the_rate_that_is_asked_for_is_above_that_of_the_record() -> None:
    """20.03 Hz were rounded to the 20 Hz that the record has."""
    motion = replace(observe(experiment()), half_period=0.2995)
    few = replace(experiment(), time=experiment().time * 0.05 / experiment().period)
    (finding,) = encoder.rate(few, motion)
    assert finding.sentence.endswith("only 11.9 samples; expected 12 or more: sample at 20.1 Hz or faster")
    (finding,) = encoder.rate(few, replace(motion, half_period=0.25))
    assert finding.sentence.endswith("expected 12 or more: sample at 24 Hz or faster")


def test_twelve_samples_but_for_rounding_are_enough() -> None:
    """A record of 20 Hz with an oscillation of 0.6 s was told "only 11.9 samples"."""
    few = replace(experiment(), time=experiment().time * 0.05 / experiment().period)
    motion = replace(observe(experiment()), half_period=0.3 * (1.0 - 1e-12))
    assert list(encoder.rate(few, motion)) == []


def test_a_position_that_never_changes_is_an_error() -> None:
    record = experiment()
    findings = check(replace(record, position=np.full(record.samples, 0.25)))
    assert [(finding.severity, finding.code) for finding in findings] == [("error", "constant_position")]
    assert "never changes (0.25 m in all 6500 samples)" in findings[0].sentence


def test_no_excitation_is_an_error() -> None:
    record = experiment("rest", "sticky")
    (finding,) = check(record)
    assert (finding.severity, finding.code) == ("error", "no_excitation")
    pushed = replace(record, force=np.array([0.0, 0.5]), force_time=np.array([0.0, 1.0]))
    (finding,) = check(pushed)
    assert (finding.severity, finding.code) == ("error", "no_motion")
    assert "the force changes by 0.5 N" in finding.sentence


def test_swapped_columns_are_asked_about() -> None:
    found = simulate({"rig": "ecp", "experiment": {"name": "steps", "force": 8.0, "fraction": 1.0}})
    record = Record(found.time, found.position, found.force_time, found.force, found.hold)
    (finding,) = check(from_samples(record.time, record.position, record.force_at(record.time)))
    assert (finding.severity, finding.code) == ("error", "no_motion")
    assert "the position jumps within 16 m and stays where it is in between" in finding.sentence
    assert "are the two swapped? Name them with --force and --position" in finding.sentence
    assert "noise" not in finding.sentence


def test_the_steps_of_a_swapped_force_are_no_jumps_of_the_zero() -> None:
    """Up to three of them were taken back, each with a warning, and the rest was told as the whole."""
    time = np.arange(1600) * 5e-3
    force = np.select([time < 1.0, time < 2.0, time < 3.0, time < 4.0], [10.425, 0.0, -10.425, 0.0], 3.1275)
    motion = 0.015 * np.sin(3.0 * time) * np.exp(-0.2 * time)
    (finding,) = check(from_samples(time, motion, force))
    assert (finding.severity, finding.code) == ("error", "no_motion")
    assert "the position jumps within 20.9 m" in finding.sentence and "are the two swapped?" in finding.sentence


def test_an_encoder_that_flickers_under_a_smooth_force_is_not_called_swapped() -> None:
    record = experiment("sweep", "ecp")
    force = record.force_at(record.time)
    still = np.where(force > 0.9 * force.max(), STEP, 0.0)
    (finding,) = check(from_samples(record.time, force, still))
    assert "which is noise: push harder, or check the encoder" in finding.sentence


def test_a_free_decay_is_told() -> None:
    (finding,) = check(experiment("release"))
    assert (finding.severity, finding.code) == ("info", "free_decay")
    assert "the force is zero all the time" in finding.sentence


@pytest.mark.parametrize(
    ("scale", "words"),
    [
        (1000.0, ["spans 37.97 m", "factor of 1000", "in millimetres, use --position-scale 0.001"]),
        (0.001, ["spans 3.797e-05 m", "factor of 1000", "1000 times larger"]),
    ],
)
def test_a_unit_that_is_wrong_by_1000_is_told_with_the_number(scale: float, words: list[str]) -> None:
    record = experiment()
    finding = only(replace(record, position=scale * record.position))
    assert (finding.severity, finding.code) == ("warning", "wrong_unit")
    for word in words:
        assert word in finding.sentence


def test_a_small_motion_in_millimetres_is_told_by_its_mass() -> None:
    record = experiment()
    finding = only(replace(record, position=50.0 * record.position, force=0.05 * record.force))
    assert finding.code == "wrong_unit"
    assert "the moving mass is about 0.000" in finding.sentence


def turning(position: FloatArray, force: FloatArray | None = None) -> list[str]:
    """Sentences on the unit of an angle (n,), sampled at 100 Hz."""
    time = np.arange(position.size) / 100
    of_force = (time[:1], np.zeros(1)) if force is None else (time, force)
    record = Record(time, position, *of_force, force_unit="N·m", position_unit="rad")
    return [finding.sentence for finding in check(record) if finding.code == "wrong_unit"]


SECONDS = np.arange(3000) / 100


def test_degrees_that_are_taken_for_radians_are_told() -> None:
    """A pendulum's swings of ± 117 degrees, alone or under a torque that was switched on before."""
    decay = 117.0 * np.exp(-0.05 * SECONDS) * np.cos(4.0 * SECONDS)
    (sentence,) = turning(decay)
    assert "spans 229.5 rad, 37 turns, and swings to and fro under one force: is it in degrees?" in sentence
    assert sentence.endswith("use --position-unit deg")
    assert turning(decay, 0.5 * (SECONDS > 1.0)) == [sentence]
    assert turning(np.deg2rad(decay)) == []


def test_a_shaft_that_turns_far_is_not_told_that_it_is_in_degrees() -> None:
    """One that spins, one that a motor turns to and fro, and one that is held by a controller's force."""
    assert turning(80.0 * (1.0 - np.exp(-0.2 * SECONDS))) == []
    assert turning(20.0 * SECONDS + 0.3 * np.sin(9.0 * SECONDS), np.sign(np.sin(0.5 * SECONDS))) == []
    assert turning(100.0 * np.sin(SECONDS), np.sign(np.cos(SECONDS))) == []
    assert turning(100.0 * np.sin(SECONDS), -np.sin(SECONDS)) == []


@pytest.mark.parametrize(("shift", "words"), [(0.1, "moves 0.08"), (-0.2, "only 0.21")])
def test_clocks_apart_are_told(shift: float, words: str) -> None:
    record = experiment()
    finding = only(replace(record, force_time=record.force_time + shift))
    assert finding.code == "clocks_apart"
    assert words in finding.sentence


def test_motion_before_the_first_sample_of_the_force_is_told() -> None:
    """A command that was sent again and again, and recorded from its second message on."""
    record = experiment()
    known = record.force_time > 1.5
    late = replace(record, force_time=record.force_time[known], force=record.force[known] + 10.0)
    (finding,) = [one for one in check(late) if one.code == "force_unknown"]
    comes = late.force_time[0] - late.time[0]
    assert f"moves before the first sample of the force, which comes at {comes:.3f} s" in finding.sentence
    assert force_unknown([finding]) and not force_unknown(check(record))


def test_motion_as_the_first_sample_of_the_force_comes_is_told() -> None:
    """A cart that a force held before the recording, and that the first message lets go."""
    record = experiment()
    moved = check(record)
    onset = observe(record).onset
    freed = replace(record, force_time=np.array([onset - 0.004, onset + 2.0]), force=np.array([0.0, 9.0]))
    (finding,) = [one for one in check(freed) if one.code == "force_unknown"]
    comes = (
        f"the cart moves when the first sample of the force comes, at {onset - 0.004 - record.time[0]:.3f} s with 0 N"
    )
    assert finding.sentence.startswith(comes) and "begin with --start at that time" in finding.sentence
    assert not force_unknown(moved) and not [one for one in check(freed) if one.code == "clocks_apart"]


@pytest.mark.parametrize("evenly", [True, False])
def test_a_hole_in_a_force_that_is_sent_all_the_time_is_told(evenly: bool) -> None:
    record = experiment()
    sent = np.arange(record.time[0], record.time[-1], 0.002)
    kept = (sent < 2.0) | (sent > 2.8)
    if not evenly:
        kept &= np.random.default_rng(1).random(sent.size) < 0.3
    lost = replace(record, force_time=sent[kept], force=record.force_at(sent[kept]))
    found = [one for one in check(lost) if one.code == "force_missing"]
    if not evenly:
        assert not found
        return
    assert found[0].severity == "warning"
    first = sent[sent < 2.0][-1] - record.time[0]
    assert f"no sample of the force comes from {first:.3f} to " in found[0].sentence
    assert "where 500 a second come else: it is taken as " in found[0].sentence
    whole = replace(lost, force_time=sent, force=record.force_at(sent))
    assert not [one for one in check(whole) if one.code == "force_missing"]
    assert not [one for one in check(record) if one.code == "force_missing"]


def test_a_force_for_half_of_the_time_is_told() -> None:
    record = experiment()
    time = record.time[: record.samples // 2]
    finding = only(replace(record, force_time=time, force=record.force_at(time)))
    assert finding.code == "partial_overlap"
    assert "the force ends before the position by 3.250 s of 6.499 s" in finding.sentence


def test_a_motion_of_few_steps_is_told() -> None:
    record = experiment()
    coarse = 0.003
    finding = only(replace(record, position=coarse * np.round(record.position / coarse)))
    assert finding.code == "coarse_encoder"
    assert "13 encoder steps of 0.003 m" in finding.sentence


def test_a_motion_in_much_noise_is_told() -> None:
    record = experiment()
    noise = 0.002 * np.random.default_rng(3).standard_normal(record.samples)
    finding = only(replace(record, position=record.position + noise))
    assert finding.code == "noisy_position"
    assert "times the measurement noise of 0.00" in finding.sentence


def test_errors_come_first() -> None:
    record = experiment("rest", "sticky")
    holes = keep(record, np.flatnonzero((record.time < 0.5) | (record.time > 1.0)))
    assert [finding.severity for finding in check(holes)] == ["error", "warning"]


def test_long_records_are_checked_quickly_enough_to_do_it_always() -> None:
    """Two hundred thousand samples: what costs as their square would take minutes."""
    t = np.arange(200_000) / 1000
    rng = np.random.default_rng(0)
    record = from_samples(t, np.sign(np.sin(t)), np.sin(t) + 1e-3 * rng.standard_normal(t.size))
    assert serious(record) == []


def test_missing_samples_of_any_train_of_stamps() -> None:
    regular = np.arange(100) * 0.01
    assert missing_in(regular) == 0
    assert missing_in(np.delete(regular, [10, 50, 51])) == 3
    assert missing_in(np.array([0.0, 0.1, 3.1, 9.0])) == 0, "a force that is sent when it changes"
    assert missing_in(np.array([0.0, 5.0])) == missing_in(np.zeros(1)) == 0


def test_stamps_that_many_samples_share_are_the_reason_and_not_the_push() -> None:
    """Of 400 samples on a clock of 0.1 s twenty were left: "push harder" was said of a swing of 36 mm."""
    time = 0.005 * np.arange(400)
    swing = 0.018 * np.cos(27.0 * time)
    coarse = from_seconds(np.floor(time / 0.1 + 1e-9) * 0.1, swing, [0.0, 1.0], [10.0, 0.0])
    said = [one.sentence for one in check(coarse) if one.code == "no_motion"]
    assert len(said) == 1 and "20 samples that have stamps of their own are too few to tell the motion" in said[0]
    assert "their clock ticks every 0.1 s" in said[0] and "push harder" not in said[0]
    finer = from_seconds(np.floor(time / 0.04 + 1e-9) * 0.04, swing, [0.0, 1.0], [10.0, 0.0])
    (low,) = [one.sentence for one in check(finer) if one.code == "low_rate"]
    assert low.endswith("the others were dropped, because they share their stamps: give each sample one of its own")
