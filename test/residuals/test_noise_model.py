"""What readings are worth, and which part of a record a search may be content with."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.model import Plant, simulate
from msd_ident.residuals.noise_model import Readings, of_record

RATE, KEEP = 200.0, 1500


def record(force: np.ndarray, position: np.ndarray) -> Readings:
    time = np.arange(force.size) / RATE
    return of_record(Record(time=time, position=position, force_time=time, force=force), 1e-6)


def multisine(size: int = 9000) -> np.ndarray:
    time = np.arange(size) / RATE
    phases = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 40)
    return np.asarray(sum(np.sin(2.1 * (n + 10) * time + phase) for n, phase in enumerate(phases)))


def test_a_record_that_goes_on_in_the_same_way_shows_itself_in_a_stretch() -> None:
    force = multisine()
    part = record(force, 0.01 * np.roll(force, 3)).stretch(KEEP)
    assert part.record.samples == KEEP
    assert np.ptp(part.record.position) > 0.8 * 0.01 * np.ptp(force)
    first = int(round(part.record.time[0] * RATE))
    assert np.array_equal(part.record.position, 0.01 * np.roll(force, 3)[first : first + KEEP])


def test_a_decay_and_a_few_steps_and_a_fading_drive_are_kept_whole() -> None:
    time = np.arange(9000) / RATE
    decay = record(np.zeros(9000), np.exp(-0.1 * time) * np.cos(9.0 * time))
    steps = np.sign(np.sin(0.3 * time))
    fading = multisine() * np.exp(-0.1 * time)
    for whole in (decay, record(steps, steps), record(fading, fading)):
        assert whole.stretch(KEEP) is whole


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_line_between_samples_has_impulse_and_first_moment_of_the_force(hold: str) -> None:
    """The force begins inside the record and has stamps of its own: an oracle with ten thousand times as many steps."""
    time = np.linspace(3.0, 4.0, 21)
    stamps = np.sort(np.random.default_rng(5).uniform(3.02, 4.1, 200))
    force = np.random.default_rng(6).standard_normal(200)
    whole = Record(time=time, position=time, force_time=stamps, force=force, hold=hold)
    lines = of_record(whole, 1e-6).with_force_lines().record
    assert lines.force.size == 40 and lines.hold == "linear"
    for first, last in zip(time, time[1:], strict=False):
        at = first + (last - first) * (np.arange(200_000) + 0.5) / 200_000
        exact, line = whole.force_at(at), lines.force_at(at)
        assert np.mean(line) == pytest.approx(np.mean(exact), abs=1e-4)
        assert np.mean(line * (at - first)) == pytest.approx(np.mean(exact * (at - first)), abs=1e-5)


def test_lines_between_samples_move_a_plant_as_the_force_does() -> None:
    """Four forces a sample of a plant with ten samples a swing: mean forces are off by 1.6 % of the motion."""
    stamps = np.arange(8000) / (4.0 * RATE)
    force = np.interp(stamps, np.arange(2000) / RATE, multisine(2000))
    whole = Record(time=stamps[::4], position=stamps[::4], force_time=stamps, force=force)
    lines = of_record(whole, 1e-6).with_force_lines().record
    plant = Plant(1.0, 6.0, (2.0 * np.pi * RATE / 10.0) ** 2)
    exact, few = simulate(plant, whole).position, simulate(plant, lines).position
    assert np.std(few - exact) < 2e-3 * np.std(exact)


def test_a_force_that_changes_less_often_than_the_samples_is_kept() -> None:
    seldom = record(np.repeat(multisine(90), 100), multisine())
    assert seldom.with_force_lines() is seldom


def at_rest(noise: float, seed: int, samples: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Positions that hold still at 20 places between two steps of an encoder of step 1, and their rounded readings."""
    rng = np.random.default_rng(seed)
    position = np.repeat(rng.uniform(0.0, 1.0, 20), samples // 20)
    return position, np.round(position + noise * rng.standard_normal(samples))


def worth(readings: np.ndarray, noise: float) -> Readings:
    """Readings of an encoder of step 1 with the noise of a reading."""
    time = np.arange(readings.size) / RATE
    return of_record(Record(time=time, position=readings, force_time=time, force=0.0 * time), noise, 1.0)


@pytest.mark.parametrize("noise", [0.3, 0.5, 0.8, 1.2, 3.0])
def test_noise_that_dithers_the_encoder_makes_every_sample_a_piece_of_evidence(noise: float) -> None:
    """Chi² of the true motion is the evidence. Counted by runs it was 1.05 to 1.9 times as much."""
    found = []
    for seed in range(10):
        position, readings = at_rest(noise, seed)
        part = worth(readings, float(np.hypot(noise, 1.0 / np.sqrt(12.0))))
        assert part.evidence == readings.size and not part.rounded
        found.append(part.chi(readings - position) / part.evidence)
    assert np.mean(found) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.15])
def test_less_noise_leaves_the_rounding_error_in_every_sample(noise: float) -> None:
    _, readings = at_rest(noise, 1)
    part = worth(readings, float(np.hypot(noise, 1.0 / np.sqrt(12.0))))
    assert part.evidence < 0.5 * readings.size and part.rounded
    assert part.evidence == 1 + np.count_nonzero(np.diff(readings))


def test_an_encoder_that_rests_on_one_reading_is_not_dithered_whatever_its_noise_is_thought_to_be() -> None:
    _, readings = at_rest(0.8, 1)
    readings[1000:1100] = readings[1000]
    part = worth(readings, 0.85)
    assert part.evidence == 1 + np.count_nonzero(np.diff(readings))
    assert part.weight[1050] == pytest.approx(0.01, rel=0.1)
