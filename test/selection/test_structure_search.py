"""The search for the set of causes: what is simpler gets a second look from where the leader stands."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model import Model, Plant
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import NOISE_ERROR, SOUGHT, Experiment, formulated
from msd_ident.selection.hypothesis import Hypothesis, imitated
from msd_ident.selection.hypothesis_fit import StartingPoint, refine
from msd_ident.selection.structure_search import Search
from msd_sim.api import simulate

TRUTH = Plant(1.0, 2.0, 400.0)


def rubbing() -> Experiment:
    made = simulate(
        {
            "mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.03, "experiment": "steps",
            "encoder.counts_per_metre": 0.0, "encoder.noise": 1e-5,
        }
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), TRUTH, frozenset())


def stood(experiment: Experiment, model: Model) -> Hypothesis:
    """A set that was left where it stands."""
    problem, weighting, point = formulated(experiment, model, experiment.problem(model).initial)
    state = weighting.exact(point, weighting.steps(None))
    return Hypothesis(frozenset(model.effect_names), model, problem, state, experiment.readings)


def test_what_is_simpler_is_begun_where_the_leader_stands() -> None:
    experiment = rubbing()
    base = stood(experiment, TRUTH)
    wrong = stood(experiment, TRUTH + CoulombFriction(0.15))
    richer = TRUTH + PositionDependentFriction(0.29, 0.0)
    best = refine(experiment, frozenset(richer.effect_names), richer, base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    assert best.chi < 0.1 * wrong.chi
    found = search.compared([base, wrong, best])
    assert found.best.causes == {"coulomb_friction"}
    assert np.isclose(found.best.model["coulomb_force"], 0.03 * 9.81, rtol=0.01)


def test_what_is_hopeless_is_counted_from_the_noise() -> None:
    """Beside a set that leaves noise alone, a few shapes of error more are hopeless, and not 4 times chi² alone."""
    experiment = rubbing()
    noise = experiment.evidence
    assert experiment.worse(noise, 4.0) == noise + 3.0 * SOUGHT
    assert experiment.worse((1.0 + NOISE_ERROR) * noise, 4.0) < 1.5 * noise
    assert experiment.worse(100.0 * noise, 4.0) > 390.0 * noise


def test_a_promise_of_much_is_followed_however_far_it_is() -> None:
    """A first step that takes most of a large error away tells little of where the descent ends."""
    fitted = stood(rubbing(), TRUTH)
    small, large = StartingPoint(9.0, fitted, beside=10.0), StartingPoint(40.0, fitted, beside=1000.0)
    assert not small.worth(5.0) and small.worth(9.5)
    assert large.worth(5.0)
    assert large.turn < StartingPoint(30.0, fitted, beside=31.0).turn
    assert StartingPoint(-1e-9, fitted, beside=10.0).turn == 0.0, "by rounding, a step that takes all away"


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
    experiment = Experiment(prepare([record]), TRUTH, frozenset())
    base = stood(experiment, TRUTH)
    stops = refine(experiment, frozenset({"end_stop"}), Plant(1.0, 2.0, 0.0) + EndStop(1.2e-3, 380.0), base.initial)
    search = Search(experiment, lambda fitted: True, lambda stage, part, cause: None)
    found = search.compared([base, stops])
    assert found.best.causes == {"backlash"}
    assert np.isclose(found.best.model["backlash_half_width"], 1e-3, rtol=0.01)


def test_what_stops_and_a_play_come_to() -> None:
    """The force beyond the stops is that of one spring with a play; beside no spring it is nothing else."""
    alone, beside = Plant(1.0, 2.0, 0.0) + EndStop(2e-3, 400.0), Plant(1.0, 2.0, 100.0) + EndStop(2e-3, 300.0)
    play = frozenset({"backlash"})
    for model, width in ((alone, 2e-3), (beside, 1.5e-3), (beside + Backlash(4e-4), 1.6e-3)):
        assert imitated(model) == {play: Plant(1.0, 2.0, 400.0) + Backlash(width)}
    assert set(imitated(alone, alike=True)) == {play}
    assert imitated(beside, alike=True) == {} == imitated(Plant(1.0, 2.0, 0.0) + EndStop(2e-3, 0.0))
