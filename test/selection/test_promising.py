"""Fitted sets that are worth more than they show alone."""

from __future__ import annotations

from setrigs import BASE, fitted, steps

from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.modulated_disturbance import ModulatedDisturbance
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.smooth_stribeck_friction import SmoothStribeckFriction
from msd_ident.model.effects.stiffness_drift import StiffnessDrift
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.promising import explaining, pairs
from msd_ident.selection.structure_search import Search


def test_laws_that_leave_a_tenth_less_than_the_base_model_explain_something() -> None:
    data = steps()
    sets = [fitted(data, BASE, 100.0), fitted(data, BASE + CubicSpring(1e6), 89.0)]
    sets.append(fitted(data, BASE + QuadraticDrag(1.0), 91.0))
    assert explaining(data, {one.causes: one for one in sets}) == [{"cubic_spring"}]


def test_the_causes_that_leave_least_are_paired() -> None:
    data = steps()
    laws = {BASE + Backlash(1e-3): 300.0, BASE + CubicSpring(1e6): 200.0, BASE + CoulombFriction(0.1): 900.0}
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    alone = [fitted(data, model, left) for model, left in laws.items()]
    pair = fitted(data, BASE + Backlash(1e-3) + CoulombFriction(0.1), 10.0)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9000.0), *alone, pair)}
    found = pairs(data, search.sets, search.ranking())
    assert frozenset({"backlash", "cubic_spring"}) in found
    assert frozenset({"backlash", "coulomb_friction"}) not in found, "friction leaves more than four times as much"


def test_another_form_of_a_law_is_paired_where_the_simple_one_leads() -> None:
    """Smooth forms of friction beside every law that leaves much took a sixth of the time of a measured cart."""
    data = steps()
    forms = {BASE + StribeckFriction(0.1, 0.2, 0.01): 300.0, BASE + SmoothStribeckFriction(0.1, 0.2, 0.01, 1e-3): 250.0}
    alone = [fitted(data, model, left) for model, left in {**forms, BASE + Backlash(1e-3): 280.0}.items()]
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9000.0), *alone)}
    found = pairs(data, search.sets, search.ranking())
    assert frozenset({"backlash", "stribeck_friction"}) in found
    assert not any("smooth_stribeck_friction" in pair for pair in found)


def test_the_likeliest_causes_are_paired_where_a_flexible_law_leaves_least() -> None:
    """Drag and a drift of the stiffness in a free decay: a modulated disturbance leaves a fiftieth of either."""
    data = steps()
    laws = {
        BASE + QuadraticDrag(1.0): 8e5,
        BASE + StiffnessDrift(0.1): 5e5,
        BASE + ModulatedDisturbance(1.0, 9.0, 0.0, 2.0, 0.1, 0.0, 0.1, 0.0): 1e4,
    }
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    alone = [fitted(data, model, left) for model, left in laws.items()]
    search.sets = {one.causes: one for one in (fitted(data, BASE, 1e6), *alone)}
    assert frozenset({"quadratic_drag", "stiffness_drift"}) in pairs(data, search.sets, search.ranking())


def test_laws_that_are_linear_in_their_parameters_are_paired_however_much_each_leaves() -> None:
    """A cubic and a quadratic spring: one with two slopes leaves a twelfth of what each of them does."""
    data = steps()
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 9000.0), fitted(data, BASE + Backlash(1e-3), 10.0))}
    found = pairs(data, search.sets, search.ranking())
    assert frozenset({"cubic_spring", "asymmetric_spring"}) in found
    assert not any("backlash" in pair or "cogging" in pair for pair in found)


def test_causes_that_a_third_one_imitates_are_paired_although_it_leaves_far_less() -> None:
    """Ripples leave less than half of what play or a softening spring does alone; only these two together explain."""
    data = steps()
    laws = {BASE + Cogging(1.0, 0.01, 0.0): 40.0, BASE + Backlash(1e-3): 250.0, BASE + CubicSpring(1e6): 600.0}
    alone = [fitted(data, model, left) for model, left in laws.items()]
    search = Search(data, lambda fitted: False, lambda stage, part, cause: None)
    search.sets = {one.causes: one for one in (fitted(data, BASE, 1200.0), *alone)}
    pair = frozenset({"backlash", "cubic_spring"})
    assert pair not in pairs(data, search.sets, search.ranking()) and frozenset({"backlash"}) in explaining(
        data, search.sets
    )
