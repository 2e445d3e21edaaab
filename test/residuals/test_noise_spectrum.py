"""Level and colour of the noise in a residual."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import FloatArray, Record
from msd_ident.residuals.noise_model import Readings, of_record
from msd_ident.residuals.noise_spectrum import NoiseSpectrum, estimate, heard_floor, only_noise

SAMPLES = 6000
TIME = np.arange(SAMPLES) / 1000.0
MOTION = np.sin(2.0 * np.pi * 3.0 * TIME)


def readings(samples: int = SAMPLES, noise: float = 1e-3) -> Readings:
    rough = np.random.default_rng(0).normal(size=samples)
    record = Record(TIME[:samples], MOTION[:samples] + noise * rough, TIME[:1], np.zeros(1))
    return of_record(record, noise)


def noise(memory: float, seed: int = 1, samples: int = SAMPLES) -> FloatArray:
    """Autoregressive noise of unit variance with this memory [samples]."""
    keep = math.exp(-1.0 / memory) if memory else 0.0
    draws = np.random.default_rng(seed).normal(size=samples + 500)
    return np.asarray(scipy.signal.lfilter([math.sqrt(1.0 - keep**2)], [1.0, -keep], draws)[500:])


def found_in(*residuals: FloatArray) -> NoiseSpectrum:
    """The noise in residuals of readings that hold it; ``readings`` tells its size."""
    found = estimate(residuals, [containing(one) for one in residuals])
    assert found is not None
    return found


def containing(residual: FloatArray, size: float = 1e-5) -> Readings:
    """Readings with this in them, in units of what they tell of their noise."""
    told = readings(residual.size, size)
    return replace(told, record=replace(told.record, position=MOTION[: residual.size] + size * residual))


@given(st.floats(0.1, 30.0), st.integers(0, 2**31))
def test_white_noise_of_any_size_is_white(size: float, seed: int) -> None:
    found = found_in(size * noise(0.0, seed))
    assert found.memory == 0.0 and found.white == 1.0
    assert found.level == pytest.approx(size**2, rel=0.15)
    assert found.size == pytest.approx(found.level)
    assert found.growth == pytest.approx(math.sqrt(found.level))
    assert found.freedom.sum() == pytest.approx(SAMPLES)


@pytest.mark.parametrize("memory", [1.0, 3.0, 10.0, 20.0])
@pytest.mark.parametrize("error", [0.0, 3.0])
def test_memory_is_found_also_beside_the_error_of_a_law(memory: float, error: float) -> None:
    left = error * (MOTION + 0.6 * np.sin(2.0 * np.pi * 9.0 * TIME))
    found = [found_in(noise(memory, seed) + left) for seed in range(5)]
    assert np.median([one.memory for one in found]) == pytest.approx(memory, rel=0.35)
    assert np.median([one.growth for one in found]) == pytest.approx(1.0, rel=0.15)
    slowest = (1.0 + math.exp(-1.0 / memory)) / (1.0 - math.exp(-1.0 / memory))
    assert np.median([one.size[0] for one in found]) == pytest.approx(slowest, rel=0.35)


@given(st.sampled_from([0.0, 5.0]), st.floats(0.01, 100.0))
def test_it_has_no_sign_and_scales_with_its_square(memory: float, size: float) -> None:
    one, other = found_in(noise(memory)), found_in(-size * noise(memory))
    assert (one.memory, one.white) == (other.memory, other.white)
    assert other.left == pytest.approx(size**2 * one.left)


@pytest.mark.parametrize("memory", [0.0, 4.0, 16.0])
def test_whitened_noise_is_white_and_as_large_as_the_readings_noise(memory: float) -> None:
    left = noise(memory)
    white = found_in(left).whitened(left)
    assert np.std(white) == pytest.approx(1.0, rel=0.05)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.05
    assert found_in(white).memory == 0.0


def test_the_error_of_a_law_in_white_noise_is_not_called_noise() -> None:
    for size in (1.0, 10.0, 100.0):
        found = found_in(noise(0.0) + size * np.exp(-TIME) * MOTION)
        assert found.memory == 0.0 and found.level == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("hertz", [40.0, 60.0, 150.0])
def test_a_motion_that_rings_is_not_called_noise(hertz: float) -> None:
    """A second mass that every step of the force strikes: its peak was taken for noise of 30 times the readings'."""
    rng = np.random.default_rng(4)
    blows = np.zeros(SAMPLES)
    blows[rng.integers(0, SAMPLES, 15)] = rng.choice([-1.0, 1.0], 15)
    pole = np.exp((-0.02 + 1j) * 2.0 * np.pi * hertz / 1000.0)
    ringing = np.real(scipy.signal.lfilter([1.0], [1.0, -pole], blows))
    residual = 30.0 * ringing / np.std(ringing) + rng.standard_normal(SAMPLES)
    assert only_noise([residual], [containing(residual)]) is None


