"""The final model simulates at least as well as what an identification of the same records finds."""

from __future__ import annotations

from functools import cache

import pytest
from fitrigs import measured
from setrigs import BASE, stood

from msd_ident.estimate import see
from msd_ident.estimate.base_fits import Shared
from msd_ident.estimate.least_squares import Solution, minimise
from msd_ident.estimate.multistart import limits
from msd_ident.estimate.objective import SquaredError
from msd_ident.model import Model
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.base_hypotheses import shared_fits
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.handover import simulating
from msd_ident.selection.hypothesis import Hypothesis

RUB = CoulombFriction(0.3)
CLOSE = 1.0 + 1e-6


@cache
def data() -> tuple[Experiment, Shared]:
    """Short steps seen by a coarse encoder: runs of equal readings count once in chi², and not in the SEE."""
    encoder = {"counts_per_metre": 2e4}
    record = measured(BASE + RUB, {"name": "steps", "force": 8.0, "hold": 0.5}, rate=250.0, encoder=encoder)
    experiment = Experiment(prepare([record]), BASE, frozenset())
    return experiment, shared_fits(experiment, BASE)


def see_of(fitted: Hypothesis, ended: Solution) -> float:
    return see(fitted.problem.residual(ended.point, 0))


def test_the_end_of_a_diagnosis_is_moved_to_the_least_squares() -> None:
    experiment, shared = data()
    fitted = stood(experiment, BASE.with_values({"damping": 2.1}) + RUB)
    ended = simulating(fitted, shared)
    assert see_of(fitted, ended) < see(fitted.residuals())
    assert see_of(fitted, ended) <= CLOSE * shared.joint.see
    assert ended.cost == pytest.approx(0.5 * float(sum(fitted.problem.residual(ended.point, 0) ** 2)), rel=1e-9)


@pytest.mark.parametrize("effect", [RUB, StribeckFriction(0.3, 0.6, 0.01)], ids=lambda effect: effect.name)
def test_a_set_that_holds_the_friction_is_no_worse_than_the_joint_fit(effect: CoulombFriction) -> None:
    """From a valley of its own it starts again at the identification's."""
    experiment, shared = data()
    lost = stood(experiment, slipped() + effect)
    alone = minimise(SquaredError(lost.problem), lost.point, limits(lost.problem))
    assert see_of(lost, alone) > 10.0 * shared.joint.see
    assert see_of(lost, simulating(lost, shared)) <= CLOSE * shared.joint.see


def test_a_set_without_the_friction_is_no_worse_than_the_linear_fit() -> None:
    experiment, shared = data()
    for lost in (stood(experiment, slipped()), stood(experiment, slipped() + Backlash(5e-3))):
        found = see_of(lost, simulating(lost, shared))
        assert found <= CLOSE * shared.linear.see


def slipped() -> Model:
    """The plant with a frequency from which no descent finds back."""
    return BASE.with_values({"stiffness": 6.0 * BASE.stiffness, "damping": 0.5})
