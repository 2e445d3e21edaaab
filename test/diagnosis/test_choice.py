"""The set of causes that a diagnosis names."""

from __future__ import annotations

from dataclasses import replace

import pytest
from setrigs import BASE, fitted, pushed, ranked, stood

from msd_ident.diagnosis import choice
from msd_ident.diagnosis.pipeline import silent
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_dead_zone import ForceDeadZone
from msd_ident.model.effects.force_gain_nonlinearity import ForceGainNonlinearity
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import Ranking

BETTER, WORSE = HeldOut(2.0, 1.0, 50.0, (40.0, 60.0)), HeldOut(1.0, 2.0, -100.0, (-120.0, -80.0))


def test_without_causes_nothing_is_checked_and_the_base_is_chosen() -> None:
    base = stood(pushed(), BASE)
    found = choice.chosen(pushed(), base, ranked({"base": base}), False, silent)
    assert found.best is base and found.matrix is None and found.alike == []


def test_the_leading_set_is_chosen_with_its_prediction() -> None:
    experiment = pushed(QuadraticDrag(3.0))
    base, drag = (stood(experiment, one) for one in (BASE, BASE + QuadraticDrag(3.0)))
    stages: list[str] = []
    found = choice.chosen(
        experiment, base, ranked({"base": base, "drag": drag}, 1000.0), False, lambda stage, *_: stages.append(stage)
    )
    assert found.best is drag and found.ranking.best is drag
    assert found.heldout.better and "prediction of left-out data" in stages


@pytest.mark.parametrize(("told", "named"), [(BETTER, "force_dead_zone"), (WORSE, "force_gain_nonlinearity")])
def test_a_law_of_the_gain_that_fits_alike_leads_only_if_it_predicts(
    monkeypatch: pytest.MonkeyPatch, told: HeldOut, named: str
) -> None:
    experiment = pushed()
    base = fitted(experiment, BASE, 1e6)
    limited = fitted(experiment, BASE + ForceGainNonlinearity(0.01, 11.0), 1010.0)
    dead = fitted(experiment, BASE + ForceDeadZone(0.6), 1011.0)
    monkeypatch.setattr(choice.naming, "predicting", lambda asked, base, ranking: (ranking, limited, BETTER))
    monkeypatch.setattr(choice.replication, "checked", lambda asked, base, ranking, *_: (ranking, None))
    monkeypatch.setattr(choice.gain_laws, "alike", lambda *_: [dead])
    monkeypatch.setattr(choice.gain_laws, "leading", lambda *_: dead)
    monkeypatch.setattr(choice, "predict", lambda *_: told)
    found = choice.chosen(experiment, base, ranked({"base": base, "gain": limited}, 1000.0), False, silent)
    assert found.best.causes == {named} and found.ranking.best is found.best
    assert [one.causes for one in found.alike] == [{"force_gain_nonlinearity", "force_dead_zone"} - {named}]


def test_copies_that_change_the_leader_call_for_another_prediction(monkeypatch: pytest.MonkeyPatch) -> None:
    experiment = pushed()
    base = fitted(experiment, BASE, 1e6)
    rubs = fitted(experiment, BASE + CoulombFriction(0.1), 1010.0)
    drag = fitted(experiment, BASE + QuadraticDrag(1.0), 1011.0)
    given = ranked({"base": base, "rubs": rubs, "drag": drag}, 1000.0).led_by(rubs)
    asked: list[Ranking] = []

    def predicting(experiment: object, base: object, ranking: Ranking) -> tuple[Ranking, object, HeldOut]:
        asked.append(ranking)
        return ranking, ranking.best, BETTER

    turned = replace(given.led_by(drag), probability=(0.8, 0.15, 0.05))
    monkeypatch.setattr(choice.naming, "predicting", predicting)
    monkeypatch.setattr(choice.replication, "checked", lambda *_: (turned, None))
    found = choice.chosen(experiment, base, given, False, silent)
    assert found.best is drag and len(asked) == 2
    assert asked[1].unchecked, "the copies were made for another leader"


@pytest.mark.parametrize("poor", [True, False])
def test_what_leads_is_chosen_with_what_the_experiment_shows(monkeypatch: pytest.MonkeyPatch, poor: bool) -> None:
    """Known only after the choice, it turned the choice, and a rich experiment was said to need copies."""
    experiment = pushed(QuadraticDrag(3.0))
    base, drag = (stood(experiment, one) for one in (BASE, BASE + QuadraticDrag(3.0)))
    asked: list[Ranking] = []
    predicting = choice.naming.predicting

    def noted(experiment: Experiment, base: Hypothesis, ranking: Ranking) -> tuple[Ranking, Hypothesis, HeldOut]:
        asked.append(ranking)
        return predicting(experiment, base, ranking)

    monkeypatch.setattr(choice.naming, "predicting", noted)
    monkeypatch.setattr(choice.replication, "is_poor", lambda *_: poor)
    monkeypatch.setattr(choice.replication, "checked", lambda asked, base, ranking, *_: (ranking, None))
    found = choice.chosen(experiment, base, ranked({"base": base, "drag": drag}, 1000.0), False, silent)
    assert [one.rich for one in asked] == [not poor] and found.ranking.rich is not poor
    assert not found.ranking.unchecked


def test_no_cause_is_certain_where_the_base_model_is_chosen_against_a_likely_set(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The base model leads for its fewer causes, and left-out data do not confirm the likelier set."""
    experiment = pushed()
    base = fitted(experiment, BASE, 1100.0)
    drag = fitted(experiment, BASE + QuadraticDrag(1.0), 1010.0)
    given = ranked({"base": base, "drag": drag}, 1000.0).led_by(base)
    given = replace(given, probability=(0.05, 0.95), evidence=(0.0, 3.0))
    monkeypatch.setattr(choice.naming, "predict", lambda *_: WORSE)
    found = choice.chosen(experiment, base, given, False, silent)
    assert found.best is base and found.ranking.unchecked
    assert found.ranking.of_cause("quadratic_drag") <= 0.75
