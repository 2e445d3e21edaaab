"""The force beyond the linear plant: the law runs through it, and the extended model's own is the same."""

from __future__ import annotations

import numpy as np
import pytest
from reportrigs import diagnosed

from msd_ident.diagnosis.nonlinear_laws import beyond, law_curves
from msd_ident.model import Plant
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.quadratic_drag import QuadraticDrag

pytestmark = pytest.mark.xdist_group("report")


def test_law_and_model_go_through_the_measured_force() -> None:
    found = beyond(diagnosed())
    (law,) = found.laws
    assert found.whole and law.causes == ("coulomb_friction",) and law.signal == "velocity"
    assert law.force[[0, -1]] == pytest.approx([-0.2, 0.2], abs=1e-3)
    measured, explained = found.measured[0], found.explained[0]
    assert np.std(measured.force - explained.force) < 0.2 * np.std(measured.force)
    moving = np.abs(measured.velocity) > 0.1
    on_law = np.interp(measured.velocity[moving], law.over, law.force)
    assert np.mean(np.abs(measured.force[moving] - on_law)) < 0.03


def test_laws_of_one_signal_add_up_and_others_have_no_curve() -> None:
    motion = beyond(diagnosed()).measured
    plant = Plant(1.0, 2.0, 600.0)
    both = plant + CoulombFriction(0.2) + QuadraticDrag(3.0)
    (one,) = law_curves(both, motion)
    assert one.causes == ("coulomb_friction", "quadratic_drag")
    top = one.over[-1]
    assert one.force[-1] == pytest.approx(0.2 + 3.0 * top**2)
    two = law_curves(plant + QuadraticDrag(3.0) + CubicSpring(1e4), motion)
    assert sorted(law.signal for law in two) == ["position", "velocity"]
    (push,) = law_curves(plant + ForceGainNonlinearity(0.01), motion)
    assert push.signal == "applied" and push.force[-1] == pytest.approx(-0.01 * push.over[-1] ** 2)
    assert law_curves(plant + Backlash(1e-3), motion) == ()
    assert law_curves(plant + Hysteresis(0.2, 1e-3), motion) == ()
