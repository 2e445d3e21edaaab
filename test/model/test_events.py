"""Turns and knees of the general path end where those of the exact path do."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.model import Effect, Plant, simulate
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring

PLANT = Plant(1.0, 3.0, 600.0)
#: A law that moves the cart by less than rounding, and that the exact path does not carry.
ALMOST_NOTHING = CubicSpring(1e-3)


def pushed(period: float) -> Record:
    """Two seconds [s] of random steps of force."""
    time = period * np.arange(round(2.0 / period))
    steps = np.random.default_rng(0).uniform(-8.0, 8.0, 21)
    force = steps[np.minimum((time / 0.1 + 1e-9).astype(int), 20)]
    return Record(time=time, position=0.0 * time, force_time=time, force=force)


@pytest.mark.parametrize("period", [0.002, 0.005, 0.01])
@pytest.mark.parametrize(
    "effects", [(CoulombFriction(0.5),), (Backlash(0.002),), (CoulombFriction(0.5), Backlash(0.002))], ids=str
)
def test_events_are_where_the_exact_path_has_them(effects: tuple[Effect, ...], period: float) -> None:
    model, record = PLANT, pushed(period)
    for effect in effects:
        model = model + effect
    exact = simulate(model, record).position
    general = simulate(model + ALMOST_NOTHING, record).position
    assert np.max(np.abs(general - exact)) < 1e-7 * np.std(exact)
    assert not np.array_equal(general, exact), "both took the exact path"
