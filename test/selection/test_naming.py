"""Which set is named: no cause below its rival, and what could stand in its place is told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from likelihoods import Set, ranking

from msd_ident.selection import doubts, naming, ties
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import CERTAIN
from msd_ident.selection.cross_validation import HeldOut
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import DECISIVE, Ranking

NAMES = ("backlash", "cogging", "coulomb_friction", "hysteresis", "quadratic_drag")


def drawn(seed: int) -> Ranking:
    """Sets of one to three causes with any evidence; the simplest of those near the best leads."""
    rng = np.random.default_rng(seed)
    sets: dict[tuple[str, ...], float] = {}
    for _ in range(rng.integers(1, 9)):
        causes = tuple(sorted(rng.choice(NAMES, size=rng.integers(1, 4), replace=False).tolist()))
        sets[causes] = float(np.exp(-rng.exponential(3.0)))
    near = [causes for causes, p in sets.items() if p >= max(sets.values()) * np.exp(-DECISIVE)]
    return ranking(sets, min(near, key=len))


@pytest.mark.parametrize("seed", range(300))
def test_no_cause_is_named_with_less_probability_than_one_left_out(seed: int) -> None:
    """But where every explanation does so, and then the one left out stands beside it, tied."""
    given = drawn(seed)
    found = naming.leading(given)
    named = found.best.causes
    others = {name for one in found.sets for name in one.causes} - named
    near = [
        one.causes
        for one, value in zip(given.sets, given.evidence, strict=True)
        if value >= max(given.evidence) - DECISIVE
    ]
    assert named in near
    for name in named:
        above = {other for other in others if found.of_cause(other) > found.of_cause(name) + 1e-9}
        assert above <= set(ties.tied(found, name))
        if above:
            assert all(naming.margin(given, causes) < 0.0 for causes in near)
    if naming.margin(given, given.best.causes) >= 0.0:
        assert found.best is given.best


def test_the_simplest_leads_no_more_where_a_rival_is_likelier() -> None:
    given = ranking({("coulomb_friction",): 0.15, ("cogging", "hysteresis"): 0.85}, ("coulomb_friction",))
    found = naming.leading(given)
    assert found.best.causes == {"cogging", "hysteresis"}
    assert ties.tied(found, "cogging") == ("coulomb_friction",)


def test_a_set_that_predicts_nothing_takes_its_probability_with_it() -> None:
    given = ranking({("cogging",): 0.9, ("hysteresis",): 0.08, ("backlash",): 0.02})
    found = naming.without(given, given.best)
    assert found.best.causes == {"hysteresis"}
    assert found.of_cause("hysteresis") == pytest.approx(0.8) and found.of_cause("cogging") == 0.0


def test_without_what_may_be_another_form_the_others_have_the_probability_that_it_does_not_act() -> None:
    """For parameters that differ between them: by their evidence alone they would have none."""
    both = frozenset({"backlash", "cogging"})
    given = ranking({("backlash", "cogging"): 1.0, ("backlash",): 1e-9, ("hysteresis",): 1e-12})
    assert naming.chances(given)[frozenset({"backlash"})] < 1e-6
    found = naming.chances(given.with_caveats(both, further={"cogging": 0.084}))
    assert found[frozenset({"backlash"})] == pytest.approx(0.25) and found[frozenset({"hysteresis"})] < 1e-6


def left_over(first: tuple[str, ...], chi: Mapping[tuple[str, ...], float], ahead: float = 1.01 * DECISIVE) -> Any:
    """What samples left out have to decide between sets that leave these chi² of 100 pieces of evidence, which speaks
    for the leading set by ``ahead`` nats.
    """
    sets = {causes: cast(Hypothesis, Set(frozenset(causes), left)) for causes, left in chi.items()}
    order = sorted(sets, key=lambda causes: causes != first)
    even = tuple(1.0 / len(order) for _ in order)
    caveats = {one.causes: Caveats(one.causes, exact=one.chi < 110.0) for one in sets.values()}
    values = (0.0, *(-ahead for _ in order[1:]))
    given = Ranking(tuple(sets[causes] for causes in order), values, even, caveats=caveats)
    return naming._leaving_less(given, cast(Any, SimpleNamespace(evidence=100.0)), sets[()])


def test_a_law_that_leaves_little_is_tried_where_the_leader_leaves_more_than_it_explains() -> None:
    """As the evidence does not call for it, it is not certain: at most 9 to 1 where only noise is left, else even."""
    found = left_over((), {(): 1e4, ("coulomb_friction",): 9.9e3, ("cogging",): 98.0})
    assert found.best.causes == {"cogging"} and found.of_cause("cogging") == pytest.approx(CERTAIN)
    assert "evidence does not" in doubts.sentences(found)[-1]
    found = left_over(("coulomb_friction",), {(): 1e4, ("coulomb_friction",): 7e3, ("cogging",): 1.5e3})
    assert found.best.causes == {"cogging"} and found.of_cause("cogging") == pytest.approx(0.5)
    found = left_over(("hysteresis",), {(): 3e5, ("hysteresis",): 9e4, ("cogging",): 800.0})
    assert found.best.causes == {"cogging"} and found.of_cause("cogging") == pytest.approx(0.5), "a tenth of the error"
    found = left_over((), {(): 1e4, ("coulomb_friction",): 1e3, ("cogging",): 98.0})
    assert [one.causes for one in found.sets] == [{"cogging"}], "what leaves only noise comes first"


@pytest.mark.parametrize(("rich", "sure"), [(True, 0.97), (False, 0.75)])
def test_what_the_evidence_calls_for_too_is_as_sure_as_before(rich: bool, sure: float) -> None:
    """Drag was stated with 0.97, and with 0.5 beside a tone that left-out data call for. A poor experiment that
    left-out data decide has no copies, which limits it.
    """
    pair = ("periodic_disturbance", "quadratic_drag")
    chi = {(): 3e5, ("quadratic_drag",): 9e4, ("hysteresis",): 2e5, pair: 500.0}
    sets = {causes: cast(Hypothesis, Set(frozenset(causes), left)) for causes, left in chi.items()}
    order = [("quadratic_drag",), ("hysteresis",), pair, ()]
    given = Ranking(
        tuple(sets[causes] for causes in order), (0.0, -3.5, -20.0, -30.0), (0.97, 0.03, 0.0, 0.0), rich=rich
    )
    found = naming._leaving_less(given, cast(Any, SimpleNamespace(evidence=100.0)), sets[()])
    assert found is not None and found.best.causes == set(pair)
    assert found.of_cause("quadratic_drag") == pytest.approx(sure)
    assert found.of_cause("periodic_disturbance") == pytest.approx(0.5)
    said = doubts.sentences(found)[-1]
    assert said.startswith("Left-out data calls for periodic disturbance, but the evidence does not, so periodic")


def test_where_the_evidence_is_even_left_out_data_decide_about_half_of_the_error() -> None:
    """Coulomb friction left 62 noise floors of a rig with bristles, hysteresis 24: neither is decisively likelier."""
    chi = {(): 1e4, ("coulomb_friction",): 2.2e3, ("hysteresis",): 340.0}
    assert left_over(("coulomb_friction",), chi) is None
    found = left_over(("coulomb_friction",), chi, ahead=0.9 * DECISIVE)
    assert found.best.causes == {"hysteresis"} and found.of_cause("hysteresis") == pytest.approx(0.5)
    three = ("bouc_wen", "coulomb_friction", "quadratic_drag")
    found = left_over(("coulomb_friction",), {**chi, three: 110.0}, ahead=0.9 * DECISIVE)
    assert found.best.causes == {"hysteresis"}, "the least of what the likeliest holds"
    found = left_over(("coulomb_friction",), {**chi, ("hysteresis",): 600.0}, ahead=0.9 * DECISIVE)
    assert found is None, "more than half of the error"


def test_where_the_evidence_is_the_same_left_out_data_decide_about_a_fifth_of_the_error() -> None:
    """A pendulum's softening spring left 12 noise floors, and beside drag, with 0.4 nats less of evidence, 7."""
    pair = ("cubic_spring", "quadratic_drag")
    chi = {(): 9e4, ("cubic_spring",): 1.4e4, pair: 4.8e3}
    found = left_over(("cubic_spring",), chi, ahead=0.4)
    assert found is not None and found.best.causes == set(pair)
    assert left_over(("cubic_spring",), chi, ahead=1.1) is None
    assert left_over(("cubic_spring",), {**chi, pair: 1e4}, ahead=0.4) is None


