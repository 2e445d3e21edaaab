"""The confusion matrix and what it makes of the probabilities, by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import from_samples
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.report.calibration import corrections
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.calibration import Calibration, Row, corrected, odds
from msd_ident.selection.certainty import CERTAIN
from msd_ident.selection.experiment import Experiment, formulated
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.naming import leading
from msd_ident.selection.ranking import Ranking
from msd_ident.selection.replication import left_unchecked
from msd_ident.selection.ties import tied

RUB, PEAK, DRAG, CREEP, NOTHING = (
    frozenset(names)
    for names in (["coulomb_friction"], ["stribeck_friction"], ["quadratic_drag"], ["smooth_friction"], [])
)
NAMES = {"rub": RUB, "peak": PEAK, "drag": DRAG, "creep": CREEP, "nothing": NOTHING, "both": RUB | DRAG}
BASE = Plant(1.0, 2.0, 400.0)


def row(causes: frozenset[str], any_strength: bool = True, **said: int) -> Row:
    return Row(causes, any_strength, {NAMES[name]: count for name, count in said.items()})


@pytest.fixture(scope="module")
def fitted() -> dict[frozenset[str], Hypothesis]:
    """Sets at some values; nothing here looks at how well they fit."""
    time = np.linspace(0.0, 1.0, 200)
    experiment = Experiment(prepare([from_samples(time, np.ones(200), 0.002 * time)]), BASE, frozenset())
    models: list[Model] = [
        BASE, BASE + CoulombFriction(0.2), BASE + StribeckFriction(0.2, 0.3, 0.01),
        BASE + CoulombFriction(0.2) + QuadraticDrag(1.0), BASE + QuadraticDrag(1.0), BASE + SmoothFriction(0.2, 0.01),
    ]  # fmt: skip
    found = {}
    for model in models:
        problem, weighting, point = formulated(experiment, model, experiment.problem(model).initial)
        causes = frozenset(model.effect_names)
        state = weighting.exact(point, weighting.steps(None))
        found[causes] = Hypothesis(causes, model, problem, state, experiment.readings)
    return found


def ranking(fitted: dict[frozenset[str], Hypothesis], **probability: float) -> Ranking:
    sets = [fitted[NAMES[name]] for name in probability]
    return Ranking(tuple(sets), tuple(map(math.log, probability.values())), tuple(probability.values()))


def test_odds_are_the_ratio_of_the_shares_that_were_called_so() -> None:
    lead = row(RUB, rub=8)
    assert odds(lead, row(PEAK, rub=4, peak=4), "coulomb_friction") == pytest.approx((4.5 / 9.0) / (8.5 / 9.0))
    assert odds(lead, row(PEAK, both=4, peak=4), "coulomb_friction") == pytest.approx((4.5 / 9.0) / (8.5 / 9.0))
    assert odds(lead, row(PEAK, peak=8), "coulomb_friction") == 0.0


def test_a_rival_is_likelier_than_what_leads_only_beyond_chance() -> None:
    assert odds(row(RUB, rub=7, nothing=1), row(PEAK, rub=16), "coulomb_friction") == 1.0
    assert odds(row(RUB, rub=2, nothing=6), row(PEAK, rub=16), "coulomb_friction") > 3.0


def test_what_copies_of_a_rival_are_called_too_is_no_certainty(fitted: dict[frozenset[str], Hypothesis]) -> None:
    stated = ranking(fitted, rub=0.999, nothing=0.001)
    rows = [row(RUB, rub=8), row(PEAK, rub=16), row(NOTHING, nothing=20)]
    after = leading(corrected(stated, rows, fitted))
    assert after.best.causes == RUB, "as likely is no reason to name the richer law"
    assert after.of_cause("coulomb_friction") == pytest.approx(
        1.0 / (1.0 + (16.5 / 17.0) / (8.5 / 9.0) / 2.0 / math.e), abs=0.02
    )
    assert tied(after, "coulomb_friction") == ("stribeck_friction",)
    assert sum(after.probability) == pytest.approx(1.0)
    assert all(math.isfinite(value) for value in after.evidence)


def test_no_cause_is_certain_that_a_quarter_of_a_rivals_copies_are_called(
    fitted: dict[frozenset[str], Hypothesis],
) -> None:
    """However much likelier the leading set was before."""
    stated = ranking(fitted, rub=0.999, nothing=0.001)
    for called, sure in ((4, CERTAIN), (1, None)):
        rows = [row(RUB, rub=8), row(PEAK, rub=called, peak=16 - called), row(NOTHING, nothing=80)]
        found = corrected(stated, rows, fitted).of_cause("coulomb_friction")
        assert found == pytest.approx(sure) if sure else found > 0.95


def test_a_cause_that_falls_below_a_rival_loses_the_headline(fitted: dict[frozenset[str], Hypothesis]) -> None:
    stated = ranking(fitted, rub=0.999, nothing=0.001)
    rows = [row(RUB, rub=2, nothing=6), row(PEAK, rub=16)]
    after = leading(corrected(stated, rows, fitted))
    assert after.best.causes == PEAK
    assert after.of_cause("stribeck_friction") > after.of_cause("coulomb_friction")


def test_without_confusion_a_name_stays_as_sure_as_the_copies_allow(fitted: dict[frozenset[str], Hypothesis]) -> None:
    rows = [row(RUB, rub=8), row(PEAK, peak=16), row(NOTHING, nothing=8)]
    for stated in (ranking(fitted, rub=0.9999, nothing=0.0001), ranking(fitted, rub=1.0, nothing=1e-300)):
        after = corrected(stated, rows, fitted)
        assert after.of_cause("coulomb_friction") == pytest.approx(25.0 / 26.0)
        assert tied(after, "coulomb_friction") == ()
    unsure = ranking(fitted, rub=0.8, nothing=0.2)
    assert corrected(unsure, rows, fitted).of_cause("coulomb_friction") == pytest.approx(0.8), "never surer than before"


def test_a_rival_that_was_not_fitted_and_has_no_stand_in_changes_nothing(
    fitted: dict[frozenset[str], Hypothesis],
) -> None:
    stated = ranking(fitted, rub=0.94, nothing=0.06)
    assert corrected(stated, [row(RUB, rub=8), row(PEAK, rub=16)], {}).probability == stated.probability


def test_other_causes_of_a_set_keep_what_they_have(fitted: dict[frozenset[str], Hypothesis]) -> None:
    stated = ranking(fitted, both=0.98, rub=0.01, nothing=0.01)
    rows = [row(RUB | DRAG, both=8), row(RUB, False, rub=14, both=6), row(NOTHING, False, nothing=20)]
    after = corrected(stated, rows, fitted)
    rival = 0.98 * (6.5 / 21.0) / (8.5 / 9.0) / math.e
    assert after.of_cause("coulomb_friction") == pytest.approx(21.0 / 22.0), "what 20 copies without it allow"
    assert after.of_cause("quadratic_drag") == pytest.approx(21.0 / 22.0 * 0.98 / (0.98 + rival))


def test_without_copies_of_a_poor_experiment_no_cause_is_certain(fitted: dict[frozenset[str], Hypothesis]) -> None:
    after = replace(ranking(fitted, both=0.98, rub=0.01, nothing=0.01), unchecked=True)
    assert after.of_cause("quadratic_drag") == pytest.approx(3.0 / 4.0)
    assert after.of_cause("coulomb_friction") == pytest.approx(60.0 / 61.0)
    assert leading(after).best.causes == RUB | DRAG
    unsure = replace(ranking(fitted, rub=0.6, nothing=0.4), unchecked=True)
    assert unsure.of_cause("coulomb_friction") == pytest.approx(0.6), "never surer than before"


def test_no_cause_is_certain_where_the_cart_moves_before_the_force_is_known(
    fitted: dict[frozenset[str], Hypothesis],
) -> None:
    found = replace(ranking(fitted, both=0.98, rub=0.01, nothing=0.01), pushed_unseen=True)
    assert found.of_cause("coulomb_friction") == pytest.approx(0.9) == found.of_cause("quadratic_drag")
    unsure = replace(ranking(fitted, rub=0.6, nothing=0.4), pushed_unseen=True)
    assert unsure.of_cause("coulomb_friction") == pytest.approx(0.6), "never surer than before"


def test_a_set_that_was_not_checked_says_why(fitted: dict[frozenset[str], Hypothesis]) -> None:
    named = ranking(fitted, rub=0.98, nothing=0.02)
    matrix = Calibration((row(PEAK, peak=8),), {}, {})
    assert left_unchecked(named, None) == left_unchecked(named, matrix) == ()
    open_ = replace(named, unchecked=True)
    (alone,), (after,) = left_unchecked(open_, None), left_unchecked(open_, matrix)
    assert (
        "copies of this record, which take long to simulate, were not made" in alone
        and "--calibrate makes the copies" in alone
    )
    assert after.startswith("The copies of this record were made of another explanation, which they did not confirm:")
    both = replace(ranking(fitted, both=0.98, nothing=0.02), unchecked=True)
    assert "odds are at most 60 to 1. " in alone
    assert "odds are at most 60 to 1 for Coulomb friction, 3 to 1 for quadratic drag. " in left_unchecked(both, None)[0]
    assert left_unchecked(replace(ranking(fitted, nothing=1.0), unchecked=True), None) == (), "nothing is named"


def test_a_cause_that_its_own_copies_never_give_is_not_checked(fitted: dict[frozenset[str], Hypothesis]) -> None:
    stated = ranking(fitted, both=0.98, rub=0.02, nothing=1e-9)
    rows = [row(RUB | DRAG, rub=8), row(RUB, False, rub=14), row(NOTHING, False, nothing=60)]
    after = corrected(stated, rows, fitted)
    assert after.of_cause("quadratic_drag") == pytest.approx(3.0 / 4.0), "the odds of a cause without copies"
    assert after.of_cause("coulomb_friction") > 0.95 and sum(after.probability) == pytest.approx(1.0)
    probabilities = [{name: one.of_cause(name) for name in sorted(RUB | DRAG)} for one in (stated, after)]
    found = Calibration(tuple(rows), *probabilities)
    rub, drag = corrections(found)
    assert rub.endswith("copies of this record.")
    assert "75.0 % after correction" in drag and "none of the 8 copies of the leading explanation was diagnosed" in drag
    weak = ranking(fitted, both=0.5, rub=0.3, nothing=0.2)
    assert corrected(weak, rows, fitted).of_cause("quadratic_drag") == pytest.approx(0.5), "never surer than before"


def test_a_rival_with_another_law_of_a_cause_is_none_of_that_cause(fitted: dict[frozenset[str], Hypothesis]) -> None:
    """Its copies are called friction: they have it."""
    stated = ranking(fitted, both=0.96, creep=0.03, nothing=0.01)
    rows = [row(RUB | DRAG, both=8), row(CREEP, rub=16), row(NOTHING, nothing=200)]
    after = corrected(stated, rows, fitted)
    assert after.of_cause("quadratic_drag") == pytest.approx(0.96) and after.of_cause("coulomb_friction") > 0.96


@pytest.mark.parametrize("limits", [{}, {"pushed_unseen": True}, {"unchecked": True}])
def test_a_limited_cause_has_its_limit_and_the_sets_add_up_to_one(
    fitted: dict[frozenset[str], Hypothesis], limits: dict[str, bool]
) -> None:
    """However much of its sets' probability a cause had before: here what is left limits it to 5 to 1."""
    stated = ranking(fitted, drag=0.98, nothing=0.02).with_caveats(DRAG, clear={"quadratic_drag": 5.0})
    stated = replace(stated, **limits)
    after = corrected(stated, [row(DRAG, False, nothing=8), row(NOTHING, nothing=20)], fitted)
    assert after.of_cause("quadratic_drag") == pytest.approx(0.75)
    assert sum(after.probability) == pytest.approx(1.0)


