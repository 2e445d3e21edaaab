"""Real refits of rivals to each other's readings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from designrigs import SEEN, STEP, explanation

from msd_ident.data.record import Record
from msd_ident.design.prediction import Grid, Prediction, Predictor, grid
from msd_ident.design.rival_refits import Refitted, refitted, shares
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction

PLANT = Plant(0.94, 3.9, 694.0)
ON: Grid = grid(STEP, 0.23, SEEN)


def rival(model: Model, known: float) -> tuple[Predictor, Prediction]:
    one = Predictor(explanation(model, known=known), 1e-4)
    return one, one.predict(ON.record)


def refit(model: Model, true: Model, known: float) -> Refitted:
    return refitted(*rival(model, known), rival(true, known)[1], ON, SEEN)


def test_the_same_model_leaves_nothing() -> None:
    done = refit(PLANT, PLANT, 0.01)
    assert done.chi == pytest.approx(0.0, abs=1e-9)
    assert np.max(np.abs(done.difference)) < 1e-12


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_a_plant_that_is_not_known_finds_the_other_ones_readings(factor: float) -> None:
    other = PLANT.with_values({"damping": factor * PLANT.damping, "stiffness": factor * PLANT.stiffness})
    apart = np.max(np.abs(rival(PLANT, 1.0)[1].position - rival(other, 1.0)[1].position))
    done = refit(PLANT, other, 10.0)
    assert np.max(np.abs(done.difference)) < 0.15 * apart
    np.testing.assert_array_equal(done.true, rival(other, 1.0)[1].position)


def test_a_refit_counts_what_it_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every step takes one simulation, and one more for each entry of the next Jacobian."""
    taken = []
    readings = Predictor.readings

    def counted(one: Predictor, on: Record, points: np.ndarray, *start: np.ndarray) -> np.ndarray:
        found = readings(one, on, points, *start)
        taken.append(found.size)
        return found

    own, true = rival(PLANT, 10.0), rival(PLANT.with_values({"damping": 5.0}), 10.0)[1]
    monkeypatch.setattr(Predictor, "readings", counted)
    done = refitted(*own, true, ON, SEEN)
    assert done.simulated == sum(taken) > ON.record.samples


def test_what_the_data_knows_holds_a_refit_back() -> None:
    other = PLANT.with_values({"stiffness": 1.1 * PLANT.stiffness})
    loose, held = (refit(PLANT, other, known) for known in (1.0, 1e-6))
    assert held.chi > 100.0 * loose.chi
    own = rival(PLANT, 1e-6)[1].position
    assert np.max(np.abs(held.rival - own)) < np.max(np.abs(loose.rival - own))


def test_a_refit_stays_inside_the_bounds() -> None:
    """Less friction than none would fit best."""
    rubbing = PLANT + CoulombFriction(0.02)
    wild = PLANT.with_values({"damping": 0.5 * PLANT.damping})
    one = Predictor(replace(explanation(rubbing, known=1e-3), information=_only(3)), 1e-4)
    done = refitted(one, one.predict(ON.record), rival(wild, 1.0)[1], ON, SEEN)
    assert done.chi == pytest.approx(refit(PLANT, wild, 1e-7).chi, rel=0.02)


def _only(place: int) -> np.ndarray:
    """Information that leaves one parameter free and holds the others."""
    held = np.append(PLANT.values, 0.02) * 1e-7
    held[place] = 1.0
    return np.diag(held**-2.0)


def test_shares_are_parts_of_what_a_linear_refit_leaves() -> None:
    models = (PLANT, PLANT.with_values({"damping": 6.0}), PLANT + CoulombFriction(0.3))
    predictors, predictions = zip(*(rival(model, 0.1) for model in models), strict=True)
    kept, found = shares(predictors, predictions, ON, SEEN)
    assert np.all(np.diag(kept) == 1.0) and np.all((kept >= 0.0) & (kept <= 1.0))
    for a, row in enumerate(found):
        for b, one in enumerate(row):
            if a == b:
                assert one is None
                continue
            assert one is not None
            alone = refitted(predictors[b], predictions[b], predictions[a], ON, SEEN)
            assert one.chi == alone.chi
