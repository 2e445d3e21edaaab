"""The two fits that identification and diagnosis start from."""

from __future__ import annotations

from functools import cache

import pytest
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured, wrong

from msd_ident.data.record import Record
from msd_ident.estimate.base_fits import joint_fit, linear_fit, structure
from msd_ident.estimate.result import FitResult
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset

PLANT = ("mass", "damping", "stiffness")


@cache
def record() -> Record:
    return demo_record(rate=250.0, encoder={"counts_per_metre": COUNTS_PER_METRE, "noise": 1e-5}, seed=1)


@cache
def joint() -> FitResult:
    return joint_fit((record(),), wrong(DEMO.without("coulomb_friction")), True, {})


def test_an_offset_takes_the_place_of_the_zero_where_no_spring_acts() -> None:
    plant = Plant(1.0, 2.0, 400.0)
    assert structure(plant, True) == plant + CoulombFriction(0.0)
    assert structure(plant, False) == plant + CoulombFriction(0.0) + ForceOffset(0.0)


def test_dry_friction_is_found_and_what_the_linear_model_lacks_is_left() -> None:
    linear = linear_fit((record(),), joint())
    for name in DEMO.names:
        quantity = joint().quantities[name]
        assert abs(quantity.value - DEMO[name]) < 4.0 * quantity.std
    assert joint().see == pytest.approx(1e-5, rel=0.1)
    assert linear.model.names == PLANT
    assert linear.see > 5.0 * joint().see
    assert linear.quantities["damping"].value > 1.02 * DEMO["damping"], "it takes the friction upon itself"


def test_without_dry_friction_both_are_the_same_fit() -> None:
    truth = Plant(1.0, 3.0, 600.0)
    records = (measured(truth, {"name": "paper", "hold": 1.5}, rate=250.0, encoder={"noise": 2e-5}, seed=1),)
    both = joint_fit(records, wrong(truth), True, {})
    linear = linear_fit(records, both)
    assert both.see <= linear.see < 1.01 * both.see
    assert linear.quantities["stiffness"].value == pytest.approx(600.0, rel=1e-3)


def test_an_axis_without_a_spring_keeps_its_stiffness_in_both() -> None:
    truth = Plant(2.0, 15.0, 0.0) + CoulombFriction(1.0) + ForceOffset(0.3)
    experiment = {"name": "random_steps", "force": 8.0, "duration": 6.0}
    records = (measured(truth, experiment, rate=250.0, encoder={"noise": 1e-5}, seed=1),)
    found = joint_fit(records, Plant(2.6, 10.0, 0.0), False, {"stiffness": 0.0})
    linear = linear_fit(records, found)
    assert found.quantities["offset_force"].value == pytest.approx(0.3, rel=0.02)
    assert found.quantities["coulomb_force"].value == pytest.approx(1.0, rel=0.02)
    for one in (found, linear):
        assert (one.quantities["stiffness"].value, one.quantities["stiffness"].std) == (0.0, 0.0)
