"""The descent with few simulations ends where a plain least-squares solver does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize

from msd_ident.data.record import Record
from msd_ident.estimate.broyden import descend
from msd_ident.estimate.levels import DAMPING
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import Experiment, weigh
from msd_ident.selection.hypothesis_fit import begin, exactly, finish, refine
from msd_ident.selection.starting_points import proposals, starts
from msd_sim.api import simulate

TRUTH = {"cubic_stiffness": 8e4}
RIG = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0, "effects": {"cubic_spring": TRUTH}}


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    spec = {**RIG, "encoder": {"counts_per_metre": 0.0, "noise": 2e-5}, "experiment": {"name": "steps", "hold": 0.5}}
    made = simulate(spec)
    record = Record(made.time, made.position, made.force_time, made.force)
    return Experiment(prepare([record]), Plant(1.0, 2.0, 600.0), frozenset())


def test_ends_where_scipy_ends(experiment: Experiment) -> None:
    problem = experiment.problem(Plant(1.1, 3.0, 650.0) + CubicSpring(5e4))
    weighting = weigh(problem, experiment.readings)
    start = problem.vector({"mass": 1.1, "damping": 3.0, "stiffness": 650.0, "cubic_stiffness": 5e4}, (Initial(),))
    ours = descend(weighting, weighting.exact(start, weighting.steps(None)), 60, 1e-4)
    theirs = scipy.optimize.least_squares(weighting.residual, start, x_scale=problem.scale, method="trf")
    assert ours.chi == pytest.approx(2.0 * theirs.cost, rel=1e-4)
    assert np.allclose(ours.point, theirs.x, rtol=1e-3, atol=1e-6)


def test_a_descent_goes_on_where_the_one_before_ended(experiment: Experiment) -> None:
    """In parts, each of which began with the first damping, it crept along a bent valley."""
    weighting = weigh(experiment.problem(Plant(1.1, 3.0, 650.0) + CubicSpring(5e4)), experiment.readings)
    start = weighting.problem.vector(
        {"mass": 1.1, "damping": 3.0, "stiffness": 650.0, "cubic_stiffness": 5e4}, (Initial(),)
    )
    first = descend(weighting, weighting.exact(start, weighting.steps(None)), 2, 1e-4)
    assert 0.0 < first.damping < DAMPING and weighting.renewed(first).damping == first.damping
    stuck = replace(first, damping=10.0 * DAMPING)
    assert descend(weighting, stuck, 0, 1e-4).damping == DAMPING, "no descent begins stuck"


def test_a_cause_is_reached_from_the_model_without_it(experiment: Experiment) -> None:
    base = refine(experiment, frozenset(), Plant(1.1, 3.0, 650.0), (Initial(),))
    causes = frozenset({"cubic_spring"})
    begun = begin(experiment, proposals(experiment, causes, [base]), np.inf)
    found = exactly(experiment, finish(experiment, begun, np.inf))
    assert base.chi > 4.0 * found.chi
    assert found.chi / experiment.evidence == pytest.approx(1.0, abs=0.1)
    assert found.model["cubic_stiffness"] == pytest.approx(8e4, rel=0.02)


def test_a_parent_that_lost_its_spring_is_no_start_for_what_bends_it(experiment: Experiment) -> None:
    limp = refine(experiment, frozenset(), Plant(1.1, 3.0, 650.0), (Initial(),))
    limp = replace(limp, model=limp.model.with_values({"stiffness": 0.0}))
    assert starts(experiment, frozenset({"backlash"}), limp) == []
    assert starts(experiment, frozenset({"quadratic_drag"}), limp)


def test_a_step_that_rounding_would_swallow_is_a_larger_one(experiment: Experiment) -> None:
    """A harmonic's phase may have wandered far; a step of nothing would divide by nothing."""
    model = Plant(1.0, 2.0, 600.0) + Cogging(0.1, 1e-3, 3e13)
    problem = experiment.problem(model)
    weighting = weigh(problem, experiment.readings)
    point = problem.vector(dict(zip(model.names, model.values.tolist(), strict=True)), (Initial(),))
    steps = weighting.steps(None)
    entry = problem.names.index("cogging_phase")
    assert point[entry] + steps[entry] == point[entry]
    state = weighting.exact(point, steps)
    ((_, (row,)),) = weighting.columns([point], np.array([entry]), steps)
    assert np.isfinite(state.jacobian).all() and np.isfinite(row).all()


def test_a_jacobian_needs_no_second_simulation_of_a_known_residual(experiment: Experiment) -> None:
    """The row of a zero, with which the reading moves alike, is the weight of each sample."""
    problem = experiment.problem(Plant(1.1, 3.0, 650.0) + CubicSpring(5e4))
    weighting = weigh(problem, experiment.readings)
    point = problem.vector({"mass": 1.1, "damping": 3.0, "stiffness": 650.0, "cubic_stiffness": 5e4}, (Initial(),))
    whole = weighting.exact(point, weighting.steps(None))
    known = weighting.exact(point, weighting.steps(None), whole.residual)
    assert known.residual is whole.residual and np.array_equal(known.jacobian, whole.jacobian)
    assert problem.nuisances[-1].kind == "zero" and np.array_equal(whole.jacobian[-1], weighting.roots[0])
    moved = weighting.renewed(whole)
    assert moved.exact and np.array_equal(moved.point, point)
    assert np.allclose(moved.normal.diagonal(), whole.normal.diagonal(), rtol=1e-3)


def test_bounds_hold(experiment: Experiment) -> None:
    problem = experiment.problem(Plant(1.0, 2.0, 600.0) + CubicSpring(5e4))
    lower = problem.lower.copy()
    lower[problem.names.index("damping")] = 4.0
    from dataclasses import replace

    bounded = replace(problem, lower=lower)
    weighting = weigh(bounded, experiment.readings)
    start = bounded.vector({"mass": 1.0, "damping": 5.0, "stiffness": 600.0, "cubic_stiffness": 5e4}, (Initial(),))
    found = descend(weighting, weighting.exact(start, weighting.steps(None)), 60, 1e-3)
    assert found.point[problem.names.index("damping")] == pytest.approx(4.0)
