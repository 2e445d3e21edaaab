"""Stops that take part of all other forces, against MuJoCo and scipy and against the buffers that take none."""

from __future__ import annotations

import numpy as np
import pytest
from effect_examples import DAMPING, MASS, STIFFNESS, followed, plant, record

from msd_ident.data.record import from_samples
from msd_ident.model import Plant, Simulator
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.constraint_stop import ConstraintStop
from msd_ident.model.effects.coulomb_friction import CoulombFriction


@pytest.mark.parametrize(("centre", "share"), [(0.004, 0.9), (-0.004, 0.3)])
def test_in_contact_only_a_part_of_all_other_forces_is_left(centre: float, share: float) -> None:
    measured = record(rate=500.0, duration=0.8)
    stop = ConstraintStop(centre, 0.012, 4e3, 20.0, share)

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        off = x - centre
        side, depth = np.sign(off), abs(off) - 0.012
        force = measured.force[np.searchsorted(measured.force_time, t, side="right") - 1]
        others = force - DAMPING * v - STIFFNESS * x
        push = max(4e3 * depth + 20.0 * side * v + share * side * others, 0.0) if depth > 0.0 else 0.0
        return [v, (others - side * push) / MASS]

    found = Simulator(plant() + stop, measured).positions((plant() + stop).values)
    expected = followed(slope, measured)
    assert np.max(np.abs(found - expected)) < 3e-5 * np.ptp(expected)
    assert np.max(np.abs(expected - centre)) > 0.0125, "both stops are to be hit"


@pytest.mark.parametrize(("rate", "allowed"), [(250.0, 1e-5), (1000.0, 1e-6)])
def test_without_a_part_of_the_other_forces_it_is_a_buffered_stop(rate: float, allowed: float) -> None:
    """But for the instant at which a buffer lets go: no event locates it, and the two step over it differently."""
    measured = record(rate=rate)
    same, simple = plant() + ConstraintStop(0.001, 0.014, 5e3, 9.0, 0.0), plant() + BufferedStop(0.001, 0.014, 5e3, 9.0)
    expected = Simulator(simple, measured).positions(simple.values)
    found = Simulator(same, measured).positions(same.values)
    assert np.max(np.abs(found - expected)) < allowed * np.ptp(expected)


def test_dry_friction_holds_in_the_stop_what_it_holds_of_its_part() -> None:
    """At rest the stop is as stiff as ks/(1 - r): 0.2 mm deep it pushes with 2 N, of which k·x is 0.5 N."""
    stop = ConstraintStop(0.0, 0.001, 1e3, 0.0, 0.9)
    net = stop.contact_at_rest(3.0 - 1e3 * 2e-4, 0.0012, *stop.values[:3], 0.9)
    assert net == pytest.approx(3.0 - 1e4 * 2e-4)
    assert stop.contact_at_rest(3.0, 0.0009, *stop.values[:3], 0.9) == 3.0


def test_a_mass_at_rest_in_the_stop_stays_there() -> None:
    """Whatever direction it came from: friction and the stop balance any push between 1.9 and 2.1 N."""
    stop, friction = ConstraintStop(0.0, 0.001, 1e4, 5.0, 0.9), CoulombFriction(0.4)
    measured = record(rate=500.0, duration=3.0)
    model = plant() + stop + friction
    moved = Simulator(model, measured).positions(model.values)
    rest = np.flatnonzero(np.abs(np.diff(moved)) == 0.0)
    assert rest.size > 50, "friction is to hold the mass somewhere"
    deep = moved[rest][np.abs(moved[rest]) > 0.001]
    assert deep.size, "and in the stop"
    held = measured.force[np.searchsorted(measured.force_time, measured.time[rest] + 1e-9, side="right") - 1]
    inside = np.abs(moved[rest]) > 0.001
    carried = 1e5 * (np.abs(moved[rest]) - 0.001)[inside]
    others = (np.sign(moved[rest]) * held - STIFFNESS * np.abs(moved[rest]))[inside]
    assert np.all(np.abs(others - carried) <= 0.4 + 1e-6)


def test_contact_after_contact_the_motion_stays_smooth_in_its_parameters() -> None:
    """Errors of the solver that change abruptly with the stiffness were more than a fit's minimum is deep."""
    model = Plant(1.0, 3.0, 600.0) + ConstraintStop(1e-4, 0.004, 600.0, 6.0, 0.9)
    time, moved = 2e-3 * np.arange(2500), np.linspace(-1.0, 1.0, 21)
    rows = np.tile(model.values, (21, 1))
    rows[:, 2] *= 1.0 + 1e-7 * moved
    rough = []
    for seed in range(8):
        force = np.repeat(np.random.default_rng(seed).uniform(-8.0, 8.0, 25), 100)
        measured = from_samples(time, force, np.zeros(time.size), hold="zero")
        found = Simulator(model, measured).positions_many(rows, np.zeros(21), np.zeros(21))
        straight = np.polynomial.polynomial.polyfit(moved, found, 1)
        left = found - np.polynomial.polynomial.polyval(moved, straight).T
        rough.append(np.std(left) / np.std(found))
    assert np.median(rough) < 1e-12
