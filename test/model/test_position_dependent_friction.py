"""The effect that shows what a new one takes: a file in ``model/effects``, a line in ``effect_examples``, this test."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.position_dependent_friction import PositionDependentFriction


def free(duration: float, rate: float = 500.0) -> Record:
    """A record without force."""
    time = np.arange(int(duration * rate) + 1) / rate
    return Record(time=time, position=0.0 * time, force_time=time[:1], force=time[:1])


@pytest.mark.parametrize(("x", "stays"), [(0.0039, True), (0.0041, True), (0.0046, False), (-0.0037, False)])
def test_holds_what_the_place_allows(x: float, stays: bool) -> None:
    """With Fc = 0.4 N, a = 30 /m and k = 100 N/m a cart at rest stays while 100·abs(x) <= 0.4·(1 + 30·x)."""
    whole = Plant(1.0, 2.0, 100.0) + PositionDependentFriction(0.4, 30.0)
    positions = simulate(whole, free(1.0), x).position
    assert bool(np.all(positions == x)) == stays


def test_work_done_along_the_way() -> None:
    """Without spring and damper the kinetic energy falls by the integral of Fc·(1 + a·x)."""
    mass, friction, slope, speed = 2.0, 3.0, 5.0, 0.8
    whole = Plant(mass, 0.0, 0.0) + PositionDependentFriction(friction, slope)
    moved = simulate(whole, free(1.0), 0.0, speed)
    work = friction * (moved.position + 0.5 * slope * moved.position**2)
    energy = 0.5 * mass * moved.velocity**2
    assert np.max(np.abs(energy + work - 0.5 * mass * speed**2)) <= 1e-6 * energy[0]
    assert moved.velocity[-1] == 0.0


def test_friction_is_nowhere_negative() -> None:
    """Where 1 + a·x would be below zero there is no friction: the speed stays."""
    whole = Plant(1.0, 0.0, 0.0) + PositionDependentFriction(3.0, -10.0)
    moved = simulate(whole, free(1.0), 0.2, 0.5)
    assert np.allclose(moved.velocity, 0.5, rtol=1e-9, atol=0.0)
