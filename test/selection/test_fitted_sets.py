"""How sets are fitted beside those that are known: which count, which are begun again, in what order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from setrigs import BASE, fitted, rubbing, steps, stood

from msd_ident.model import Plant
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stiffness_drift import StiffnessDrift
from msd_ident.selection import fitted_sets
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.fitted_sets import FittedSets
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.hypothesis_fit import StartingPoint


def test_a_start_that_leaves_many_times_what_no_motion_leaves_is_not_followed() -> None:
    """Its fit would simulate a model without a spring, or a stiff one, for minutes."""
    experiment = rubbing()
    base = stood(experiment, BASE)
    search = FittedSets(experiment, lambda fitted: True, lambda stage, part, cause: None)
    search.sets = {base.causes: base}
    rubs = frozenset({"coulomb_friction"})
    search._look_again(rubs, Plant(0.1, 0.0, 0.0) + CoulombFriction(0.0), base.initial)
    assert rubs not in search.sets and rubs not in search.tried
    search._look_again(rubs, BASE + CoulombFriction(0.25), base.initial)
    assert np.isclose(search.sets[rubs].model["coulomb_force"], 0.03 * 9.81, rtol=0.01)


def test_where_a_controller_leads_a_set_that_explains_no_force_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Hypothesis] = []

    def nothing(one: Hypothesis) -> bool:
        asked.append(one)
        return False

    monkeypatch.setattr(fitted_sets, "explains_force", nothing)
    experiment = rubbing()
    base, found = stood(experiment, BASE), stood(experiment, BASE + CoulombFriction(0.25))
    for led, kept in ((False, {base.causes, found.causes}), (True, {base.causes})):
        search = FittedSets(replace(experiment, led=led), lambda fitted: True, lambda stage, part, cause: None)
        for one in (base, found):
            search._keep(one)
        assert search.sets.keys() == kept, "the base model stays"
    assert asked == [found]


def test_a_set_that_leads_is_fitted_to_the_end() -> None:
    experiment = rubbing()
    base, near = stood(experiment, BASE), stood(experiment, BASE + CoulombFriction(0.25))
    search = FittedSets(experiment, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {base.causes: base}
    ended = search._converged(near, base.chi)
    assert np.isclose(ended.model["coulomb_force"], 0.03 * 9.81, rtol=0.01) and search.sets[near.causes] is ended
    assert search._converged(base, ended.chi) is base, "one that does not lead stays as it is"


def test_a_set_whose_further_effect_ends_without_strength_is_a_fit_of_the_set_without_it() -> None:
    experiment = rubbing()
    wrong = stood(experiment, BASE + CoulombFriction(0.15))
    right = BASE + CoulombFriction(0.03 * 9.81)
    search = FittedSets(experiment, lambda fitted: True, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (stood(experiment, BASE), wrong)}
    search._keep(stood(experiment, right + QuadraticDrag(0.0)))
    assert np.isclose(search.sets[wrong.causes].model["coulomb_force"], 0.03 * 9.81, rtol=0.01)
    assert search.sets[wrong.causes].chi < 0.1 * wrong.chi


@pytest.mark.parametrize("drag", [2.0, 2000.0])
def test_a_set_in_a_wrong_minimum_is_fitted_again_from_one_with_a_cause_more(drag: float) -> None:
    """Over 60 swings gravity ended in one that left more than no cause, and beside friction in the right one."""
    experiment = rubbing()
    wrong = stood(experiment, BASE + CoulombFriction(2.0))
    search = FittedSets(experiment, lambda fitted: True, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (stood(experiment, BASE), wrong)}
    search._keep(stood(experiment, BASE + CoulombFriction(0.03 * 9.81) + QuadraticDrag(1e-3 * drag)))
    found = search.sets[wrong.causes]
    assert found.chi < 0.1 * wrong.chi and np.isclose(found.model["coulomb_force"], 0.03 * 9.81, rtol=0.01)
    assert search.sets[frozenset()].chi == stood(experiment, BASE).chi, "the base model has its own fit"


def test_sets_that_were_not_worth_it_are_looked_at_again_beside_one_that_leaves_half() -> None:
    """Their starts promised little from the sets that were known then."""
    data = steps()
    rubs, drag = BASE + CoulombFriction(0.1), BASE + QuadraticDrag(1.0)
    search = FittedSets(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9e5), fitted(data, rubs, 8e5))}
    beside = {frozenset({"quadratic_drag", name}) for name in ("coulomb_friction", "end_stop")}
    other = frozenset({"coulomb_friction", "end_stop"})
    for chi, again in ((4.1e5, False), (3.9e5, True)):
        search.sets.pop(frozenset({"quadratic_drag"}), None)
        search.tried = {*beside, other}
        search._keep(fitted(data, drag, chi))
        assert search.tried == ({other} if again else {*beside, other})


def test_a_larger_set_that_leaves_more_than_one_of_its_parts_is_begun_again() -> None:
    """With one cause more, the least that a set can leave is less: it ended in a wrong minimum."""
    data = steps()
    drag, rubs, spring = QuadraticDrag(1.0), CoulombFriction(0.1), CubicSpring(1e6)
    search = FittedSets(data, lambda fitted: False, lambda stage, part, cause: None)
    more, less = fitted(data, BASE + drag + rubs, 5e5), fitted(data, BASE + drag + spring, 1e5)
    search._know((fitted(data, BASE, 9e5), fitted(data, BASE + drag, 7e5), more, less))
    search._keep(fitted(data, BASE + drag, 4e5))
    assert {more.causes, less.causes} <= search.tried, "the part is hardly better than before"
    search._keep(fitted(data, BASE + drag, 1.9e5))
    assert more.causes not in search.tried
    assert less.causes in search.tried, "it leaves less than its part"


def test_a_set_is_not_fitted_where_one_with_a_cause_more_leaves_far_more_than_noise() -> None:
    """It leaves at least as much: beside a set at the noise it cannot count."""
    data = steps()
    drag, spring, rubs = QuadraticDrag(1.0), CubicSpring(1e6), CoulombFriction(0.1)
    models = {BASE: 9e7, BASE + rubs: 9e6, BASE + drag + rubs: 840.0, BASE + spring + rubs: 8e6}
    for noise_only, asked_for in ((True, {"quadratic_drag"}), (False, {"quadratic_drag", "cubic_spring"})):
        search = FittedSets(data, lambda one, noise_only=noise_only: noise_only, lambda stage, part, cause: None)
        search.sets = {one.causes: one for model, chi in models.items() if (one := fitted(data, model, chi))}
        proposed: list[frozenset[str]] = []
        search._propose = lambda causes, proposed=proposed: proposed.append(causes) or []  # type: ignore[method-assign]
        search._fit([frozenset({name}) for name in ("quadratic_drag", "cubic_spring")], 0.0, 1.0)
        assert proposed == [frozenset({name}) for name in ("quadratic_drag", "cubic_spring") if name in asked_for]


def test_the_most_promising_sets_are_fitted_first_and_others_only_if_these_leave_more_than_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What the others promise is then out of reach, and so are the sets that lack one of their causes."""
    data, rubs = steps(), CoulombFriction(0.1)
    laws = (QuadraticDrag(1.0), CubicSpring(1e6), EndStop(1e-3, 1e4), Backlash(1e-3), StiffnessDrift(1.0))
    pairs = [fitted(data, BASE + law + rubs, 9e6) for law in laws]
    group = [[StartingPoint(8e6 - 1e6 * i, one, beside=9e6)] for i, one in enumerate(pairs)]
    begun: list[frozenset[str]] = []
    ends: list[float] = []

    def start(experiment: Experiment, starts: Sequence[StartingPoint], reach: float) -> list[Hypothesis]:
        begun.append(starts[0].fitted.causes)
        return [starts[0].fitted]

    def end(experiment: Experiment, tries: Sequence[Hypothesis], least: float) -> Hypothesis:
        return fitted(data, tries[0].model, ends[-1] if tries[0] is pairs[-1] else 9e6)

    monkeypatch.setattr("msd_ident.selection.fitted_sets.begin", start)
    monkeypatch.setattr("msd_ident.selection.fitted_sets.finish", end)
    for left, count in ((840.0, 3), (8e6, 5)):
        ends.append(left)
        search = FittedSets(data, lambda one: one.chi < 1e3, lambda stage, part, cause: None)
        monkeypatch.setattr(search, "_converged", lambda one, least, search=search: search._keep(one) or one)
        search.sets = {one.causes: one for one in (fitted(data, BASE, 9e7), fitted(data, BASE + rubs, 9e6))}
        begun.clear()
        search._fit_group(group, (0.0, 1.0))
        assert len(begun) == count and set(begun[:3]) == {one.causes for one in pairs[2:]}
        assert search.beyond == ({one.causes for one in pairs[:2]} if count == 3 else set())
        assert (search._within_reach([frozenset({"quadratic_drag"})]) == []) == (count == 3)


def test_the_leading_set_is_asked_again_only_after_a_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    data = steps()
    search = FittedSets(data, lambda one: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9e5), fitted(data, BASE + Backlash(1e-3), 9e3))}
    before = search._leader()
    assert before is search.sets[frozenset({"backlash"})]
    better = fitted(data, BASE + Backlash(1e-3), 5e3)
    with monkeypatch.context() as patched:
        patched.setattr("msd_ident.selection.fitted_sets.leading", lambda sets, scale: sets[frozenset()])
        assert search._leader() is before
        search._keep(better)
        assert search._leader() is search.sets[frozenset()]
