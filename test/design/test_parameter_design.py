"""Profiles for narrower intervals."""

from __future__ import annotations

import pytest
from designrigs import LIMITS, STEP, Rig, stepped

from msd_ident.design.parameter_design import compared, sharpen
from msd_ident.errors import UsageError
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.workflow import pipeline


@pytest.mark.usefixtures("without_copies")
def test_sharpened_intervals_come_true() -> None:
    """µ after the designed experiment: as narrow as promised, and half of what a single step as long gives."""
    size = 0.05
    diagnosis = pipeline.diagnose([Rig(coulomb_friction={"coulomb_force": size}).play(STEP, LIMITS).record])
    found = sharpen(diagnosis, ["friction_coefficient"], LIMITS)
    rig = Rig(coulomb_friction={"coulomb_force": size})
    step = compared(found.profile.duration, 0.23)[0].scaled(8.0)
    widths = []
    for profile in (found.profile, step):
        record = rig.play(profile, LIMITS).record
        fitted = fit(Plant(0.94, 3.9, 694.0) + CoulombFriction(size), record)
        mu = fitted.derived(lambda p: p["coulomb_force"] / (p["mass"] * 9.80665), "1")
        assert abs(mu.value - size / (0.94 * 9.80665)) < 5.0 * mu.std
        widths.append(1.96 * mu.std)
    assert widths[0] <= 0.5 * widths[1]
    assert found.after["friction_coefficient"] == pytest.approx(widths[0], rel=0.5)
    assert found.after["friction_coefficient"] < found.random["friction_coefficient"]
    assert found.after["friction_coefficient"] < 0.7 * found.step["friction_coefficient"]


def test_unknown_targets() -> None:
    with pytest.raises(UsageError, match="no parameter 'colour' to sharpen; this model has mass, damping, stiffness"):
        sharpen(stepped("", "", 0.0), ["colour"], LIMITS)
