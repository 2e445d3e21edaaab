"""A contact that begins late: by a part of a sample interval, as far as the residual would not show it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.buffered_stop import BufferedStop
from msd_ident.model.effects.constraint_stop import ConstraintStop
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.residuals import late_contact
from msd_ident.residuals.blows import Blows
from msd_ident.residuals.noise_model import of_record

PLANT = Plant(1.0, 3.0, 600.0)
STOP = BufferedStop(1e-4, 0.008, 6000.0, 40.0)
START = Initial(0.0, 0.0, 0.0)
PERIOD, SAMPLES = 1e-3, 3000
ROWS = np.random.default_rng(3).normal(size=(2, SAMPLES))


def measured(model: Model, noise: float) -> Record:
    time, rng = PERIOD * np.arange(SAMPLES), np.random.default_rng(1)
    force = np.repeat(rng.uniform(-8.0, 8.0, 12), 250)
    record = from_samples(time, force, np.zeros(SAMPLES), hold="zero")
    return replace(record, position=simulate(model, record).position + rng.normal(0.0, noise, SAMPLES))


def test_an_impulse_of_the_jump_over_an_interval_for_each_contact() -> None:
    model = PLANT + STOP
    record = measured(model, 1e-6)
    path = simulate(model, record)
    depth = np.abs(path.position - STOP.buffer_centre) - STOP.buffer_reach
    before = np.flatnonzero((depth[1:] > 0.0) & (depth[:-1] <= 0.0))
    assert before.size > 3
    impulse = STOP.buffer_damping * np.abs(path.velocity[before]) * PERIOD / math.sqrt(12.0)
    for noise in (1e-6, 1.0):  # a small part of them hides in the scatter of the first, the whole in the other
        part = of_record(record, noise)
        whole = Blows(before + 1, impulse)
        hidden = min(math.sqrt(2.0 * part.evidence) / whole.chi(part, model), 1.0)
        assert (hidden < 0.1) == (noise < 1e-3)
        found = late_contact.slopes([part], model, [START], ROWS)
        assert np.allclose(found, hidden * whole.slopes(part, model, ROWS), rtol=1e-6)


@pytest.mark.parametrize("model", [PLANT, PLANT + EndStop(0.008, 6000.0), PLANT + BufferedStop(0.0, 1.0, 6e3, 40.0)])
def test_nothing_is_open_without_a_jump_or_without_contact(model: Model) -> None:
    part = of_record(measured(model, 1e-6), 1e-6)
    assert not late_contact.slopes([part], model, [START], ROWS).any()


def test_a_jump_takes_its_part_of_all_other_forces() -> None:
    stop = ConstraintStop(0.001, 0.01, 500.0, 5.0, 0.9)
    (upper, side), (lower, other) = stop.knee_places()
    assert (upper, side, lower, other) == (pytest.approx(0.011), 1.0, pytest.approx(-0.009), -1.0)
    assert stop.begins_with(upper, 0.2, 3.0) == pytest.approx(-(5.0 * 0.2 + 0.9 * 3.0))
    assert BufferedStop(0.0, 0.01, 500.0, 5.0).begins_with(0.01, 0.2, 3.0) == pytest.approx(1.0)
    assert EndStop(0.01, 500.0).begins_with(0.01, 0.2, 3.0) == 0.0
