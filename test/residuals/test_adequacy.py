"""Is anything wrong: right models pass, coarse encoders at rest pass, wrong models do not."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.residuals import noise_model
from msd_ident.residuals.adequacy import judge


def ringing(samples: int = 3000) -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(samples) * 1e-3
    return time, 0.01 * np.exp(-3.0 * time) * np.cos(25.0 * time)


def as_record(time: np.ndarray, position: np.ndarray) -> Record:
    return from_samples(time, np.zeros(time.size), position)


def test_right_models_are_hardly_ever_called_wrong() -> None:
    time, truth = ringing(1500)
    rng = np.random.default_rng(1)
    wrong = 0
    for _ in range(300):
        position = truth + 1e-5 * rng.standard_normal(time.size)
        part = noise_model.of_record(as_record(time, position), 1e-5)
        wrong += not judge([truth - position], [part]).consistent
    assert wrong <= 1


def test_a_coarse_encoder_is_no_model_error() -> None:
    """Its error is constant at rest and a saw-tooth in slow motion: neither white nor normal."""
    time, truth = ringing()
    for step in (1e-5, 1e-4, 5e-4):
        for shift in (0.1, 0.35, 0.49):
            reading = np.round(truth / step + shift) * step
            part = noise_model.of_record(as_record(time, reading), step / np.sqrt(12.0))
            assert judge([truth + shift * step - reading], [part]).consistent, (step, shift)


def test_a_trace_of_the_motion_is_seen_below_the_noise() -> None:
    time, truth = ringing()
    noise = 1e-5 * np.random.default_rng(2).standard_normal(time.size)
    part = noise_model.of_record(as_record(time, truth + noise), 1e-5)
    left = judge([3e-4 * truth / np.std(truth) * 1e-2 - noise], [part])
    assert left.ratio < 1.1
    assert not left.consistent and not left.material


def test_a_residual_above_the_noise_is_material() -> None:
    time, truth = ringing()
    noise = 2e-5 * np.random.default_rng(3).standard_normal(time.size)
    part = noise_model.of_record(as_record(time, truth + noise), 1e-5)
    left = judge([-noise], [part])
    assert left.material and not left.consistent


def test_a_short_record_is_not_drowned_by_a_long_one() -> None:
    """Sixty pieces of evidence at twice the noise are nothing among six thousand, and much by themselves."""
    rng = np.random.default_rng(4)
    parts, left = [], []
    for samples, excess in ((6000, 1.0), (60, 2.0)):
        time, truth = ringing(samples)
        noise = 1e-5 * rng.standard_normal(samples)
        parts.append(noise_model.of_record(as_record(time, truth + noise), 1e-5))
        left.append(excess * noise)
    assert judge(left[:1], parts[:1]).consistent
    found = judge(left, parts)
    assert found.ratio < 1.05 and found.size < 1e-5 and not found.consistent
    right = judge([left[0], 0.5 * left[1]], parts)
    assert right.consistent


def test_a_run_of_equal_readings_is_one_piece_of_evidence() -> None:
    time = np.arange(100) * 1e-3
    position = np.repeat([0.0, 1e-4, 3e-4, 2e-4], 25)
    part = noise_model.of_record(as_record(time, position), 3e-5)
    assert part.evidence == pytest.approx(4.0)
    assert part.chi(np.full(100, 3e-5)) == pytest.approx(4.0)
