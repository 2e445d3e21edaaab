"""Ripples along the travel, by regression."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import measured

from msd_ident.data.record import Record
from msd_ident.estimate.ripple_regression import found_in, ripples
from msd_ident.model import Effect, Model, Plant
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.quadratic_drag import QuadraticDrag

PLANT = Plant(1.2, 6.0, 620.0)
STEPS = {"name": "steps", "force": 8.0, "hold": 0.6}
ENCODER = {"counts_per_metre": 0.0, "noise": 5e-6}
#: It holds the cart off its balance in more than one place: 2πA/p is three times the stiffness.
STRONG = Cogging(1.0, 3.1e-3, 0.4)


def made(model: Model, experiment: dict[str, object] | None = None, zero: float = 0.0, **spec: object) -> Record:
    return measured(model, experiment or STEPS, rate=250.0, encoder=ENCODER, seed=1, zero=zero, **spec)


def check(ripple: tuple[float, float, float], law: Cogging, middle: float, amplitude: float = 0.1) -> None:
    """Amplitude, pitch, and the phase in the middle of the travel, where an error of the pitch turns it least."""
    assert ripple[0] == pytest.approx(law.cogging_amplitude, rel=amplitude)
    assert ripple[1] == pytest.approx(law.cogging_pitch, rel=0.01)
    turns = [2.0 * math.pi * middle / pitch + phase for _, pitch, phase in (ripple, (0.0, *law.values[1:]))]
    assert math.cos(turns[0] - turns[1]) > 0.95


@pytest.mark.parametrize("beside", [(), (CoulombFriction(0.3),), (QuadraticDrag(20.0),), (CubicSpring(4e5),)])
def test_a_ripple_that_holds_the_cart_is_read_off_the_motion(beside: tuple[Effect, ...]) -> None:
    record = made(replace(PLANT, effects=(STRONG, *beside)))
    check(ripples(record, 1.0)[0], STRONG, float(np.mean(record.position)))
    assert found_in(record)[0].share > 0.9


def test_beside_a_play_it_is_among_the_best() -> None:
    record = made(PLANT + STRONG + Backlash(5e-4))
    assert any(abs(pitch / STRONG.cogging_pitch - 1.0) < 0.02 for _, pitch, _ in ripples(record, 1.0))


def test_a_zero_of_the_encoder_turns_the_phase_alone() -> None:
    plain, moved = (ripples(made(PLANT + STRONG, zero=zero), 1.0)[0] for zero in (0.0, 0.01))
    assert moved[:2] == pytest.approx(plain[:2], rel=1e-6)
    turned = plain[2] - 2.0 * math.pi * 0.01 / plain[1]
    assert math.cos(moved[2] - turned) == pytest.approx(1.0, abs=1e-6)


def test_the_unit_of_the_force_scales_the_amplitude_alone() -> None:
    record = made(PLANT + STRONG)
    weaker = replace(record, force=0.01 * record.force)
    for (a, pitch, phase), (small, same, turn) in zip(ripples(record, 1.0), ripples(weaker, 1.0), strict=True):
        assert (100.0 * small, same, turn) == pytest.approx((a, pitch, phase), rel=1e-6)


def test_a_free_decay_gives_the_force_of_the_mass_that_is_said() -> None:
    law = Cogging(0.6, 8e-3, 0.4)
    record = made(PLANT + law, {"name": "release", "position": 0.03, "duration": 4.0})
    check(ripples(record, 1.2)[0], law, float(np.mean(record.position)), amplitude=0.15)
    assert ripples(record, 2.4)[0][0] == pytest.approx(2.0 * ripples(record, 1.2)[0][0])


@pytest.mark.parametrize("law", [CoulombFriction(0.3), Backlash(5e-4), QuadraticDrag(20.0), CubicSpring(4e5)])
def test_other_laws_are_no_ripple(law: Effect) -> None:
    """What is left of them has a spectrum as well, but no pitch explains nine tenths of it."""
    found = found_in(made(PLANT + law))
    assert found and all(one.share < 0.7 for one in found)


def test_a_record_that_is_too_short_has_no_ripple() -> None:
    record = made(PLANT + STRONG)
    few = Record(record.time[:20], record.position[:20], record.time[:20], np.linspace(0.0, 1.0, 20))
    assert ripples(few, 1.0) == []