@pytest.mark.parametrize(("records", "samples"), [(6, 100), (20, 60)])
def test_white_noise_of_many_short_records_is_noise(records: int, samples: int) -> None:
    """In bins of few samples chance alone makes power that differs from its mean."""
    told = 0
    for seed in range(20):
        parts = [3.0 * noise(0.0, 100 * seed + r, samples) for r in range(records)]
        told += only_noise(parts, [containing(one) for one in parts]) is not None
    assert told == 20


def test_records_of_one_sensor_share_their_noise() -> None:
    together = found_in(noise(8.0, 1), noise(8.0, 2), noise(8.0, 3, 3000))
    assert together.memory == pytest.approx(8.0, rel=0.35)
    assert together.freedom.sum() == pytest.approx(15000)


def test_rounding_alone_is_noise_of_its_own_size() -> None:
    step = 1e-4
    record = Record(TIME, step * np.round(MOTION / step), TIME[:1], np.zeros(1))
    part = of_record(record, step / math.sqrt(12.0), step)
    found = estimate([(record.position - MOTION) * part.root], [part])
    assert found is not None and found.growth == pytest.approx(1.0, rel=0.1)


def test_a_motion_that_is_sampled_slowly_leaves_no_band_for_the_noise() -> None:
    record = Record(TIME, np.sin(2.0 * np.pi * 100.0 * TIME), TIME[:1], np.zeros(1))
    assert estimate([noise(0.0)], [of_record(record, 1e-3)]) is None


@pytest.mark.parametrize("memory", [0.0, 5.0, 20.0])
def test_noise_is_no_larger_than_the_readings_have_it(memory: float) -> None:
    """A pendulum with free turns (public record) had noise of 44 times what its readings show: the model's error."""
    left, told = noise(memory), containing(0.02 * noise(memory, 2))
    found = estimate([left], [told])
    assert found is not None and found.growth < 0.1, "slow noise changes little from sample to sample: it may be more"
    honest = estimate([left], [containing(left)])
    assert honest is not None and honest.growth == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("cutoff", [0.3, 0.4, 0.6])
def test_noise_that_a_sensor_filters_keeps_its_level(cutoff: float) -> None:
    """It has less near the Nyquist frequency than noise with a memory: what bounds it must not ask there."""
    rough = scipy.signal.lfilter(*scipy.signal.butter(2, cutoff), noise(0.0, 3, SAMPLES + 500))[500:]
    left = np.asarray(rough / np.std(rough))
    found, free = found_in(left), estimate([left], [containing(1e3 * left, 1e-8)])
    assert free is not None and found.level == pytest.approx(free.level) and found.memory == free.memory
    assert found.growth == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("at", [0.1, 0.5, 0.9])
def test_noise_that_grows_with_speed_keeps_its_level(at: float) -> None:
    """Also where the cart is fast at the beginning or at the end of the record."""
    size = 1.0 + 5.0 * np.exp(-(((np.arange(SAMPLES) / SAMPLES - at) / 0.1) ** 2))
    left = size * noise(0.0)
    found = found_in(left)
    assert found.growth == pytest.approx(float(np.sqrt(np.mean(left**2))), rel=0.1) and found.memory == 0.0


def test_short_stretches_show_no_noise_slower_than_a_tenth_of_them() -> None:
    """Each has a start of its own, which follows slow noise, and whatever slow force a model lacks."""
    slow = noise(16.0)
    long, parts = estimate([slow], [containing(slow)]), np.split(slow, 100)
    assert long is not None and long.memory > 8.0
    short = estimate(parts, [containing(one) for one in parts])
    assert short is not None and short.memory <= 6.0


@pytest.mark.parametrize(("memory", "size"), [(3.0, 1.0), (10.0, 5.0), (0.0, 3.0)])
def test_a_residual_of_nothing_but_noise_tells_its_floor(memory: float, size: float) -> None:
    told = 1e-5
    residual = size * noise(memory)
    one = containing(residual, told)
    assert heard_floor([told * residual], [one]) == pytest.approx(told * size, rel=0.1)
    assert only_noise([residual], [one]) is not None
    wrong = residual + 3.0 * size * MOTION
    assert only_noise([wrong], [containing(wrong, told)]) is None
    assert math.isnan(heard_floor([told * wrong], [containing(wrong, told)])), "an error of a law is no noise"


def test_noise_that_the_readings_told_is_theirs() -> None:
    residual = noise(0.0)
    assert math.isnan(heard_floor([1e-3 * residual], [readings()]))
