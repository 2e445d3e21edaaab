"""Evidence: parameters pay, ties lead with the simpler set, model error tempers, probabilities add up."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest

from msd_ident.diagnose import evidence
from msd_ident.diagnose.candidates import Experiment, Fitted
from msd_ident.diagnose.descent import State
from msd_ident.diagnose.readings import prepare
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.record import Record
from msd_sim.api import simulate

BASE = Plant(1.0, 2.0, 400.0)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    made = simulate(
        {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "experiment": "steps"}
    )
    return Experiment(prepare([Record(made.time, made.position, made.force_time, made.force)]), BASE, frozenset())


def fitted(experiment: Experiment, model: Model, chi: float, known: float = 1e3) -> Fitted:
    """A set with a given chi², every parameter known to its natural size over ``known``."""
    problem = experiment.problem(model)
    rows = known * np.diag(1.0 / problem.scale)
    residual = np.zeros(problem.size)
    residual[0] = math.sqrt(chi)
    return Fitted(
        frozenset(model.effect_names),
        model,
        problem,
        State(
            problem.vector(dict(zip(model.names, model.values.tolist(), strict=True)), problem.initial),
            residual,
            rows,
            True,
        ),
    )


def ranked(sets: Mapping[str, Fitted]) -> evidence.Ranking:
    return evidence.rank({one.causes: one for one in sets.values()}, evidence.Scale())


def odds(ranking: evidence.Ranking) -> dict[frozenset[str], tuple[float, float]]:
    """Evidence and probability by set."""
    return {
        one.causes: (value, p)
        for one, value, p in zip(ranking.sets, ranking.evidence, ranking.probability, strict=True)
    }


def test_a_parameter_must_earn_its_place(experiment: Experiment) -> None:
    friction, drag = CoulombFriction(0.1), QuadraticDrag(1.0)
    for gain, leads in ((10.0, 0), (40.0, 1)):
        found = ranked(
            {
                "friction": fitted(experiment, BASE + friction, 1000.0),
                "both": fitted(experiment, BASE + friction + drag, 1000.0 - gain),
            }
        )
        assert len(found.best.causes) == 1 + leads


def test_what_brings_no_fall_of_chi_has_no_evidence_of_its_own(experiment: Experiment) -> None:
    """However uncertain a further cause makes the others: the smaller set's determinant may be wrong at a knee."""
    found = ranked(
        {
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 1000.0, known=1e6),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 998.0, known=1.0),
        }
    )
    assert found.best.causes == {"coulomb_friction"}
    assert found.evidence[0] - found.evidence[1] == pytest.approx(math.log(20.0) - 1.0)


def test_the_simpler_leads_a_tie_and_the_other_is_told(experiment: Experiment) -> None:
    found = ranked(
        {
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 1000.0),
            "stribeck": fitted(experiment, BASE + StribeckFriction(0.1, 0.2, 0.01), 970.0),
        }
    )
    assert found.best.causes == {"coulomb_friction"}
    assert evidence.alternatives(found, "coulomb_friction") == ("stribeck_friction",)
    assert sum(found.probability) == pytest.approx(1.0)
    assert found.of_cause("coulomb_friction") + found.of_cause("stribeck_friction") == pytest.approx(1.0)


@pytest.mark.parametrize(("peak", "own"), [(1.005, False), (1.02, True)])
def test_a_breakaway_no_higher_than_the_sliding_force_is_no_law_of_its_own(
    experiment: Experiment, peak: float, own: bool
) -> None:
    found = ranked(
        {
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 1000.0),
            "stribeck": fitted(experiment, BASE + StribeckFriction(0.1, 0.1 * peak, 0.3), 1000.0),
        }
    )
    assert found.best.causes == {"coulomb_friction"}
    assert (len(found.sets) == 2) is own


def test_another_set_can_lead_with_its_own_evidence(experiment: Experiment) -> None:
    """Where few independent samples let the base lead a tie, and the likelier set predicts better beyond doubt."""
    found = ranked(
        {
            "base": fitted(experiment, BASE, 1000.0),
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 980.0),
            "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 999.0),
        }
    )
    assert not found.best.causes
    friction = next(one for one in found.sets if one.causes == {"coulomb_friction"})
    led = found.led_by(friction)
    assert led.best is friction
    assert odds(led) == odds(found)


def test_model_error_tempers_the_likelihood() -> None:
    sure = evidence.Scale(1.0, 1.0, 1000.0)
    unsure = evidence.Scale(100.0, 0.02, 1000.0)
    strict = sure.log_likelihood(1.0e5) - sure.log_likelihood(1.1e5)
    tempered = unsure.log_likelihood(1.0e5) - unsure.log_likelihood(1.1e5)
    assert strict == pytest.approx(5000.0)
    assert tempered == pytest.approx(10.0 * math.log(1.1))


def test_correlated_residuals_are_few_pieces(experiment: Experiment) -> None:
    rng = np.random.default_rng(5)
    white = rng.standard_normal(experiment.records[0].samples)
    slow = np.convolve(white, np.ones(50) / 50, mode="same")
    part = experiment.readings
    assert evidence.independence([white], part) > 0.5
    assert evidence.independence([slow], part) < 0.1