def test_a_correction_makes_no_named_cause_surer(fitted: dict[frozenset[str], Hypothesis]) -> None:
    """What one loses goes to sets without a further one, and a rival that is raised raises none."""
    stated = ranking(fitted, both=0.55, drag=0.44, rub=0.01, nothing=1e-9)
    rows = [row(RUB | DRAG, rub=8), row(NOTHING, False, nothing=20)]
    after = corrected(stated, rows, fitted)
    assert after.of_cause("coulomb_friction") == pytest.approx(0.56)
    assert after.of_cause("quadratic_drag") == pytest.approx(0.75)
    raised = corrected(stated, [row(RUB | DRAG, both=8), row(RUB, False, both=8), *rows[1:]], fitted)
    assert raised.of_cause("coulomb_friction") == pytest.approx(0.56)
    assert raised.of_cause("quadratic_drag") == pytest.approx(0.99 / (0.99 + 0.55 / math.e))
    assert sum(after.probability) == pytest.approx(1.0) == sum(raised.probability)


def test_json_holds_every_count() -> None:
    found = Calibration(
        (row(RUB, rub=7, nothing=1), row(PEAK, rub=16)), {"coulomb_friction": 0.99}, {"coulomb_friction": 0.5}
    )
    told = found.to_json_dict()
    assert told["copies"] == 24 and told["causes"] == [{"name": "coulomb_friction", "stated": 0.99, "corrected": 0.5}]
    assert told["rows"][0] == {
        "causes": ["coulomb_friction"], "any_strength": True, "copies": 8, "right": 7,
        "said": [{"causes": ["coulomb_friction"], "copies": 7}, {"causes": [], "copies": 1}],
    }  # fmt: skip
    assert found.columns == (RUB, NOTHING), "what was never said has no column"
    assert replace(found, rows=found.rows[1:]).copies == 16
