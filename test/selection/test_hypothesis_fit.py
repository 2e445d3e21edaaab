"""Fits of a set: which starts are followed, and where they end."""

from __future__ import annotations

import numpy as np
import pytest
from setrigs import BASE, pushed, rubbing, stood

from msd_ident.estimate.problem import Initial
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.selection import hypothesis_fit
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import StartingPoint, _stronger, begin, exactly, finish, refine

RUB = CoulombFriction(0.3)
CAUSES = frozenset({"coulomb_friction"})


def test_a_promise_of_much_is_followed_however_far_it_is() -> None:
    """A first step that takes most of a large error away tells little of where the descent ends."""
    fitted = stood(rubbing(), BASE)
    small, large = StartingPoint(9.0, fitted, beside=10.0), StartingPoint(40.0, fitted, beside=1000.0)
    assert not small.worth(5.0) and small.worth(9.5)
    assert large.worth(5.0)


def test_a_start_that_may_go_far_along_a_weak_direction_is_followed() -> None:
    fitted = stood(rubbing(), BASE)
    assert StartingPoint(9.0, fitted, beside=10.0, least=4.0).worth(5.0)
    assert not StartingPoint(9.0, fitted, beside=10.0, least=6.0).worth(5.0)


def test_a_set_is_refined_to_the_noise_and_no_further() -> None:
    data = pushed(RUB)
    wrong = BASE.with_values({"mass": 1.2, "damping": 1.5, "stiffness": 460.0}) + CoulombFriction(0.1)
    found = refine(data, CAUSES, wrong, (Initial(),))
    assert found.chi / data.evidence == pytest.approx(1.0, abs=0.15)
    for name, truth in zip((BASE + RUB).names, (BASE + RUB).values, strict=True):
        assert found.model[name] == pytest.approx(truth, rel=0.01)
    again = refine(data, CAUSES, found.model, found.initial)
    assert abs(again.chi - found.chi) < 0.1
    assert found.state.exact and exactly(data, found) is found


def test_the_first_start_is_followed_and_others_where_they_promise_enough() -> None:
    data = pushed(RUB)
    models = [BASE + CoulombFriction(force) for force in (0.6, 0.2, 0.4)]
    sets = [stood(data, model) for model in models]
    starts = [StartingPoint(promise, one, beside=1.0) for promise, one in zip((9.0, 5.0, 7.0), sets, strict=True)]
    for reach, followed in ((1.0, 1), (6.0, 2), (100.0, 3)):
        begun = begin(data, starts, reach)
        assert len(begun) == followed
        assert [one.chi for one in begun] == sorted(one.chi for one in begun)
        assert begun[0].chi < max(one.chi for one in sets)


def test_a_start_that_promises_more_than_those_before_it_have_reached_is_not_followed() -> None:
    data = pushed(RUB)
    near, far = (stood(data, BASE + CoulombFriction(force)) for force in (0.2, 0.6))
    (reached,) = begin(data, [StartingPoint(1.0, near, beside=1.0)], np.inf)
    for promise, followed in ((1.1 * reached.chi, 1), (0.9 * reached.chi, 2)):
        assert len(begin(data, [StartingPoint(1.0, near, 1.0), StartingPoint(promise, far, 1.0)], np.inf)) == followed


def test_the_best_beginning_is_finished() -> None:
    data = pushed(RUB)
    begun = begin(data, [StartingPoint(1.0, stood(data, BASE + CoulombFriction(f)), 1.0) for f in (0.5, 0.1)], 10.0)
    found = finish(data, begun, np.inf)
    assert found.causes == CAUSES and found.chi <= begun[0].chi
    assert found.chi / data.evidence == pytest.approx(1.0, abs=0.15)


def test_a_fit_to_ripples_that_are_too_weak_begins_again_with_more_strength() -> None:
    """Where the cart does not stick at the ripples, the error has a minimum of its own."""
    data = pushed(RUB)
    ripple = Cogging(0.2, 3e-3, 0.5)
    fitted = stood(data, BASE + RUB + ripple)
    stronger = _stronger(fitted)
    assert stronger is not None
    values = dict(zip(fitted.model.names, fitted.problem.values(stronger), strict=True))
    assert values["cogging_amplitude"] == pytest.approx(1.5 * 0.2)
    others = [name for name in values if name != "cogging_amplitude"]
    assert all(values[name] == pytest.approx(fitted.model[name]) for name in others)
    assert _stronger(stood(data, BASE + RUB)) is None


def test_what_leads_further_down_is_gone_on_from(monkeypatch: pytest.MonkeyPatch) -> None:
    """One start beside a minimum may lead to the next minimum only, not yet to the lowest."""
    data = pushed(RUB)
    chain = [stood(data, BASE + CoulombFriction(force)) for force in (1.0, 0.8, 0.6, 0.4)]
    monkeypatch.setattr(hypothesis_fit, "_settled", lambda experiment, fitted, least: fitted)
    monkeypatch.setattr(hypothesis_fit, "_kicked", lambda experiment, fitted: chain[chain.index(fitted) + 1 :][:1])
    assert [one.chi for one in chain] == sorted((one.chi for one in chain), reverse=True)
    assert finish(data, chain[:1], np.inf) is chain[-1]
    assert finish(data, chain[:1], chain[2].chi / 10.0) is not chain[-1], "a set that is hopeless is left"


def test_far_from_the_noise_only_a_set_that_leads_is_begun_from_other_starts() -> None:
    """There most sets leave about as much as the leading one."""
    data = rubbing()
    near, far = (times * hypothesis_fit.COMPARABLE * data.evidence for times in (0.9, 1.1))
    assert hypothesis_fit._worth_kicking(data, far) == far
    assert hypothesis_fit._worth_kicking(data, near) > near


def test_a_set_is_given_up_by_what_its_next_step_promises_where_another_leaves_only_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Far from the noise no model is right: there a promise says little, and the steps are made."""
    data = rubbing()
    alone = refine(data, frozenset(), BASE, (Initial(),))  # at its least, without the friction that acts
    made: list[int] = []

    def lower(experiment: object, fitted: Hypothesis, steps: int) -> Hypothesis:
        made.append(steps)
        return fitted

    monkeypatch.setattr(hypothesis_fit, "_lower", lower)
    assert alone.chi > 100.0 * data.evidence
    for least, steps in ((1.01 * data.evidence, 0), (30.0 * data.evidence, 1)):
        made.clear()
        assert hypothesis_fit._settled(data, alone, least) is alone and len(made) == steps
    far = stood(data, BASE.with_values({"stiffness": 300.0}))
    hypothesis_fit._settled(data, far, 1.01 * data.evidence)
    assert made, "a step would take most of what it leaves"
