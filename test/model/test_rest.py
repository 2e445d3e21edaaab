"""Stiffness where a bent spring balances a constant force."""

from __future__ import annotations

import math

import pytest

from msd_ident.model import Plant
from msd_ident.model.effects.asymmetric_spring import AsymmetricSpring
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.rest import stiffness_at_rest

BASE = Plant(1.0, 2.0, 400.0)


@pytest.mark.parametrize("place", [-0.05, 0.02, 0.05])
def test_about_the_place_of_rest_the_curve_needs_no_constant_force(place: float) -> None:
    """k x + k2 x² + k3 x³ + F0 is, about the place where it is 0, a curve of the same degree and of another slope."""
    k2, k3 = 1e3, 4e4
    held = ForceOffset(-(BASE.stiffness * place + k2 * place**2 + k3 * place**3))
    model = BASE + AsymmetricSpring(k2) + CubicSpring(k3) + held
    assert stiffness_at_rest(model) == pytest.approx(BASE.stiffness + 2.0 * k2 * place + 3.0 * k3 * place**2)


def test_without_a_constant_force_or_a_bend_there_is_one_stiffness() -> None:
    for model in (BASE + CubicSpring(4e4), BASE + ForceOffset(1.0), BASE + ForceOffset(1.0) + Cogging(0.5, 0.01)):
        assert math.isnan(stiffness_at_rest(model))


def test_where_nothing_balances_there_is_none() -> None:
    steep = BASE + CubicSpring(-1e9) + ForceOffset(10.0)  # it balances nowhere near
    loose = BASE + CubicSpring(4e4) + ForceOffset(10.0) + Backlash(1e-3)
    assert math.isnan(stiffness_at_rest(steep)) and math.isnan(stiffness_at_rest(loose))
