"""One law of the speed in the place of several."""

from __future__ import annotations

import numpy as np
import pytest
from setrigs import BASE, pushed, stood

from msd_ident.model import Model
from msd_ident.model.effects import LIBRARY, Effect
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.direction_dependent_damping import DirectionDependentDamping
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.typical import speed
from msd_ident.selection.speed_curves import merged


def merged_of(model: Model) -> dict[frozenset[str], Model]:
    """The sets that are begun from a model as it stands, by their causes."""
    return {causes: start for causes, start, _ in merged(pushed(), stood(pushed(), model))}


def test_stribecks_law_begins_with_the_curve_of_coulomb_friction_and_drag() -> None:
    """A law of another kind beside them stays."""
    model = BASE + CoulombFriction(0.5) + QuadraticDrag(1.0) + CubicSpring(1e4)
    found = merged_of(model)
    start = found[frozenset({"stribeck_friction", "cubic_spring"})]
    assert start.effect("cubic_spring") == CubicSpring(1e4) and set(found) == {frozenset(start.effect_names)}
    speeds = np.linspace(0.1, 1.0, 10) * speed(pushed().records[0])
    values = start.effect("stribeck_friction").values
    curve = [start.damping * v + StribeckFriction.friction(v, *values) for v in speeds.tolist()]
    np.testing.assert_allclose(curve, 2.0 * speeds + 0.5 + speeds**2, rtol=0.05)


def test_a_law_that_creeps_takes_the_place_of_laws_that_creep() -> None:
    found = merged_of(BASE + SmoothFriction(0.5, 0.01) + QuadraticDrag(1.0))
    assert found and not any("breakaway" in effect.laws() for model in found.values() for effect in model.effects)


def test_one_law_is_no_reason_to_begin_another_nor_is_a_curve_that_none_comes_near() -> None:
    assert not merged_of(BASE + CoulombFriction(0.5)) and not merged_of(BASE)
    assert not merged_of(BASE + CoulombFriction(1e-3) + QuadraticDrag(1e3))


@pytest.mark.parametrize("law", [law for law in LIBRARY if law.is_curve_over_speed()], ids=lambda law: law.name)
def test_the_curve_is_the_force_of_the_law(law: type[Effect]) -> None:
    (one, *_) = law.guess(pushed().records[0], BASE)
    laws, given = law.laws(), {"v": 0.3, "speed": 0.3, "direction": 1.0}
    given |= {parameter.name: value for parameter, value in zip(law.parameters, one.values, strict=True)}
    acting = laws.get("force") or laws["friction"]
    names = acting.__code__.co_varnames[: acting.__code__.co_argcount]
    assert law.curve_over_speed()(0.3, one.values) == pytest.approx(acting(*(given[name] for name in names)))
    assert not DirectionDependentDamping.is_curve_over_speed(), "it differs by direction"
