"""What the data leaves open is found from the Jacobian and told in words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured, wrong

from msd_ident.estimate import FitResult, fit, identifiability
from msd_ident.estimate.identifiability import null_directions
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.force_offset import ForceOffset

ENCODER = {"counts_per_metre": COUNTS_PER_METRE, "noise": 1e-5}


def _open(result: FitResult) -> set[str]:
    return {name for name, quantity in result.quantities.items() if math.isnan(quantity.std)}


def test_an_ordinary_record_leaves_nothing_open() -> None:
    result = fit(wrong(DEMO), demo_record(encoder=ENCODER))
    assert result.open_directions == ()
    assert _open(result) == set()


@pytest.mark.parametrize("friction", [0.0, 0.12])
def test_offset_and_zero_are_one(friction: float) -> None:
    """Design, section 4: with a linear spring a force offset is a zero offset of F0/k."""
    truth = Plant(1.0, 4.0, 600.0) + CoulombFriction(friction) if friction else Plant(1.0, 4.0, 600.0)
    record = measured(truth, {"name": "steps", "hold": 1.0}, zero=0.004, rate=500.0, encoder=ENCODER)
    result = fit(wrong(truth) + ForceOffset(0.5), record)
    assert _open(result) == {"offset_force"}
    (sentence,) = result.open_directions
    assert sentence.startswith("offset_force and the position's zero shift the rest position in the same way")
    assert "read the encoder with the spring relaxed" in sentence
    assert abs(result.quantities["stiffness"].value / 600.0 - 1.0) < 0.001


def test_the_offset_is_open_over_several_records_too() -> None:
    records = [measured(DEMO, {"name": "paper", "force": force}, rate=250.0, encoder=ENCODER) for force in (10.0, -5.0)]
    assert _open(fit(wrong(DEMO) + ForceOffset(0.5), records)) == {"offset_force"}


def test_free_decay_knows_ratios_only() -> None:
    record = measured(DEMO, {"name": "release", "position": 0.02}, rate=1000.0, encoder=ENCODER)
    result = fit(wrong(DEMO), record)
    assert _open(result) == set(DEMO.names)
    (sentence,) = result.open_directions
    assert sentence.startswith(
        "mass, damping, stiffness, coulomb_force are known only up to a common factor, because no "
    )
    assert "push with a known force, or weigh the moving mass" in sentence
    squared = result.derived(lambda p: p["stiffness"] / p["mass"], "1/s²")
    assert squared.low < DEMO["stiffness"] / DEMO["mass"] < squared.high
    assert squared.std < 1e-3 * squared.value
    assert math.isnan(result.derived(lambda p: p["stiffness"] * p["mass"], "N²·s²/m²").std)


def test_free_decay_with_a_weighed_mass_knows_all() -> None:
    record = measured(DEMO, {"name": "release", "position": 0.02}, rate=1000.0, encoder=ENCODER)
    result = fit(wrong(DEMO), record, fixed={"mass": DEMO["mass"]})
    assert result.open_directions == ()
    assert result.quantities["stiffness"].value == pytest.approx(DEMO["stiffness"], rel=1e-3)


def test_one_amplitude_hides_the_gain() -> None:
    """Design, section 4: with one size of force, its gain's slope is a factor on m, b, k and Fc."""
    model = wrong(DEMO) + ForceGainNonlinearity(0.002)
    result = fit(model, demo_record(encoder=ENCODER))
    assert _open(result) == {"mass", "damping", "stiffness", "coulomb_force", "gain_slope"}
    (sentence,) = result.open_directions
    assert sentence.startswith("gain_slope cannot be told from the scale of mass, damping, stiffness, coulomb_force")
    assert "a second amplitude in both directions" in sentence


def test_two_amplitudes_show_the_gain() -> None:
    truth = DEMO + ForceGainNonlinearity(0.01)
    record = measured(truth, {"name": "steps", "hold": 1.5}, rate=500.0, encoder=ENCODER)
    result = fit(wrong(truth), record)
    gain = result.quantities["gain_slope"]
    assert result.open_directions == ()
    assert abs(gain.value - 0.01) < 3.0 * gain.std < 0.01


