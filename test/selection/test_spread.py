"""Range of the parameters over explanations that fit alike."""

from __future__ import annotations

import math
from itertools import permutations

import pytest
from setrigs import BASE

from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.spread import between, stiffness_at_rest

MODELS = (
    BASE.with_values({"mass": 1.1}) + CoulombFriction(0.2),
    BASE.with_values({"mass": 0.9, "stiffness": 380.0}) + StribeckFriction(0.15, 0.4, 0.01),
    BASE.with_values({"mass": 1.0, "damping": 3.0}) + QuadraticDrag(4.0),
)


def test_least_and_largest_are_told_in_any_order() -> None:
    for order in permutations(MODELS):
        assert between(order) == {
            "mass": (0.9, 1.1), "damping": (2.0, 3.0), "stiffness": (380.0, 400.0), "coulomb_force": (0.15, 0.2),
        }  # fmt: skip


def test_a_parameter_of_one_explanation_has_no_range() -> None:
    assert set(between(MODELS[1:])) == {"mass", "damping", "stiffness"}
    assert between(MODELS[:1]) == {} == between([])


def test_values_that_are_printed_alike_are_no_range() -> None:
    assert set(between([BASE, BASE.with_values({"mass": 1.00004, "stiffness": 400.4})])) == {"stiffness"}


def test_beside_a_constant_force_the_stiffness_at_rest_counts() -> None:
    """k x + k3 x³ + F0 is, about the place where it is 0, a curve without a constant force and of another slope."""
    bent = BASE + CubicSpring(4e4) + ForceOffset(-BASE.stiffness * 0.05 - 4e4 * 0.05**3)  # at rest at 0.05 m
    at_rest = BASE.stiffness + 3.0 * 4e4 * 0.05**2
    assert stiffness_at_rest(bent) == pytest.approx(at_rest)
    assert between([bent])["stiffness"] == pytest.approx((BASE.stiffness, at_rest))


def test_without_a_constant_force_or_a_bend_there_is_one_stiffness() -> None:
    for model in (BASE + CubicSpring(4e4), BASE + ForceOffset(1.0), BASE + ForceOffset(1.0) + Cogging(0.5, 0.01)):
        assert math.isnan(stiffness_at_rest(model)) and between([model]) == {}
    steep = BASE + CubicSpring(-1e9) + ForceOffset(10.0)  # it balances nowhere near
    assert math.isnan(stiffness_at_rest(steep))
