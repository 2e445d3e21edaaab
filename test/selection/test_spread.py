"""Range of the parameters over explanations that fit alike."""

from __future__ import annotations

from itertools import permutations

import pytest
from setrigs import BASE

from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.rest import stiffness_at_rest
from msd_ident.selection.spread import between

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
    bent = BASE + CubicSpring(4e4) + ForceOffset(-BASE.stiffness * 0.05 - 4e4 * 0.05**3)  # at rest at 0.05 m
    assert between([bent])["stiffness"] == pytest.approx((BASE.stiffness, stiffness_at_rest(bent)))
    assert between([BASE + CubicSpring(4e4)]) == {}
