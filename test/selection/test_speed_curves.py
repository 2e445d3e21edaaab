"""One law of the speed in the place of several."""

from __future__ import annotations

import numpy as np
import pytest
from setrigs import BASE, fitted, pushed, stood

from msd_ident.model import Model
from msd_ident.model.effects import LIBRARY, Effect
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.direction_dependent_damping import DirectionDependentDamping
from msd_ident.model.effects.fading_damping import FadingDamping
from msd_ident.model.effects.power_drag import PowerDrag
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.smooth_friction_turn import SmoothFrictionTurn
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.model.effects.typical import speed
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.speed_curves import also_bent, merged


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


@pytest.mark.parametrize(
    ("beside", "chi", "bent"),
    [
        (SmoothFrictionTurn(1.0, 0.03, 1.4), 1001.0, True),
        (SmoothFrictionTurn(1.0, 0.03, 1.4), 2000.0, False),
        (PowerDrag(1.0, 1.0, 1.5), 1001.0, False),
        (CoulombFriction(0.5), 1001.0, False),
    ],
    ids=["of another cause", "which leaves more", "of the same cause", "of a simple law"],
)
def test_a_curve_that_bends_freely_is_not_certain_where_one_of_another_cause_does_as_well(
    beside: Effect, chi: float, bent: bool
) -> None:
    """Of friction that creeps as an exponential (seed 891005 of ``--variants``) a damping that fades had 0.99."""
    sets = [
        fitted(pushed(), BASE + FadingDamping(31.0, 0.04, 1.3) + CubicSpring(1e4), 1000.0),
        fitted(pushed(), BASE + beside + CubicSpring(1e4), chi),
        fitted(pushed(), BASE + CubicSpring(1e4), 9000.0),
    ]
    found = also_bent(sets[0], {one.causes: one for one in sets}, 1000.0)
    assert found == (frozenset({"fading_damping"}) if bent else frozenset())
    told = Caveats(sets[0].causes, exact=True, bending=found)
    assert told.greatest("fading_damping", rich=True, steered=False) == pytest.approx(0.9 if bent else 1.0, abs=1e-3)
    assert told.greatest("cubic_spring", rich=True, steered=False) == pytest.approx(1.0, abs=1e-3)
