"""What is said of every cause of the library."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from functools import cache

import pytest
from setrigs import BASE, pushed

from msd_ident.estimate.problem import Initial
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.cause_assessment import CauseAssessment, assess, noted
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.ordering import rank
from msd_ident.selection.ranking import Ranking

RUB, DRAG = CoulombFriction(0.3), QuadraticDrag(0.5)
MODELS = (BASE, BASE + RUB, BASE + DRAG, BASE + RUB + DRAG)


@cache
def experiment() -> Experiment:
    return pushed(RUB)


@cache
def fitted() -> dict[Causes, Hypothesis]:
    sets = (refine(experiment(), frozenset(model.effect_names), model, (Initial(),)) for model in MODELS)
    return {one.causes: one for one in sets}


def ranking(*names: Collection[str]) -> Ranking:
    """Of some of the fitted sets, with what each leaves."""
    sets = {causes: one for causes, one in fitted().items() if causes in map(frozenset, names)}
    found = rank(sets, scale_from(list(sets.values()), experiment().readings))
    return replace(found, left={causes: floors(*causes) for causes in sets})


def floors(*causes: str) -> float:
    """What a set leaves."""
    return math.sqrt(fitted()[frozenset(causes)].chi / experiment().evidence)


def assessed(
    found: Ranking, named: Collection[str], tied: Collection[str] = (), library: Collection[str] | None = None
) -> dict[str, CauseAssessment]:
    library = experiment().library if library is None else library
    return {one.name: one for one in assess(library, found, frozenset(named), tied)}


ALL = ([], ["coulomb_friction"], ["quadratic_drag"], ["coulomb_friction", "quadratic_drag"])


def test_every_cause_is_told_once_and_those_of_the_model_first() -> None:
    found = assess(experiment().library, ranking(*ALL), frozenset({"coulomb_friction"}), ())
    assert sorted(one.name for one in found) == sorted(effect.name for effect in LIBRARY)
    assert [one.held for one in found] == [True] + [False] * (len(found) - 1)
    chances = [one.probability for one in found[1:]]
    assert chances == sorted(chances, reverse=True)
    assert found[0].alone == pytest.approx(floors("coulomb_friction"))
    assert found[0].to_json_dict()["noise_floors_alone"] == found[0].alone


def test_another_law_of_a_named_cause_has_the_probability_of_its_own_sets() -> None:
    """Friction acts, but in no set by this law: its row says why it is not held, beside the probability of that."""
    found = assessed(ranking(*ALL), {"coulomb_friction"})
    assert found["coulomb_friction"].probability > 0.99
    assert found["smooth_friction"].probability == 0.0 == found["smooth_friction_turn"].probability
    assert "another law of Coulomb friction" in found["smooth_friction"].reason


def test_the_reason_is_what_remains_with_and_without() -> None:
    found = assessed(ranking(*ALL), {"coulomb_friction"})
    assert found["coulomb_friction"].reason == f"without it {floors():.3g} noise floors remain."
    beside = floors("coulomb_friction", "quadratic_drag")
    said = found["quadratic_drag"].reason
    assert said.startswith("alone it ") and f"{floors('quadratic_drag'):.3g}" in said
    assert said.endswith(f"; with the named causes {beside:.3g}, too little to justify its parameters.")
    apart = assessed(ranking(*ALL[:3]), {"coulomb_friction"})["quadratic_drag"].reason
    assert apart.endswith(f"; the named causes leave {floors('coulomb_friction'):.3g}.")
    less = assessed(ranking(*ALL[:3]), {"quadratic_drag"})["coulomb_friction"].reason
    assert floors("coulomb_friction") < floors("quadratic_drag")
    assert less.endswith(f"leave {floors('quadratic_drag'):.3g}, more, but not by enough to justify its parameters.")


def test_what_was_not_fitted_says_why() -> None:
    found = assessed(ranking(*ALL), {"coulomb_friction"}, tied=("stribeck_friction",))
    assert found["stribeck_friction"].reason == "could replace a named cause: this data cannot tell them apart."
    best = min(floors(*causes) for causes in ALL)
    assert found["cubic_spring"].reason.startswith("not fitted completely: its first fits are far from")
    assert f" {best:.3g} noise floors that the best of all fitted sets leaves." in found["cubic_spring"].reason
    assert math.isnan(found["cubic_spring"].alone)
    assert found["power_drag"].reason.startswith("another law of quadratic drag, which is fitted only if")
    assert found["gravity"].reason.startswith("cannot act here: it is a law of a joint")
    alone = assessed(ranking([]), ())
    assert alone["cubic_spring"].reason == "not fitted: the base model leaves only noise."


def test_what_cannot_act_or_be_seen_says_so() -> None:
    found = assessed(ranking(*ALL), {"coulomb_friction"}, library=("coulomb_friction",))
    assert found["backlash"].reason.startswith("cannot act here, or not be seen: it needs a spring")
    assert found["force_gain_nonlinearity"].reason == found["backlash"].reason
    assert found["cogging"].reason.startswith("cannot be seen here: the quantity that it depends on")


def test_of_two_looks_at_a_set_the_later_counts() -> None:
    thin = experiment().thinned(300)
    first = rank({frozenset(): refine(thin, frozenset(), BASE, (Initial(),))}, scale_from([fitted()[frozenset()]], ()))
    later = ranking(["coulomb_friction"])
    both = noted(later, experiment(), (first, thin))
    assert both.left[frozenset()] == pytest.approx(math.sqrt(first.best.chi / thin.evidence))
    again = noted(ranking([], ["coulomb_friction"]), experiment(), (first, thin))
    assert again.left[frozenset()] == pytest.approx(floors())
