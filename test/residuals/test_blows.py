"""Blows that nobody recorded: what they leave, and how they move a fit."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import from_samples
from msd_ident.model import Plant, simulate
from msd_ident.residuals.blows import Blows, each
from msd_ident.residuals.noise_model import of_record

PLANT = Plant(0.5, 1.0, 1260.0)
NOISE = 2e-6
SAMPLES, PERIOD = 800, 1e-3
AT_REST = from_samples(PERIOD * np.arange(SAMPLES), np.zeros(SAMPLES), np.zeros(SAMPLES), hold="zero")
NOISY = from_samples(
    AT_REST.time, AT_REST.force, np.random.default_rng(1).normal(0.0, NOISE, SAMPLES), hold="zero"
)  # fmt: skip


def test_each_blow_leaves_the_square_of_the_motion_that_it_makes() -> None:
    part = of_record(NOISY, NOISE)
    rings = simulate(PLANT, AT_REST, 0.0, 1.0 / PLANT.mass).position / NOISE
    found = Blows(np.array([100, 700]), np.array([0.01, 0.03])).chi(part, PLANT)
    expected = 0.01**2 * np.sum(rings[: SAMPLES - 100] ** 2) + 0.03**2 * np.sum(rings[: SAMPLES - 700] ** 2)
    assert found == pytest.approx(part.evidence / SAMPLES * expected, rel=1e-9)


def test_slopes_are_the_covariance_that_signs_drawn_by_lot_make() -> None:
    part, rng = of_record(NOISY, NOISE), np.random.default_rng(2)
    rows = rng.normal(size=(2, SAMPLES))
    first, impulse = np.array([50, 300, 620]), np.array([0.02, 0.01, 0.03])
    rings = simulate(PLANT, AT_REST, 0.0, 1.0 / PLANT.mass).position
    struck = np.zeros((3, SAMPLES))
    for motion, i, size in zip(struck, first, impulse, strict=True):
        motion[i:] = size * rings[: SAMPLES - i]
    signs = rng.choice([-1.0, 1.0], size=(20_000, 3))
    slopes = (signs @ struck * part.root) @ rows.T
    found = Blows(first, impulse).slopes(part, PLANT, rows)
    assert np.allclose(found, slopes.T @ slopes / signs.shape[0], rtol=0.05, atol=0.02 * np.max(np.diag(found)))


def test_every_record_has_its_part_of_the_jacobian() -> None:
    short = of_record(from_samples(np.arange(30.0), np.zeros(30), np.zeros(30), hold="zero"), 1.0)
    rows = np.arange(2.0 * (SAMPLES + 30)).reshape(2, -1)
    parts = list(each([of_record(NOISY, NOISE), short], rows))
    assert [one.shape for _, one in parts] == [(2, SAMPLES), (2, 30)]
    assert np.array_equal(parts[1][1], rows[:, SAMPLES:])
