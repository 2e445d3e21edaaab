"""Readings that repeat because the encoder was not read again are left out; those of a cart at rest stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.quality import examine
from msd_ident.data.quality.repeats import without_repeats
from msd_ident.data.record import Record
from msd_ident.workflow.identify import identify
from msd_sim.api import simulate


def sweep(rate: float) -> Record:
    found = simulate({"rig": "ecp", "experiment": {"name": "sweep"}, "rate": rate})
    return Record(found.time, found.position, found.time, np.interp(found.time, found.force_time, found.force))


def resampled(slow: Record, times: int, early: int = 0) -> Record:
    """A record of so many times more samples, each value held until the next, the force's so many samples early."""
    time = slow.time[0] + slow.period / times * np.arange(times * slow.samples)
    force = np.roll(np.repeat(slow.force, times), -early)
    return replace(
        slow,
        time=time,
        position=np.repeat(slow.position, times),
        force_time=time,
        force=force,
        hold="linear",
        hold_known=False,
    )


@pytest.mark.parametrize("early", [0, 1, -1])
def test_of_a_resampled_table_the_samples_are_found_again(early: int) -> None:
    slow = sweep(100.0)
    found = without_repeats(resampled(slow, 10, early))
    assert found.every == 10
    assert found.record.samples >= slow.samples - 5
    places = np.rint((found.record.time - slow.time[0]) / slow.period).astype(int)
    assert np.all(np.diff(places) == 1)
    assert np.array_equal(found.record.position, slow.position[places])
    assert np.array_equal(found.record.force_time, found.record.time)
    assert np.array_equal(found.record.force, slow.force[places])


def test_a_force_of_its_own_pace_stays() -> None:
    fast = resampled(sweep(100.0), 10)
    lively = replace(fast, force=np.sin(np.arange(fast.samples)))
    found = without_repeats(lively).record
    assert found.samples < fast.samples // 9 and np.array_equal(found.force, lively.force)
    told = without_repeats(replace(fast, hold_known=True)).record
    assert told.samples < fast.samples // 9 and np.array_equal(told.force_time, fast.force_time)


def test_a_cart_at_rest_keeps_a_reading_for_each_interval() -> None:
    slow = sweep(100.0)
    rest = 300
    position = np.concatenate((np.full(rest, slow.position[0]), slow.position))
    time = slow.time[0] + slow.period * np.arange(position.size)
    force = np.concatenate((np.zeros(rest), slow.force))
    long = replace(slow, time=time, position=position, force_time=time, force=force)
    found = without_repeats(resampled(long, 10))
    assert abs(np.count_nonzero(found.record.time < slow.period * rest) - rest) <= 2


def test_a_lost_reading_of_a_cart_that_moves_on_is_no_rest() -> None:
    slow = sweep(100.0)
    fast = np.argmax(np.abs(np.diff(slow.position)))
    stale = slow.position.copy()
    stale[fast + 1] = stale[fast]
    found = without_repeats(resampled(replace(slow, position=stale), 10)).record
    assert not np.any(np.isclose(found.time, slow.time[fast + 1], atol=0.1 * slow.period))


@given(st.integers(0, 2**31), st.sampled_from([0.0, 1e-6, 1e-5]))
def test_readings_of_every_sample_stay_as_they_are(seed: int, step: float) -> None:
    time = 1e-3 * np.arange(2000)
    position = 0.01 * np.sin(20.0 * time + seed) + 1e-6 * np.random.default_rng(seed).normal(size=time.size)
    record = Record(time, np.round(position / step) * step if step else position, time, np.cos(time))
    found = without_repeats(record)
    assert found.record is record and found.every == 0


def test_parameters_are_those_of_the_samples_that_were_taken() -> None:
    """Held values are 5 ms late on average, which a damping below its true value would make up for."""
    slow = sweep(100.0)
    right = identify([slow]).refined.model.values
    found = identify([resampled(slow, 10)])
    assert found.refined.model.values == pytest.approx(right, rel=0.01)
    (finding,) = [one for one in examine(resampled(slow, 10)).findings if one.code == "held_samples"]
    assert "only every 10 samples (10 ms)" in finding.sentence
    assert "the table was resampled; only new readings are used" in finding.sentence


def read_at(fast: Record, places: np.ndarray) -> Record:
    """The record with each reading held until the next of these places."""
    last = np.maximum(np.searchsorted(places, np.arange(fast.samples), side="right") - 1, 0)
    return replace(fast, position=fast.position[places[last]])


@pytest.mark.parametrize("every", [2, 3, 33])
def test_a_force_of_every_sample_is_kept_however_seldom_the_encoder_is_read(every: int) -> None:
    fast = sweep(1000.0)
    held = read_at(fast, np.arange(0, fast.samples, every))
    found = without_repeats(replace(held, hold="zero", hold_known=False))
    assert found.every == every and np.array_equal(found.record.force, fast.force)
    places = np.searchsorted(fast.time, found.record.time)
    assert np.allclose(found.record.position, fast.position[places], atol=20.0 / 226600)


@pytest.mark.parametrize("usual", [(2, 3), (9, 10, 11)])
def test_a_reading_that_comes_a_sample_early_or_late_is_no_rest(usual: tuple[int, ...]) -> None:
    fast = sweep(1000.0)
    gaps = np.random.default_rng(3).choice(usual, size=fast.samples // usual[0])
    places = np.concatenate(([0], np.cumsum(gaps)))
    found = without_repeats(read_at(fast, places[places < fast.samples])).record
    assert found.samples < 1.1 * fast.samples / np.mean(usual)
    known = np.searchsorted(fast.time, found.time)
    assert np.max(np.abs(found.position - fast.position[known])) < 10.0 / 226600


def test_where_new_readings_come_unevenly_it_is_said_and_all_are_used() -> None:
    fast = sweep(1000.0)
    gaps = np.random.default_rng(3).choice([2, 3, 6], size=fast.samples // 2)
    places = np.concatenate(([0], np.cumsum(gaps)))
    record = read_at(fast, places[places < fast.samples])
    assert without_repeats(record).record is record
    (finding,) = [one for one in examine(record).findings if one.code == "held_samples"]
    assert finding.sentence.endswith("; record it at the rate at which it is read")


def test_a_cart_that_follows_a_staircase_of_the_force_is_read_as_often_as_it_was() -> None:
    levels = np.repeat(10.0 * np.sin(0.3 * np.arange(60)), 10)
    time = 0.1 * np.arange(levels.size)
    record = Record(time, np.round(levels / 0.01) * 1e-4, time, levels, hold="zero", hold_known=False)
    assert without_repeats(record).record is record
