"""Copies of a record look like it."""

from __future__ import annotations

import numpy as np
import pytest
from copyrigs import RUB, STEP, measured

from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection import synthetic_records
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine


def test_shuffled_keeps_the_spectrum_and_nothing_else() -> None:
    rng = np.random.default_rng(1)
    for count in (400, 401):
        signal = np.cumsum(rng.standard_normal(count))
        other = synthetic_records.shuffled(signal, rng)
        np.testing.assert_allclose(np.abs(np.fft.rfft(other)), np.abs(np.fft.rfft(signal)), rtol=1e-9, atol=1e-9)
        assert abs(np.corrcoef(signal - signal.mean(), other - other.mean())[0, 1]) < 0.9


@pytest.mark.parametrize("encoder", [{"counts_per_metre": 0.0, "noise": 5e-6}, {"counts_per_metre": 40000.0}])
def test_a_copy_has_the_record_s_noise_steps_and_force(encoder: dict[str, float]) -> None:
    record = measured(STEP, **encoder)
    readings = prepare([record])
    experiment = Experiment(readings, Plant(1.0, 2.0, 400.0), frozenset())
    model = experiment.base + CoulombFriction(0.3)
    lead = refine(experiment, RUB, model, experiment.problem(model).initial)
    disturbed = synthetic_records.Disturbed.by(lead, readings)
    assert disturbed.left is None, "the right model leaves no more than noise"
    imagined = synthetic_records.Imagined(RUB, lead.problem, lead.point)
    (one,), (again,), (other,) = (disturbed.copy(imagined, np.random.default_rng(seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.position, again.position)
    assert encoder_step(one) == pytest.approx(encoder_step(record))
    assert noise_floor(one) == pytest.approx(noise_floor(record), rel=0.15)
    assert (other.position != one.position).any() == (encoder_step(record) == 0.0)
    np.testing.assert_array_equal(one.force, record.force)
    assert np.std(one.position - record.position) < 2.0 * readings[0].noise


def test_strengths_by_lot_are_inside_the_law_s_bounds_and_differ() -> None:
    record, plant, rng = measured(STEP), Plant(1.0, 2.0, 400.0), np.random.default_rng(5)
    for law in LIBRARY:
        drawn = [law.guess(record, plant)[0].by_lot(rng, record, plant) for _ in range(5)]
        assert len({one.values for one in drawn}) == 5, law.name
        assert all(p.lower <= v <= p.upper for one in drawn for p, v in zip(one.parameters, one.values, strict=True))


def test_a_law_without_its_limit_has_a_copy_beside_one_that_shares_a_force_with_the_leader() -> None:
    """``--end 0.45`` of a measured record ended in a traceback: the limit at infinity is no fitted force."""
    experiment = Experiment(prepare([measured(STEP, noise=5e-6)]), Plant(1.0, 2.0, 400.0), frozenset())
    model = experiment.base + CoulombFriction(0.3)
    lead = refine(experiment, RUB, model, experiment.problem(model).initial)
    wanted = frozenset({"force_gain_nonlinearity", "stribeck_friction"})
    found = synthetic_records.of_any_strength(experiment, lead, wanted, np.random.default_rng(3))
    assert found.causes == wanted and np.all(np.isfinite(found.point))