def test_left_out_data_are_asked_again_of_what_leaves_less_than_the_set_that_they_call_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a pendulum the evidence called for no cause, left-out data for a cubic spring, and then for drag beside it."""
    pair = frozenset({"cubic_spring", "quadratic_drag"})
    chi = {frozenset(): 9e4, frozenset({"cubic_spring"}): 1.8e4, pair: 3e3}
    sets = tuple(cast(Hypothesis, Set(causes, left)) for causes, left in chi.items())
    given = Ranking(sets, (0.0, -2.6, -2.8), (0.87, 0.07, 0.06))
    asked: list[tuple[frozenset[str], frozenset[str]]] = []

    def predicted(experiment: object, before: Hypothesis, one: Hypothesis) -> HeldOut:
        asked.append((before.causes, one.causes))
        return HeldOut(1.0, 0.5, 50.0, (16.0, 70.0))

    monkeypatch.setattr(naming, "predict", predicted)
    found, best, _ = naming.predicting(cast(Any, SimpleNamespace(evidence=100.0)), sets[0], given)
    assert best.causes == pair and (frozenset({"cubic_spring"}), pair) in asked
    assert all(found.of_cause(name) == pytest.approx(0.5) for name in pair)


@pytest.mark.parametrize(
    ("first", "chi"),
    [
        # The leader explains more, and no law leaves less than a tenth of the error.
        (("hysteresis",), {(): 1e4, ("hysteresis",): 4e3, ("cogging",): 98.0}),
        (("hysteresis",), {(): 3e5, ("hysteresis",): 9e4, ("cogging",): 1000.0}),
        ((), {(): 700.0, ("cogging",): 98.0}),  # too little is left for its form to be seen
        ((), {(): 1e4, ("cogging",): 2.6e3}),  # no law leaves less than half of the error
    ],
)
def test_else_evidence_decides(first: tuple[str, ...], chi: Mapping[tuple[str, ...], float]) -> None:
    assert left_over(first, chi) is None


@pytest.mark.parametrize("ripples", [True, False])
def test_where_the_leading_set_predicts_no_better_a_set_that_leaves_less_may(
    monkeypatch: pytest.MonkeyPatch, ripples: bool
) -> None:
    """Friction explains most, and by chance; beside a ripple little is left, which the evidence does not call for."""
    both = frozenset({"cogging", "coulomb_friction"})
    chi = {("coulomb_friction",): 3e3, (): 1e4, tuple(sorted(both)): 5e2}
    given = ranking({("coulomb_friction",): 0.9, (): 0.08, tuple(sorted(both)): 0.02})
    sets = tuple(cast(Hypothesis, Set(one.causes, chi[tuple(sorted(one.causes))])) for one in given.sets)
    base = next(one for one in sets if not one.causes)

    def predicted(experiment: object, base: Hypothesis, one: Hypothesis) -> HeldOut:
        low = 16.0 if one.causes == both and ripples else -5.0
        return HeldOut(1.0, 0.5, 50.0, (low, 70.0))

    monkeypatch.setattr(naming, "predict", predicted)
    asked = cast(Any, SimpleNamespace(evidence=100.0))
    found, best, heldout = naming.predicting(asked, base, replace(given, sets=sets))
    assert best.causes == (both if ripples else frozenset()) and heldout.better is ripples
    assert all(found.of_cause(name) <= CERTAIN for name in best.causes)


@pytest.mark.parametrize("beats", [True, False])
def test_a_set_that_left_out_data_bring_to_the_lead_predicts_better_than_the_one_that_led(
    monkeypatch: pytest.MonkeyPatch, beats: bool
) -> None:
    """To predict better than the base model is not enough: the set that led does too."""
    chi = {("coulomb_friction",): 3e4, (): 2e5, ("cogging",): 2e2}
    given = ranking({("coulomb_friction",): 0.9, (): 0.08, ("cogging",): 0.02})
    sets = tuple(cast(Hypothesis, Set(one.causes, chi[tuple(sorted(one.causes))])) for one in given.sets)
    base = next(one for one in sets if not one.causes)

    def predicted(experiment: object, before: Hypothesis, one: Hypothesis) -> HeldOut:
        low = 16.0 if before is base or beats else -5.0
        return HeldOut(1.0, 0.5, 50.0, (low, 70.0))

    monkeypatch.setattr(naming, "predict", predicted)
    asked = cast(Any, SimpleNamespace(evidence=100.0))
    _, best, heldout = naming.predicting(asked, base, replace(given, sets=sets))
    assert best.causes == ({"cogging"} if beats else {"coulomb_friction"}) and heldout.better


def test_the_likeliest_set_that_leaves_much_less_is_known_though_it_does_not_lead() -> None:
    """A sharp law may lose to no law by its numbers, but that little is left of it is said."""
    left = ((), 8.0), (("cogging",), 1.9), (("quadratic_drag",), 1.0)
    sets = tuple(cast(Hypothesis, Set(frozenset(causes), chi)) for causes, chi in left)
    given = Ranking(sets, (-30.0, -40.0, -45.0), (1.0, 0.0, 0.0))
    assert naming.leaving_less(given, 0.5) == [{"cogging"}, {"quadratic_drag"}]
    assert naming.leaving_less(given, 0.0) == [{"cogging"}, {"quadratic_drag"}]
    assert naming.leaving_less(Ranking(sets[1:], (-40.0, -45.0), (1.0, 0.0)), 0.0) == []


def test_what_is_left_is_counted_above_the_noise() -> None:
    """A law that leaves hardly more than noise takes most of the error away, though half of the chi² is left."""
    left = ((), 2.1), (("cubic_spring",), 1.1), (("cubic_spring", "quadratic_drag"), 1.0), (
        ("bouc_wen", "cogging", "gravity"), 1.0)  # fmt: skip
    sets = tuple(cast(Hypothesis, Set(frozenset(causes), chi)) for causes, chi in left)
    given = Ranking(sets, (-30.0, -34.0, -40.0, -41.0), (1.0, 0.0, 0.0, 0.0))
    assert naming.leaving_less(given, 1.0) == [{"cubic_spring"}], "not with more than that, nor of many"
    larger_first = replace(given, sets=(sets[0], *reversed(sets[1:])))
    assert naming.leaving_less(larger_first, 1.0) == [{"cubic_spring"}], "whichever is likelier"
    assert naming.leaving_less(given, 0.0) == []
    assert naming.leaving_less(given, 2.2) == [], "where only noise is left, nothing takes half of the rest away"
    assert naming.leaving_less(replace(given, sets=sets[:1]), 3.0) == [], "the base model is no explanation"
