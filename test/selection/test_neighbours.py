"""Sets that differ from one by a cause."""

from __future__ import annotations

from setrigs import BASE, fitted, steps

from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.neighbours import LARGEST, Neighbours, rubs_and_is_linear, with_coulomb

PAIR = frozenset({"coulomb_friction", "cubic_spring"})
RUBS = frozenset({"stribeck_friction", "cubic_spring"})


def near() -> Neighbours:
    return Neighbours(steps())


def test_larger_sets_have_one_cause_more_up_to_the_largest() -> None:
    grown = near().grown(PAIR)
    assert len(grown) == len(near().experiment.tried_alone) - 2
    assert all(one > PAIR and len(one) == 3 for one in grown)
    full = frozenset(near().experiment.tried_alone[:LARGEST])
    assert near().grown(full) == []


def test_swapped_sets_lack_a_cause_or_have_another_in_its_place() -> None:
    swapped = near().swapped(PAIR)
    assert frozenset({"cubic_spring"}) in swapped and frozenset({"coulomb_friction"}) in swapped
    assert frozenset({"quadratic_drag", "cubic_spring"}) in swapped
    assert all(len(one - PAIR) <= 1 and len(PAIR - one) == 1 for one in swapped)


def test_another_law_of_a_cause_is_a_neighbour() -> None:
    found = near().reformed(PAIR)
    assert found and set(found) <= set(near().swapped(PAIR))
    assert frozenset({"coulomb_friction", "power_spring"}) in found, "a cubic spring with its next power"


def test_a_law_that_holds_coulombs_as_a_limit_may_be_that_and_a_further_cause() -> None:
    assert with_coulomb(RUBS) == [PAIR]
    assert with_coulomb(PAIR) == []
    resolved = near().resolved(RUBS)
    assert frozenset({*PAIR, "quadratic_drag"}) in resolved
    assert all(one > PAIR and "stribeck_friction" not in one for one in resolved)
    assert near().resolved(PAIR) == []


def test_a_smaller_set_is_not_started_from_where_the_limit_of_a_law_leaves_far_less() -> None:
    """A single law starts next to the base too: there a regression is made."""
    data, spring = steps(), BASE + CubicSpring(1e6)
    for left, begins in ((8e3, [frozenset({"cubic_spring"}), PAIR]), (100.0, [PAIR])):
        models = {BASE: 9e6, spring: 1e4, BASE + CoulombFriction(0.1): 2e3, spring + CoulombFriction(0.1): left}
        known = {one.causes: one for model, chi in models.items() if (one := fitted(data, model, chi))}
        assert [one.causes for one in near().parents(RUBS, known)] == begins
        alone = [one.causes for one in near().parents(frozenset({"stribeck_friction"}), known)]
        assert alone == [frozenset(), frozenset({"coulomb_friction"})]


def test_a_set_without_known_parts_starts_from_the_largest_one() -> None:
    """From the base model, all combinations of the guesses for all its causes would be simulated."""
    data, spring = steps(), BASE + CubicSpring(1e6)
    models = {BASE: 9e6, spring: 1e4, BASE + CoulombFriction(0.1): 2e3, spring + CoulombFriction(0.1): 8e3}
    known = {one.causes: one for model, chi in models.items() if (one := fitted(data, model, chi))}
    wanted = PAIR | {"backlash", "cogging"}
    assert [one.causes for one in near().parents(wanted, known)] == [PAIR]
    del known[PAIR]
    assert [one.causes for one in near().parents(wanted, known)] == [frozenset({"coulomb_friction"})]


def test_coulomb_friction_beside_linear_laws_is_what_such_a_law_imitates() -> None:
    assert rubs_and_is_linear(PAIR)
    assert not rubs_and_is_linear(RUBS), "it does not hold Coulomb friction"
    assert not rubs_and_is_linear(frozenset({"coulomb_friction", "backlash"})), "it is not linear"


def test_a_large_set_with_a_ripple_does_not_start_from_the_base() -> None:
    """Each combination of guesses is simulated: for five laws of a stiff rig this took ten minutes, for one set."""
    data, beside = steps(), near()
    beside.__dict__["rippled"] = frozenset({"cogging"})
    spring = BASE + CubicSpring(1e6)
    models = {BASE: 9e6, spring: 8e3, spring + CoulombFriction(0.1): 2e3}
    known = {one.causes: one for model, chi in models.items() if (one := fitted(data, model, chi))}
    few, many = frozenset({"cubic_spring", "cogging"}), PAIR | {"cogging"}
    assert frozenset() in [one.causes for one in beside.parents(few, known)]
    assert frozenset() in [one.causes for one in beside.parents(many, known)], "three laws have few combinations"
    form = frozenset({"rubbing_second_mode", "cogging"})
    begun = [
        fitted(data, BASE + law, chi) for law, chi in ((Cogging(1.0, 0.01, 0.0), 2e3), (CoulombFriction(0.1), 8e6))
    ]
    assert [one.causes for one in beside.parents(form, known | {one.causes: one for one in begun})] == [{"cogging"}], (
        "a form is begun from its simple law: 68 000 combinations were simulated for 31 sets"
    )
    three = fitted(data, spring + CoulombFriction(0.1) + QuadraticDrag(1.0), 1e3)
    known[three.causes] = three
    assert [one.causes for one in beside.parents(three.causes | {"cogging"}, known)] == [three.causes]
