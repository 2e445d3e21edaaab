"""The first two hypotheses of a diagnosis start where an identification ends."""

from __future__ import annotations

import pytest
from fitrigs import measured
from setrigs import pushed

from msd_ident.model import Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.base_hypotheses import base_fit, shared_fits
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine


def test_the_base_model_is_no_worse_than_from_any_of_its_starts() -> None:
    experiment = pushed(CoulombFriction(0.3))
    shared = shared_fits(experiment, Plant(1.3, 1.4, 520.0))
    base, friction = base_fit(experiment, shared)
    assert base.causes == frozenset() and base.model.effects == ()
    for start in (shared.linear, shared.joint):
        plain = start.model.without("coulomb_friction")
        assert base.chi <= (1.0 + 1e-9) * refine(experiment, frozenset(), plain, start.initial).chi
    assert friction.causes == {"coulomb_friction"} and base.chi > 10.0 * friction.chi
    assert friction.chi / experiment.evidence == pytest.approx(1.0, abs=0.15)
    assert friction.model["coulomb_force"] == pytest.approx(0.3, rel=0.01)


def test_an_axis_without_a_spring_has_friction_and_no_offset() -> None:
    truth = Plant(2.0, 15.0, 0.0) + CoulombFriction(1.0)
    experiment = {"name": "random_steps", "force": 8.0, "duration": 4.0}
    record = measured(truth, experiment, rate=250.0, encoder={"counts_per_metre": 0.0, "noise": 1e-5}, seed=1)
    data = Experiment(prepare([record]), Plant(2.0, 15.0, 0.0), frozenset({"stiffness"}))
    shared = shared_fits(data, Plant(2.6, 10.0, 0.0))
    assert shared.joint.model.has("force_offset")
    base, friction = base_fit(data, shared)
    assert base.model.stiffness == friction.model.stiffness == 0.0
    assert friction.model.effect_names == ("coulomb_friction",)
    assert friction.model["mass"] == pytest.approx(2.0, rel=0.01)
    assert friction.model["coulomb_force"] == pytest.approx(1.0, rel=0.01)
    assert friction.chi < 0.1 * base.chi
