"""Laws whose strength is open: others can take their place, so they are as likely not to act."""

from __future__ import annotations

import numpy as np
import pytest
from fitrigs import DEMO, demo_record, measured

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.regression_init import starting_state
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.undetermined import undetermined


def open_laws(record: Record, model: Model, fixed: frozenset[str] = frozenset()) -> frozenset[str]:
    """Those of a model that is fitted from the truth."""
    data = Experiment(prepare([record]), Plant(model.mass, model.damping, model.stiffness), fixed)
    start = Initial(0.0, starting_state(record, 10)[1], float(record.position[0]))
    return undetermined(refine(data, frozenset(model.effect_names), model, [start]))


def coasting(ways: int) -> Record:
    """An axis without a spring that a hand threw and that friction stops, once or once in each direction."""
    time = np.arange(400) / 200.0
    position, x, v = [], 0.0, 1.0
    for i in range(time.size):
        position.append(x)
        if ways == 2 and i == time.size // 2:
            v = -1.0
        for _ in range(20):
            v -= 2.5e-4 * (0.3 * v + 0.2 * np.sign(v))
            x += 2.5e-4 * v
    noise = np.random.default_rng(3).normal(0.0, 1e-5, time.size)
    return from_samples(time, np.zeros(time.size), np.array(position) + noise)


def test_one_amplitude_leaves_the_gain_open_but_not_the_friction() -> None:
    """The gain's slope is a factor on all forces: none of them vanishes beside the others."""
    model = DEMO + ForceGainNonlinearity(0.002)
    assert open_laws(demo_record(), model) == {"force_gain_nonlinearity"}
    two = measured(model, {"name": "steps", "hold": 1.5}, rate=500.0)
    assert open_laws(two, model) == frozenset()


def test_friction_of_an_axis_that_slides_one_way_is_open_beside_a_constant_force() -> None:
    model = Model(1.0, 0.3, 0.0, (CoulombFriction(0.2), ForceOffset(0.0)))
    weighed = frozenset({"mass", "stiffness"})
    record = coasting(1)
    assert open_laws(record.window(0.0, 1.5), model, weighed) == {"coulomb_friction", "force_offset"}
    alone = Model(1.0, 0.3, 0.0, (CoulombFriction(0.2),))
    assert open_laws(record.window(0.0, 1.5), alone, weighed) == frozenset()


@pytest.mark.parametrize("among", [frozenset(), frozenset({"stribeck_friction"})])
def test_an_open_law_is_as_likely_not_to_act(among: frozenset[str]) -> None:
    told = Caveats(frozenset({"coulomb_friction", "force_offset"}), exact=True, open=frozenset({"force_offset"}))
    assert told.greatest("force_offset", among, rich=True, steered=False) == pytest.approx(0.5)
    assert told.greatest("coulomb_friction", among, rich=True, steered=False) == 1.0
