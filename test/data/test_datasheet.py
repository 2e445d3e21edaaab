"""The facts of a record: what is put in comes out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from msd_ident.data.datasheet import data_sheet
from msd_ident.data.record import Record

PERIOD, STEP = 0.002, 1e-5


def record(drop: slice, jitter: float = 0.0, late: float = 0.02) -> Record:
    """A cart that begins to swing ``late`` seconds after a force step at 1 s, read every 2 ms in steps of 10 µm."""
    rng = np.random.default_rng(1)
    time = PERIOD * np.arange(2000)
    after = np.maximum(time - 1.0 - late, 0.0)
    position = np.round(0.02 * (1.0 - np.cos(25.0 * after)) / STEP) * STEP
    time = time + jitter * rng.standard_normal(time.size)
    keep = np.delete(np.arange(time.size), drop)
    return Record(time[keep], position[keep], np.array([0.0, 1.0]), np.array([0.0, 8.0]), name="known")


def test_rate_gaps_jitter_step_and_delay() -> None:
    sheet = data_sheet(record(slice(1500, 1510), jitter=2e-5))
    assert sheet.samples == 1990 and sheet.missing_samples == 10 and sheet.gaps == 1
    assert sheet.rate_hz == pytest.approx(500.0, rel=0.01)
    assert sheet.longest_gap_s == pytest.approx(11 * PERIOD, rel=0.01)
    assert sheet.jitter_s == pytest.approx(2e-5 * math.sqrt(2.0), rel=0.1)
    assert sheet.encoder_step == pytest.approx(STEP) and sheet.noise_floor >= STEP / math.sqrt(12.0) * 0.99
    assert 0.02 <= sheet.step_delay_s < 0.04
    assert sheet.to_json_dict()["position_unit"] == "m"


def test_a_cart_that_moves_before_its_force_has_a_negative_delay() -> None:
    assert data_sheet(record(slice(0, 0), late=-0.05)).step_delay_s == pytest.approx(-0.045, abs=0.01)
