"""The sign of the force, by fits of records with the force as it is, and turned."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant, simulate
from msd_ident.workflow.turned_force import leaves_far_less, leaves_less


def turned(record: Record) -> Record:
    return replace(record, force=-record.force)


def driven(stiffness: float, *, one_tone: bool) -> Record:
    """A rig under random steps, or under a sine below its resonance."""
    time, rng = np.arange(0.0, 20.0, 0.005), np.random.default_rng(5)
    force = 3.0 * np.repeat(rng.choice([-1.0, 1.0], 100), 40)
    if one_tone:
        force = 3.0 * np.sin(2.0 * math.pi * time)
    still = from_samples(time, force, np.zeros(time.size))
    moved = simulate(Plant(1.0, 2.0, stiffness), still).position
    return replace(still, position=moved + rng.normal(0.0, 1e-5, time.size))


def test_a_force_that_pulls_against_the_motion_is_turned() -> None:
    """On a spring a regression must ask: a fit may find a mass with either sign there."""
    for stiffness, asked in ((0.0, False), (0.0, True), (100.0, True)):
        right = driven(stiffness, one_tone=False)
        assert leaves_far_less([turned(right)], [right], asked=asked)
        assert not leaves_far_less([right], [turned(right)], asked=asked)
    assert leaves_less([turned(right)], [right]) and not leaves_less([right], [turned(right)])


def test_nothing_is_turned_without_a_driven_record() -> None:
    assert not leaves_far_less([], [], asked=True)


def test_under_a_single_tone_a_mass_is_not_put_in_the_place_of_a_spring() -> None:
    """A crank under a sine below its resonance was turned: a mass alone does with that force what its spring does."""
    right = driven(200.0, one_tone=True)
    for asked in (False, True):
        assert not leaves_far_less([right], [turned(right)], asked=asked)


def test_a_force_that_moves_nothing_is_not_turned() -> None:
    """Either sign explains as little: neither fit knows the mass."""
    time, rng = np.arange(0.0, 8.0, 0.005), np.random.default_rng(5)
    force = 3.0 * np.repeat(rng.choice([-1.0, 1.0], 40), 40)
    swaying = 0.1 * np.sin(1.3 * time) + 0.05 * np.sin(2.9 * time + 1.0) + rng.normal(0.0, 1e-5, time.size)
    record = from_samples(time, force, swaying)
    assert not leaves_far_less([record], [turned(record)], asked=False)
    assert not leaves_far_less([turned(record)], [record], asked=False)


@pytest.mark.parametrize("seed", [0, 2])
def test_a_mass_alone_does_not_turn_the_force_that_a_spring_explains(seed: int) -> None:
    """Under one step a parabola with a start of its own leaves less than a mass that the force pushes for ever."""
    rng, time = np.random.default_rng(seed), 0.05 * np.arange(210)
    step = 5.0 * (time >= 1.0)
    gust = 0.3 * lfilter([math.sqrt(1.0 - 0.9**2)], [1.0, -0.9], rng.standard_normal(210)) * (time >= 1.0)
    moved = simulate(Plant(0.6, 12.0, 48.0), from_samples(time, step + gust, 0.0 * time)).position
    record = from_samples(time, step, moved)
    assert not leaves_far_less([record], [turned(record)], asked=False)


def hanging(seconds: float, fastest: float, strength: float) -> Record:
    """A pendulum under a sweep of the torque [N·m] from 0.1 Hz on; its motor turns a wheel, so it is pushed back."""
    time, rng = np.arange(0.0, seconds, 0.01), np.random.default_rng(1)
    force = strength * np.sin(2.0 * math.pi * (0.1 + 0.5 * (fastest - 0.1) * time / time[-1]) * time)

    def slope(t: float, state: list[float]) -> list[float]:
        angle, speed = state
        pushed = -float(np.interp(t, time, force)) - 0.02 * math.tanh(100.0 * speed)
        return [speed, (pushed - 5.7 * math.sin(angle) - 0.09 * speed) / 0.48]

    moved = solve_ivp(slope, (0.0, time[-1]), [0.0, 0.0], t_eval=time, max_step=0.01).y[0]
    return from_samples(time, force, moved + rng.normal(0.0, 1e-4, time.size))


@pytest.mark.parametrize(("seconds", "fastest", "strength"), [(15.0, 2.0, 1.0), (20.0, 0.8, 0.5)])
def test_a_fit_that_carries_nothing_does_not_keep_the_force(seconds: float, fastest: float, strength: float) -> None:
    """The force as it is gave a mass of 1.7 ± 3.1, or one that is known, and left nearly all of the motion."""
    record = hanging(seconds, fastest, strength)
    assert leaves_far_less([record], [turned(record)], asked=False)
    assert not leaves_far_less([turned(record)], [record], asked=False)
