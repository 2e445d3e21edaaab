"""What rest before the first push says, where the samples leave it open."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from setrigs import BASE

from msd_ident.data.record import Record
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection import rest_constraint
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.workflow import pipeline
from msd_sim import api, lottery


def begun_at(rig: Model, place: float, model: Model | None = None, start: float | None = None) -> Hypothesis:
    """A model, the true one if none is given, of a rig that rests at a place [m] from the relaxed spring, and is pushed
    after 0.4 s; the model begins there, or at ``start``.
    """
    model, start = model or rig, place if start is None else start
    time = np.arange(1000) / 250.0
    force = np.where(time < 0.4, 0.0, np.where(time % 1.0 < 0.5, 6.0, -6.0))
    moved = simulate(rig, Record(time, 0.0 * time, time, force), place, 0.0).position
    noise = 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    experiment = Experiment(prepare([Record(time, moved + noise, time, force)]), BASE, frozenset())
    problem, weighting, point = formulated(experiment, model, (Initial(start, 0.0, place - start),))
    state = weighting.exact(point, weighting.steps(None))
    return Hypothesis(frozenset(model.effect_names), model, problem, state, experiment.readings)


def test_rest_moves_no_set_away_from_its_samples() -> None:
    """A spring that is bent where it balances a constant force rests elsewhere than at -F0/k: the samples say where."""
    place = float(brentq(lambda x: x + 4e5 * x**3 + 0.5, -0.1, 0.0))
    loaded = begun_at(replace(BASE, stiffness=1.0) + CubicSpring(4e5) + ForceOffset(0.5), place)
    known = rest_constraint.rest_constraints(loaded)
    assert len(known) == 1 and abs(loaded.problem.imbalance(loaded.point, known[0])[0]) > 1e3 * known[0].spread
    found = rest_constraint.constrained(loaded, loaded.readings, known)
    assert found.model == loaded.model and found.chi == loaded.chi and found.problem.balances == ()


def test_rest_that_agrees_with_the_samples_is_kept() -> None:
    relaxed = begun_at(BASE + ForceOffset(0.5), -0.5 / BASE.stiffness)
    known = rest_constraint.rest_constraints(relaxed)
    found = rest_constraint.constrained(relaxed, relaxed.readings, known)
    assert found.problem.balances == known and len(known) == 1
    assert found.chi < relaxed.chi + 1.0


def test_a_breakaway_that_only_rest_moves_stays_above_the_sliding_friction() -> None:
    """Below it nothing would tell of it, nor of the speed at which it is gone."""
    rubs, peak = BASE + CoulombFriction(0.5), BASE + StribeckFriction(0.45, 0.46, 0.05)
    moved = begun_at(rubs, 0.0, peak, 0.003)
    known = rest_constraint.rest_constraints(moved)
    found = rest_constraint.constrained(moved, moved.readings, known)
    assert found.problem.balances == known and found.model["coulomb_force"] == pytest.approx(0.5, rel=0.01)
    assert found.model["static_force"] > found.model["coulomb_force"]
    assert np.linalg.matrix_rank(found.state.normal) == moved.problem.size


@pytest.mark.usefixtures("without_copies")
def test_a_start_on_the_edge_of_sticking_is_not_taken_for_sharp() -> None:
    """One step from rest with dry friction: all forces may be larger or smaller by Fc/F, and the intervals say so."""
    spec = lottery.draw(24, "coulomb_friction", False, "step").spec
    step = float(spec["experiment"]["force"])
    rest = {key: value for key, value in spec.items() if key != "experiment"}
    made = api.simulate(rest | {"force_time": [0.0, 0.3], "force": [0.0, step], "duration": 3.0, "seed": 25})
    record = Record(
        time=made.time, position=made.position, force_time=np.array([0.0, 0.3]), force=np.array([0.0, step])
    )
    found = pipeline.diagnose([record]).extended.quantities
    unsure = float(spec["effects"]["coulomb_friction"]["coulomb_force"]) / step
    for name in ("mass", "damping", "stiffness"):
        true = float(spec[name])
        assert abs(found[name].value - true) < 3.0 * found[name].std
        assert 0.2 * unsure < found[name].std / true < 2.0 * unsure


@pytest.mark.long
def test_a_breakaway_that_rest_leaves_open_stays_above_the_sliding_friction(asking_about: Callable[..., None]) -> None:
    """Below it nothing would tell of it: a rival that is Coulomb friction under another name can be parted by no
    experiment.
    """
    asking_about("coulomb_friction", "stribeck_friction", "position_dependent_friction")
    spec = lottery.draw(5023, "coulomb_friction", True, "step").spec
    rest = {key: value for key, value in spec.items() if key != "experiment"}
    at, force = np.array([0.0, 0.3]), np.array([0.0, float(spec["experiment"]["force"])])
    made = api.simulate(rest | {"force_time": at, "force": force, "duration": 3.0, "seed": int(spec["seed"]) + 1})
    found = pipeline.diagnose([Record(time=made.time, position=made.position, force_time=at, force=force)])
    assert found.contenders[0].causes == ("coulomb_friction",)
    (rival,) = (one for one in found.contenders if one.model.has("stribeck_friction"))
    assert rival.model["static_force"] > rival.model["coulomb_force"]
    assert np.linalg.matrix_rank(rival.information) == len(rival.free)
