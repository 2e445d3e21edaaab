"""Laws that miss left-out data by far more than the data of the fit follow one record: they are not certain."""

from __future__ import annotations

from dataclasses import replace

import pytest
from setrigs import BASE, fitted, ranked, steps

from msd_ident.estimate.see import see
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.selection import doubts
from msd_ident.selection.certainty import certain
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.generalization import with_left_out
from msd_ident.selection.ranking import Ranking


@pytest.fixture
def experiment() -> Experiment:
    return steps()


def judged(experiment: Experiment, times: float, *, rich: bool = True) -> tuple[Ranking, Ranking]:
    """Friction explains most, a spring a third of that; before and after a prediction with so many times the error."""
    ranking = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 60.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 18.0**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + CubicSpring(1.0), 840.0),
        }
    )
    ranking = replace(ranking, rich=rich)
    error = see(ranking.best.residuals())
    heldout = HeldOut(100.0 * error, times * error, 100.0 - times, (50.0, 99.0))
    scale = scale_from(list(ranking.sets), experiment.readings)
    return ranking, with_left_out(ranking, ranking.best, heldout, scale)


def test_what_left_out_data_leave_is_what_a_cause_must_stand_out_from(experiment: Experiment) -> None:
    before, after = judged(experiment, 7.0)
    assert certain(before.of_cause("cubic_spring")) and certain(before.of_cause("coulomb_friction"))
    assert not certain(after.of_cause("cubic_spring"))
    assert certain(after.of_cause("coulomb_friction"))  # which explains 60² beside the 7² that are left
    (said,) = [one for one in doubts.sentences(after) if "left-out data" in one.lower()]
    assert said.startswith("Left-out data is missed by 7 times the error of the fit")
    assert said.endswith("so cubic spring is not certain.")


@pytest.mark.parametrize(("times", "rich"), [(1.0, True), (1.9, True), (7.0, False)])
def test_a_little_more_error_is_usual_and_of_a_poor_experiment_copies_decide(
    experiment: Experiment, times: float, rich: bool
) -> None:
    before, after = judged(experiment, times, rich=rich)
    assert after is before


def test_the_base_model_has_no_cause_to_doubt(experiment: Experiment) -> None:
    ranking, _ = judged(experiment, 7.0)
    base = next(one for one in ranking.sets if not one.causes)
    scale = scale_from(list(ranking.sets), experiment.readings)
    assert with_left_out(ranking, base, HeldOut(1.0, 1.0, 0.0, (0.0, 0.0)), scale) is ranking
