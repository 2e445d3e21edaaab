"""Sets that differ from one by a cause."""

from __future__ import annotations

from setrigs import steps

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


def test_coulomb_friction_beside_linear_laws_is_what_such_a_law_imitates() -> None:
    assert rubs_and_is_linear(PAIR)
    assert not rubs_and_is_linear(RUBS), "it does not hold Coulomb friction"
    assert not rubs_and_is_linear(frozenset({"coulomb_friction", "backlash"})), "it is not linear"
