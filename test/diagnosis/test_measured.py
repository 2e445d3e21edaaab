"""Real rigs: what a lab measured, and what must be said about it."""

from __future__ import annotations

from pathlib import Path

import pytest
from once import diagnosed

from bench.real.rigs import RIGS
from msd_ident.diagnosis import Diagnosis
from msd_ident.io import read

DRY = ("coulomb_friction", "stribeck_friction", "hysteresis", "position_dependent_friction")


def measured(folder: Path, name: str) -> Diagnosis:
    """Of one record, read as ``make real`` reads it; copies of the one that is always diagnosed take twice its time."""
    (rig,) = (rig for rig in RIGS if rig.name == name)
    return diagnosed([read(folder / rig.path, rig.options)], copied=name != "step_1")


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "name",
    [pytest.param("step_1", marks=pytest.mark.xdist_group("step_1")), pytest.param("step_2", marks=pytest.mark.long)],
)
def test_the_cart_rubs_and_what_remains_is_said(shared_data: Path, name: str) -> None:
    found = measured(shared_data, name)
    assert any(cause.name in DRY for cause in found.causes)
    assert found.verdict in ("mostly_explained", "ambiguous") and found.left.exceeds
    assert "of the motion is still unexplained, more than the tolerance of 1 %" in found.summary
    assert found.heldout.reduction_percent > 20.0
    assert found.characteristics is not None
    assert any("known only up to that gain" in sentence for sentence in found.warnings)


@pytest.mark.long
@pytest.mark.timeout(300)
def test_the_released_cart_rubs_and_the_hand_is_cut_off(shared_data: Path) -> None:
    found = measured(shared_data, "release_1")
    assert found.causes[0].name in DRY
    assert any("left out" in sentence and "by hand" in sentence for sentence in found.warnings)
    assert any("only as ratios" in sentence for sentence in found.warnings)


@pytest.mark.long
@pytest.mark.timeout(900)  # 25 000 samples, and every one of them with a force of its own
def test_the_drive_rubs_and_has_an_offset(shared_data: Path) -> None:
    """EMPS: dry friction and an offset, which is the same as friction that differs between directions."""
    found = measured(shared_data, "emps_train")
    assert found.verdict != "adequate"
    # At speeds of one size an offset and a damping that differs between directions are the same.
    said = {cause.name for cause in found.causes} | {one for cause in found.causes for one in cause.tied_with}
    assert {"coulomb_friction", "force_offset"} <= said
    assert not any(cause.probability > 0.9 for cause in found.causes if cause.name != "coulomb_friction")
    assert "direction_dependent_damping" in said or any("asymmetric friction" in one for one in found.warnings)
    assert found.heldout.interval_percent[0] > 50.0
    assert found.extended.see < 2.6e-3
    for name, published in (("mass", 95.1089), ("damping", 203.5034), ("coulomb_force", 20.3935)):
        assert found.extended.quantities[name].value == pytest.approx(published, rel=0.15)
