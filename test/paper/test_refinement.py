"""The paper's refinement: friction raised from 0 to the least SEE, m, b and k kept."""

from __future__ import annotations

import numpy as np
import pytest
from fitrigs import COUNTS_PER_METRE, DEMO, demo_record, measured

from msd_ident.errors import UsageError
from msd_ident.estimate import see
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.paper.refinement import paper_refine, record_start

PLANT = Plant(DEMO["mass"], DEMO["damping"], DEMO["stiffness"])


def test_the_true_plant_needs_the_true_friction() -> None:
    found = paper_refine(PLANT, demo_record())
    assert found.friction_coefficient == pytest.approx(0.0133, rel=0.005)
    assert found.refined["coulomb_force"] == pytest.approx(DEMO["coulomb_force"], rel=0.005)
    assert found.refined.without("coulomb_friction") == PLANT
    assert found.see_original == see(found.residual_original)
    assert found.see_refined == see(found.residual_refined)
    assert found.reduction_percent == pytest.approx(100.0 * (1.0 - found.see_refined / found.see_original))
    assert found.reduction_percent > 90.0


def test_no_other_friction_is_better() -> None:
    record = demo_record(rate=500.0)
    plant = Plant(0.95, 4.3, 690.0)
    found = paper_refine(plant, record)
    for force in found.refined["coulomb_force"] * np.array([0.9, 0.98, 1.02, 1.1]):
        other = paper_refine(plant, record, found.initial)
        assert other.see_refined <= _see_with(plant + CoulombFriction(float(force)), record) + 1e-12


def _see_with(model, record):  # type: ignore[no-untyped-def]
    from msd_ident.model import Simulator

    start = record_start(record)
    positions = Simulator(model, record).positions(model.values, start.position, start.velocity)
    return see(positions + start.zero - record.position)


def test_too_much_damping_leaves_no_friction() -> None:
    found = paper_refine(Plant(DEMO["mass"], 3.0 * DEMO["damping"], DEMO["stiffness"]), demo_record(rate=500.0))
    assert found.refined["coulomb_force"] == 0.0
    assert found.reduction_percent == 0.0


def test_the_zero_is_the_level_before_the_push() -> None:
    encoder = {"counts_per_metre": COUNTS_PER_METRE}
    record = measured(DEMO, {"name": "paper", "start": 0.5}, zero=0.02, rate=1000.0, encoder=encoder)
    assert record_start(record).zero == pytest.approx(0.02, abs=5e-6)
    assert paper_refine(PLANT, record).friction_coefficient == pytest.approx(0.0133, rel=0.01)


def test_other_effects_of_the_model_stay() -> None:
    found = paper_refine(PLANT + ForceOffset(0.0), demo_record(rate=500.0))
    assert found.refined.effect_names == ("coulomb_friction", "force_offset")


def test_a_model_with_friction_is_refused() -> None:
    with pytest.raises(UsageError, match="the model has dry friction already; expected the plant alone"):
        paper_refine(DEMO, demo_record(rate=250.0))
