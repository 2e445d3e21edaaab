"""A common factor of all forces that the data shows on one side alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant, simulate
from msd_ident.model.base_model import DryFriction
from msd_ident.workflow import pipeline

MASS, FRICTION = 0.9407, 0.12274
RIG = Plant(MASS, 3.8, 694.1) + DryFriction(FRICTION)


def let_go(seed: int, held: float = 1.5, again: bool = False) -> Record:
    """A cart held by a force against its friction and let go after 5 s, read with noise; pushed ``again`` at 8 s."""
    time = np.arange(0.0, 11.0, 0.005)
    force = np.where((time >= 1.0) & (time < 5.0), held, 0.0) + np.where(again & (time >= 8.0), held, 0.0)
    asked = from_samples(time, force, np.zeros(time.size))
    position = simulate(RIG, asked).position + 2e-5 * np.random.default_rng(seed).standard_normal(time.size)
    record = replace(asked, position=position)
    return record.cut(3.0, float(time[-1]))


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_the_scale_of_a_cart_that_is_let_go_is_open_whatever_the_noise(seed: int) -> None:
    """The cart rests anywhere within the friction: the scale is free by 8 %, where intervals of 0.5 % stood."""
    found = pipeline.identify([let_go(seed)])
    assert any("known only up to a common factor" in one for one in found.open)
    for name in ("mass", "damping", "stiffness", "coulomb_force"):
        assert not found.refined.parameters[name].known, name


@pytest.mark.parametrize("seed", [1, 2])
def test_a_push_after_it_tells_the_scale(seed: int) -> None:
    found = pipeline.identify([let_go(seed, again=True)])
    assert not any("common factor" in one for one in found.open)
    mass = found.refined.parameters["mass"]
    assert mass.known and abs(mass.value - MASS) < 3.0 * mass.std