def test_an_unknown_force_unit_scales_all_forces() -> None:
    record = replace(demo_record(encoder=ENCODER), force_unit="V")
    result = fit(wrong(DEMO), record)
    (sentence,) = result.open_directions
    assert sentence.startswith(
        "The force is in V and its gain in newtons is unknown, so mass, damping, stiffness, coulomb_force are known "
        "only up to that gain"
    )
    assert result.quantities["stiffness"].unit == "V/m"
    assert result.quantities["mass"].unit == "V·s²/m"


def test_a_single_step_from_rest_is_scaled_by_its_rest() -> None:
    """One constant force and an unknown zero: only the rest before the push sets the scale, to within Fc/F."""
    record = measured(DEMO, {"name": "step"}, zero=0.03, rate=1000.0, encoder=ENCODER)
    result = fit(wrong(DEMO), record)
    stiffness = result.quantities["stiffness"]
    held = DEMO["coulomb_force"] / 10.425 / math.sqrt(3.0)
    assert result.open_directions == ()
    assert abs(stiffness.value / DEMO["stiffness"] - 1.0) < 2.0 * held
    assert stiffness.std / stiffness.value == pytest.approx(held, rel=0.3)
    squared = result.derived(lambda p: p["stiffness"] / p["mass"], "1/s²")
    assert squared.std / squared.value < 0.1 * held


@pytest.mark.parametrize(
    ("start", "noise", "seed"), [(0.0, 2e-5, 1), (0.001, 2e-5, 2), (0.001, 2e-5, 3), (0.2, 1e-4, 4)]
)
def test_a_single_noisy_step_recovers_the_scale(start: float, noise: float, seed: int) -> None:
    experiment = {"name": "step", "hold": 2.0, "start": start}
    record = measured(DEMO, experiment, zero=-0.01, rate=1000.0, encoder={"noise": noise}, seed=seed)
    result = fit(wrong(DEMO), record)
    assert result.open_directions == ()
    for name in ("mass", "damping", "stiffness"):
        quantity = result.quantities[name]
        assert abs(quantity.value - DEMO[name]) < 2.0 * quantity.std < 0.04 * quantity.value, name


def test_derived_static_gain_has_an_interval() -> None:
    result = fit(wrong(DEMO), demo_record(encoder=ENCODER))
    gain = result.derived(lambda p: 1.0 / p["stiffness"], "m/N")
    stiffness = result.quantities["stiffness"]
    assert gain.std / gain.value == pytest.approx(stiffness.std / stiffness.value, rel=1e-3)


def test_null_directions_have_few_entries() -> None:
    """Two independent null directions come apart instead of mixed."""
    jacobian = np.random.default_rng(1).normal(size=(50, 3))
    columns = np.stack([jacobian[:, 0], jacobian[:, 0], jacobian[:, 1], -2.0 * jacobian[:, 1], jacobian[:, 2]], axis=1)
    found = null_directions(columns.T @ columns, np.ones(5), np.zeros((5, 5)))
    assert sorted(tuple(np.flatnonzero(np.abs(direction) > 1e-6)) for direction in found) == [(0, 1), (2, 3)]


@pytest.mark.parametrize(
    ("moved", "expected"),
    [
        ((1.0, 1.0, 1.0, 1.0, 0.0), set()),
        ((1.0, 1.0, 1.0, 1.0, 1.0), {"gain_slope"}),
        ((0.0, 1.0, 0.0, -1.0, 0.0), {"damping", "coulomb_force"}),
        ((1.0, 0.0, 1.0, 1.0, 0.0), {"damping"}),
        ((1.0, 0.0, 0.0, 0.02, 0.0), {"mass"}),
    ],
    ids=["one factor", "one factor and the gain", "friction for damping", "both mixed", "hardly"],
)
def test_only_what_can_vanish_beside_the_others_is_exchanged(moved: tuple[float, ...], expected: set[str]) -> None:
    """A factor that all forces share, mixed with another open direction, leaves the others as sure as they are."""
    names = ("mass", "damping", "stiffness", "coulomb_force", "gain_slope")
    values = np.array([2.0, 5.0, 300.0, 0.4, 0.01])
    assert identifiability.exchanged(np.array(moved), names, values, values) == expected
