"""The search for the set of causes: what is simpler gets a second look from where the leader stands."""

from __future__ import annotations

import numpy as np
from setrigs import BASE, fitted, rubbing, steps, stood

from msd_ident.data.record import Record
from msd_ident.model import Plant
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.structure_search import Search
from msd_sim.api import simulate


def test_what_is_simpler_is_begun_where_the_leader_stands() -> None:
    experiment = rubbing()
    base = stood(experiment, BASE)
    wrong = stood(experiment, BASE + CoulombFriction(0.15))
    richer = BASE + PositionDependentFriction(0.29, 0.0)
    best = refine(experiment, frozenset(richer.effect_names), richer, base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    assert best.chi < 0.1 * wrong.chi
    found = search.compared([base, wrong, best])
    assert found.best.causes == {"coulomb_friction"}
    assert np.isclose(found.best.model["coulomb_force"], 0.03 * 9.81, rtol=0.01)


def test_a_play_that_stops_imitate_is_begun_where_the_stops_stand() -> None:
    """Far from its valley the play does not find it; stops beside a weaker spring have the same force beyond them."""
    made = simulate(
        {
            "mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "experiment": "steps",
            "encoder.counts_per_metre": 0.0, "encoder.noise": 1e-5,
            "effects": {"backlash": {"backlash_half_width": 1e-3}},
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    experiment = Experiment(prepare([record]), BASE, frozenset())
    base = stood(experiment, BASE)
    stops = refine(experiment, frozenset({"end_stop"}), Plant(1.0, 2.0, 0.0) + EndStop(1.2e-3, 380.0), base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    found = search.compared([base, stops])
    assert found.best.causes == {"backlash"}
    assert np.isclose(found.best.model["backlash_half_width"], 1e-3, rtol=0.01)


def test_a_set_that_leaves_far_less_than_the_leading_one_has_its_neighbours_tried_too() -> None:
    data = steps()
    play, bent = BASE + Backlash(1e-3), BASE + CubicSpring(1e6)
    leader, large = fitted(data, play, 1000.0), fitted(data, play + CoulombFriction(0.1), 10.0)
    for left, fronts in ((400.0, 2), (600.0, 1)):
        rival = fitted(data, bent, left)
        search = Search(data, lambda fitted: fitted.chi < 100.0, lambda stage, part, cause: None)
        search.sets = {one.causes: one for one in (fitted(data, BASE, 9000.0), leader, rival, large)}
        found = search._fronts(leader)
        assert found == [leader, rival][:fronts], "a set of more causes is no rival"
        assert search._fronts(large) == [large], "at the floor nothing else is tried"
