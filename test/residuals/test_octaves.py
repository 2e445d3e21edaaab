"""Sums of squares octave by octave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record
from msd_ident.residuals.octaves import BANDS, octaves


def swinging(samples: int, swings: float, duration: float = 10.0) -> Record:
    time = np.linspace(0.0, duration, samples, endpoint=False)
    position = np.sin(2.0 * np.pi * swings * time / duration)
    return Record(time, position, time[:1], np.zeros(1))


@given(st.integers(60, 700), st.floats(3.0, 12.0), st.integers(0, 2**31))
def test_bands_share_all_that_is_left_and_all_that_noise_can(samples: int, swings: float, seed: int) -> None:
    found = octaves(swinging(samples, swings))
    residual = np.random.default_rng(seed).normal(size=samples)
    assert found.of(residual).sum() == pytest.approx(residual @ residual)
    assert found.share.sum() == pytest.approx(1.0) and found.share.shape == (BANDS,)


TIMES = (0.1, 0.3, 0.7, 1.5, 3.0, 6.0, 12.0, 20.0)


@pytest.mark.parametrize(("band", "times"), list(enumerate(TIMES)))
def test_a_band_is_an_octave_above_the_frequency_of_the_motion(band: int, times: float) -> None:
    record = swinging(4000, 20.0)
    residual = np.sin(2.0 * np.pi * 20.0 * times * record.time / 10.0)
    left = octaves(record).of(residual)
    assert np.argmax(left) == band and left[band] > 0.99 * left.sum()


def test_only_the_ratio_of_frequencies_counts() -> None:
    slow, fast = octaves(swinging(1000, 7.0)), octaves(swinging(1000, 7.0, 0.01))
    assert np.array_equal(slow.band, fast.band)


def test_a_rest_adds_no_swing() -> None:
    moved = swinging(4000, 20.0)
    position = np.concatenate([moved.position, np.zeros(36_000)])
    rested = Record(np.linspace(0.0, 100.0, position.size, endpoint=False), position, moved.force_time, moved.force)
    assert octaves(moved).swings == pytest.approx(20.0, abs=1.0)
    assert octaves(rested).swings == pytest.approx(200.0, abs=10.0)  # periods of the same length


def test_noise_is_shared_by_width() -> None:
    found = octaves(swinging(4001, 20.0))
    left = np.mean([found.of(np.random.default_rng(seed).normal(size=4001)) for seed in range(200)], axis=0)
    assert left == pytest.approx(4001 * found.share, rel=0.05)


@pytest.mark.parametrize("noise", [1e-3, 1e-2, 0.1, 0.3])
def test_noise_does_not_make_the_motion_faster(noise: float) -> None:
    """Differences of neighbouring samples magnify what is fast."""
    quiet = swinging(6000, 18.0)
    noisy = replace(quiet, position=quiet.position + noise * np.random.default_rng(1).normal(size=6000))
    assert np.array_equal(octaves(noisy).band, octaves(quiet).band)
