"""Records of a single tone, in which mass and stiffness are one number."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Hold, Record, from_samples
from msd_ident.estimate import fit
from msd_ident.estimate.single_tone import common_tone, stiffness_at
from msd_ident.model import Plant, simulate
from msd_ident.model.base_model import DryFriction

OMEGA = 2.0 * math.pi


def under_a_sine(plant: tuple[float, float, float], hz: float = 1.0, hold: Hold = "linear") -> Record:
    """A steady motion under a sine, read with noise of 1e-4 of it."""
    m, b, k = plant
    rate, time = 2.0 * math.pi * hz, np.arange(0.0, 20.0, 0.01)
    position = np.sin(rate * time)
    force = (k - m * rate**2) * position + b * rate * np.cos(rate * time)
    read = position + 1e-4 * np.random.default_rng(3).standard_normal(time.size)
    return from_samples(time, force, read, hold=hold)


@pytest.mark.parametrize("hold", ["linear", "zero"])
@pytest.mark.parametrize("plant", [(2.0, 3.0, 200.0), (2.0, 3.0, 0.0), (0.5, 0.1, 15.0)])
def test_the_sum_that_a_tone_shows_is_read(plant: tuple[float, float, float], hold: Hold) -> None:
    record = under_a_sine(plant, hold=hold)
    omega = common_tone([record])
    assert omega == pytest.approx(OMEGA, rel=1e-3)
    assert stiffness_at([record, record], omega) == pytest.approx(plant[2] - plant[0] * omega**2, rel=0.02)


def test_records_of_two_tones_are_not_one() -> None:
    plant = (2.0, 3.0, 200.0)
    assert common_tone([under_a_sine(plant), under_a_sine(plant, 1.01)]) == pytest.approx(OMEGA, rel=0.01)
    assert common_tone([under_a_sine(plant), under_a_sine(plant, 1.5)]) == 0.0


def test_steps_and_a_square_wave_are_no_tone() -> None:
    time = np.arange(0.0, 20.0, 0.01)
    still = from_samples(time, np.sign(np.sin(OMEGA * time)), np.zeros(time.size))
    square = replace(still, position=simulate(Plant(2.0, 3.0, 200.0), still).position)
    assert common_tone([square]) == 0.0


def rubbing_rig(hz: float) -> Record:
    """A rig with dry friction under a sine."""
    time = np.arange(0.0, 40.0, 0.01)
    still = from_samples(time, 20.0 * np.sin(2.0 * math.pi * hz * time), np.zeros(time.size), hold="linear")
    read = simulate(Plant(2.0, 6.0, 200.0) + DryFriction(2.0), still).position
    return replace(still, position=read + 1e-6 * np.random.default_rng(1).standard_normal(time.size))


def test_mass_and_stiffness_are_open_together_where_the_model_lacks_something() -> None:
    found = fit(Plant(1.0, 5.0, 150.0), [rubbing_rig(1.0)])
    assert not found.quantities["mass"].known and not found.quantities["stiffness"].known
    assert found.quantities["damping"].known
    together = found.derived(lambda p: p["stiffness"] - p["mass"] * OMEGA**2, "N/m")
    assert together.value == pytest.approx(200.0 - 2.0 * OMEGA**2, rel=0.05) and together.known
    assert not found.derived(lambda p: p["stiffness"] / p["mass"], "1/s²").known
    said = next(one for one in found.open_directions if "single tone" in one)
    assert f"mass and stiffness are known only together, as k - m·omega² = {together.value:.4g} N/m" in said
    assert "add a record at another frequency" in said


def test_with_a_second_frequency_both_are_known() -> None:
    found = fit(Plant(1.0, 5.0, 150.0), [rubbing_rig(1.0), rubbing_rig(2.5)])
    assert found.quantities["mass"].known and found.quantities["mass"].value == pytest.approx(2.0, rel=0.05)
    assert not any("single tone" in one for one in found.open_directions)


def test_a_model_that_leaves_only_noise_tells_them_apart() -> None:
    """What begins and dies away beside the tone tells mass from stiffness, if the model is right."""
    time = np.arange(0.0, 40.0, 0.01)
    still = from_samples(time, np.sin(OMEGA * time), np.zeros(time.size), hold="linear")
    rig = Plant(2.0, 6.0, 200.0) + DryFriction(0.05)
    read = simulate(rig, still).position + 1e-6 * np.random.default_rng(1).standard_normal(time.size)
    record = replace(still, position=read)
    assert common_tone([record]) > 0.0
    found = fit(Plant(1.0, 5.0, 150.0) + DryFriction(0.01), [record])
    assert found.quantities["mass"].known and abs(found.quantities["mass"].value - 2.0) < 0.02
