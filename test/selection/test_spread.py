"""Range of the parameters over explanations that fit alike."""

from __future__ import annotations

from itertools import permutations

from setrigs import BASE, pushed, stood

from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.spread import between

MODELS = (
    BASE.with_values({"mass": 1.1}) + CoulombFriction(0.2),
    BASE.with_values({"mass": 0.9, "stiffness": 380.0}) + StribeckFriction(0.15, 0.4, 0.01),
    BASE.with_values({"mass": 1.0, "damping": 3.0}) + QuadraticDrag(4.0),
)


def test_least_and_largest_are_told_in_any_order() -> None:
    sets = [stood(pushed(), model) for model in MODELS]
    for order in permutations(sets):
        assert between(order) == {
            "mass": (0.9, 1.1), "damping": (2.0, 3.0), "stiffness": (380.0, 400.0), "coulomb_force": (0.15, 0.2),
        }  # fmt: skip


def test_a_parameter_of_one_explanation_has_no_range() -> None:
    sets = [stood(pushed(), model) for model in MODELS[1:]]
    assert set(between(sets)) == {"mass", "damping", "stiffness"}
    assert between(sets[:1]) == {} == between([])
