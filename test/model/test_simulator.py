"""A simulator beside the record that it was made for."""

from __future__ import annotations

import math

import numpy as np

from msd_ident.data.record import Record
from msd_ident.model import Plant, Simulator
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.gravity import Gravity

TIME = np.arange(400) / 200.0
RECORD = Record(time=TIME, position=1e-3 * np.sin(TIME), force_time=TIME[:1], force=np.ones(1))
MODEL = Plant(1.0, 2.0, 400.0)


def test_residuals_are_readings_less_the_measured_ones_times_the_roots_of_weights() -> None:
    simulator, root = Simulator(MODEL, RECORD), np.linspace(0.5, 2.0, TIME.size)
    rows = np.array([[1.0, 2.0, 400.0, 1e-3, 0.1, 0.0], [1.0, 3.0, 300.0, 0.0, 0.0, 2e-3]])
    for row, found in zip(rows, simulator.residuals(rows, 1.0, math.inf, root), strict=True):
        simulated = simulator.positions(row[:3], row[3], row[4])
        np.testing.assert_array_equal(found, (simulated - RECORD.position + row[5]) * root)


def test_a_simulation_that_diverges_counts_as_its_worst() -> None:
    """Without a spring and with a force that pushes on, a light mass leaves every bound."""
    row = np.array([[1e-300, 0.0, 0.0, 0.0, 0.0, 0.0]])
    (found,) = Simulator(MODEL, RECORD).residuals(row, 7.0, math.inf)
    assert np.max(found) == 7.0
    assert np.all(np.isfinite(found))


def test_a_joint_that_spins_beyond_reach_is_given_up() -> None:
    """Each turn of a pendulum takes a dozen steps: followed to the end, this one would take all that a run may."""
    model = Plant(1e-5, 0.0, 0.0) + Gravity(0.9)
    row = np.array([[*model.values, 0.0, 0.0, 0.0]])
    simulator = Simulator(model, RECORD)
    (followed,), (left,) = simulator.residuals(row, 1e6, math.inf), simulator.residuals(row, 1e6, 300.0)
    beyond = np.abs(followed + RECORD.position) > 300.0
    assert 10 < np.count_nonzero(beyond) < TIME.size
    np.testing.assert_array_equal(left[~beyond], followed[~beyond])
    first = int(np.argmax(beyond))
    assert np.all(left[first + 1 :] == 1e6)


def test_slack_makes_longer_steps_whose_errors_stay_small() -> None:
    """A stiff cubic spring in a decay: the error grows with what a step may have, and stays a part of it."""
    model = Plant(1.0, 0.5, 400.0) + CubicSpring(4e6)
    exact = Simulator(model, RECORD, slack=1e-3).positions(model.values, 0.01)
    fine, rough = (Simulator(model, RECORD, slack).positions(model.values, 0.01) - exact for slack in (1.0, 100.0))
    assert 10.0 * np.max(np.abs(fine)) < np.max(np.abs(rough)) < 1e-4 * np.max(np.abs(exact))


def test_slack_changes_nothing_where_the_motion_is_exact() -> None:
    model = MODEL + CoulombFriction(0.1)
    one, other = (Simulator(model, RECORD, slack).positions(model.values, 0.01) for slack in (1.0, 100.0))
    np.testing.assert_array_equal(one, other)
