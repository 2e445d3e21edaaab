"""Noise floor of several records, and what repeated experiments add."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured

from msd_ident.data import noise
from msd_ident.data.record import from_samples
from msd_ident.estimate.noise_floors import noise_floor, repeat_scatter


def test_an_encoder_without_noise_has_its_rounding_as_floor() -> None:
    assert noise_floor((demo_record(),)) == pytest.approx(1.0 / COUNTS_PER_METRE / math.sqrt(12.0), rel=0.1)


def test_white_noise_is_found() -> None:
    record = demo_record(encoder={"counts_per_metre": COUNTS_PER_METRE, "noise": 5e-5}, seed=3)
    assert noise_floor((record,)) == pytest.approx(5e-5, rel=0.1)


def test_the_floor_of_a_long_record_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Too long a record to keep curves with, but a number takes no room."""
    asked: list[float] = []
    real = noise._interpolation_error
    monkeypatch.setattr(noise, "_interpolation_error", lambda record, step: asked.append(step) or real(record, step))
    random = np.random.default_rng(4)
    time = np.arange(60_000) / 1000.0
    record = from_samples(time, 0.0 * time, np.sin(time) + 1e-3 * random.standard_normal(time.size))
    assert noise_floor((record,)) == noise_floor((record,)) == pytest.approx(1e-3, rel=0.02)
    assert len(asked) == 1


def test_repeats_tell_the_scatter_of_the_rig() -> None:
    rng = np.random.default_rng(0)
    record = demo_record()
    shaken = tuple(replace(record, position=record.position + rng.normal(0.0, 3e-5, record.samples)) for _ in range(3))
    assert repeat_scatter(shaken) == pytest.approx(3e-5, rel=0.03)


def test_other_zeros_are_no_scatter() -> None:
    record = demo_record()
    moved = replace(record, position=record.position + 0.003)
    assert repeat_scatter((record, moved)) == pytest.approx(0.0, abs=1e-12)


def test_different_experiments_are_no_repeats() -> None:
    other = measured(DEMO, {"name": "paper", "force": 5.0}, rate=1000.0)
    assert math.isnan(repeat_scatter((demo_record(), other)))
