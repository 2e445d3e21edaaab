"""Sets simpler than a fitted one."""

from __future__ import annotations

from dataclasses import replace

import pytest
from setrigs import BASE, pushed, steps, stood

from msd_ident.model import Effect
from msd_ident.model.effects.bouc_wen import BoucWen
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.damped_stop import DampedStop
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_dead_zone import ForceDeadZone
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.simpler_sets import equal_to, nearest, reduced


@pytest.mark.parametrize(
    ("effect", "equal"),
    [
        (CubicSpring(0.0), [set()]),
        (CubicSpring(1.0), []),
        (StribeckFriction(0.3, 0.3, 0.05), [{"coulomb_friction"}]),
        (StribeckFriction(0.3, 0.6, 0.05), []),
    ],
)
def test_an_effect_without_strength_or_without_its_peak_is_a_simpler_set(effect: Effect, equal: list[set[str]]) -> None:
    assert set(equal_to(stood(steps(), BASE + effect))) == {frozenset(one) for one in equal}


def test_the_simple_law_is_begun_where_another_form_of_it_stands() -> None:
    form = stood(steps(), BASE + DampedStop(2e-3, 500.0, 0.0))
    found = {causes: model for causes, model, _ in reduced(form, ())}
    assert found[frozenset({"end_stop"})] == BASE + EndStop(2e-3, 500.0)
    asymmetric = stood(steps(), BASE + BoucWen(80.0, 2e3, 3e3))
    found = {causes: model for causes, model, _ in reduced(asymmetric, ())}
    assert found[frozenset({"hysteresis"})] == BASE + Hysteresis(0.04, 5e-4), "as stiff, and as strong under load"
    hardening = stood(steps(), BASE + BoucWen(80.0, -2.0, 3e3))
    assert {causes for causes, *_ in reduced(hardening, ())} == {frozenset()}, "its force has no limit"
    gone = stood(steps(), BASE + ForceDeadZone(0.1))  # its simple law, a slope of the gain, has no value of it
    assert {causes for causes, *_ in reduced(gone, ())} == {frozenset()}


def test_coulomb_friction_stands_for_a_law_that_holds_it() -> None:
    curve = stood(steps(), BASE + StribeckFriction(0.3, 0.6, 0.05))
    found = {causes: model for causes, model, _ in reduced(curve, ())}
    assert found[frozenset({"coulomb_friction"})] == BASE + CoulombFriction(0.3)


@pytest.mark.parametrize(("strength", "sense"), [(1e5, 1.0), (1e-3, 1e12)])
def test_a_simpler_set_starts_where_it_leaves_least(strength: float, sense: float) -> None:
    """Beside friction that only holds the cart a move of the other parameters made it slip, and a drift of nothing was
    named for that. ``sense``: by how much the Jacobian overrates the effect that is left out.
    """
    data = pushed(CubicSpring(strength))
    one = stood(data, BASE + CubicSpring(strength))
    rows = one.state.jacobian.copy()
    rows[one.problem.names.index("cubic_stiffness")] *= sense
    one = replace(one, state=replace(one.state, jacobian=rows))
    (start,) = nearest(data, one)
    assert start[0] == frozenset()
    assert (start[1] == BASE) is (sense > 1.0), "else the plant makes up for what it loses"
