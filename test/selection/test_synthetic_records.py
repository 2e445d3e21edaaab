"""Copies of a record look like it; a poor experiment is checked by them, another one only when asked."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection import replication, synthetic_records
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.workflow import pipeline
from msd_sim.api import simulate

RUB = frozenset({"coulomb_friction"})
PLANT = {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "seed": 4, "rate": 200}
RUBS = {"coulomb_friction": {"coulomb_force": 0.3}}
DRAGS = {"quadratic_drag": {"drag_coefficient": 4.0}}
STEP = {"name": "step", "force": 4.0, "hold": 2.0}
RAMP = {"name": "ramp", "force": 4.0, "duration": 8.0, "rate": 100.0}


def measured(experiment: dict[str, Any], effects: dict[str, Any] = RUBS, **encoder: float) -> Record:
    made = simulate({**PLANT, "experiment": experiment, "effects": effects, "encoder": encoder})
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold)


@cache
def diagnosed(name: str) -> Diagnosis:
    return pipeline.diagnose([measured(STEP if name == "step" else RAMP, counts_per_metre=0.0, noise=5e-6)])


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


def test_one_step_tells_coulomb_friction_and_shows_that_it_does() -> None:
    found = diagnosed("step")
    assert [cause.name for cause in found.causes] == ["coulomb_friction"]
    assert found.calibration is not None
    rows = {row.causes: row for row in found.calibration.rows}
    assert rows[RUB].right >= rows[RUB].copies - 1
    assert rows[frozenset()].right == rows[frozenset()].copies
    assert rows[frozenset({"stribeck_friction"})].any_strength
    assert found.causes[0].probability == pytest.approx(found.calibration.corrected["coulomb_friction"])
    assert found.calibration.corrected["coulomb_friction"] <= found.calibration.stated["coulomb_friction"]


def test_a_ramp_cannot_tell_the_laws_of_dry_friction_and_says_so() -> None:
    """No motion is quick enough to show a friction that falls with the speed."""
    found = diagnosed("ramp")
    assert found.calibration is not None and found.calibration.stated["coulomb_friction"] > 0.9
    assert found.calibration.corrected["coulomb_friction"] < 0.9
    assert found.verdict == "ambiguous"
    assert "stribeck_friction" in found.causes[0].tied_with
    assert any(one.causes == ("stribeck_friction",) for one in found.contenders), "the next experiment may part them"


def test_the_same_record_gets_the_same_matrix() -> None:
    again = pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)])
    assert again.calibration == diagnosed("step").calibration


def test_steps_in_both_directions_are_checked_only_when_asked() -> None:
    steps = {"name": "steps", "force": 4.0, "hold": 0.5}
    record = measured(steps, DRAGS, counts_per_metre=0.0, noise=5e-6)
    assert pipeline.diagnose([record]).calibration is None
    asked = pipeline.diagnose([record], pipeline.Options(calibrate=True))
    assert asked.calibration is not None and asked.verdict == "explained"
    assert "calibration" in asked.to_json_dict()


def test_copies_that_cost_too_much_are_not_made_unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replication, "_CHEAP", 0.0)
    assert pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)]).calibration is None


def test_what_progress_raises_ends_it() -> None:
    class Enough(Exception):
        pass

    def tell(stage: str, fraction: float, cause: str) -> None:
        assert math.isfinite(fraction)
        if stage == "copies of this record":
            raise Enough

    with pytest.raises(Enough):
        pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)], progress=tell)
