"""What is left: a known missing force lies in its interval, and makes the part of the motion that it does make."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis, Task, diagnose_records
from msd_ident.errors import UsageError
from msd_ident.report.page import article
from msd_ident.workflow import pipeline
from msd_sim.api import simulate

RIG = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0}
STEPS = {"name": "steps", "force": 8.0, "hold": 0.6}


def measured(noise: float = 1e-5, **more: Any) -> Record:
    encoder = {"counts_per_metre": 0.0, "noise": noise}
    made = simulate({**RIG, "encoder": encoder, "experiment": STEPS, **more})
    return Record(made.time, made.position, made.force_time, made.force)


@cache
def clean() -> Diagnosis:
    return diagnose_records(Task((measured(),)))


def disturbed(record: Record, amplitude: float, seed: int = 0) -> Record:
    """The same with the motion that two dozen kicks at any time make: no law of the library."""
    time = record.time
    rng = np.random.default_rng(seed)
    force = np.zeros(time.size)
    for at in rng.uniform(0.3, float(time[-1]) - 0.3, 24):
        force += amplitude * rng.choice((-1.0, 1.0)) * np.exp(-(((time - at) / 0.06) ** 2))
    steps = {"force_time": time.tolist(), "force": force.tolist(), "duration": float(time[-1])}
    more = simulate({**RIG, "encoder": {"counts_per_metre": 0.0, "noise": 0.0}, **steps})
    moved = np.interp(time, more.time, more.position)
    return replace(record, position=record.position + moved)


def rms(values: Any) -> float:
    return math.sqrt(float(np.mean(np.square(values))))


def test_dry_friction_that_the_base_model_lacks_is_in_its_interval() -> None:
    """Less what m, b and k of the base model take of it upon themselves."""
    found = diagnose_records(Task((measured(effects={"coulomb_friction": {"coulomb_force": 0.15}}),)))
    base, model, true = found.left.base, found.base.model, found.missing[0]
    rubs = 0.15 * np.sign(true.velocity)
    pull = true.applied - rubs - 2.0 * true.velocity - 600.0 * true.position  # m x'' of the rig
    lacks = true.applied - model["damping"] * true.velocity - model["stiffness"] * true.position - model["mass"] * pull
    low, high = base.force_interval
    assert base.seen and low < rms(lacks) < high < 1.5 * low
    applied = rms(found.records[0].force_at(found.records[0].time))
    assert found.left.yardstick == "applied force" and found.left.yardstick_rms == pytest.approx(applied)
    assert base.force_percent == pytest.approx(100.0 * base.force / applied)


@pytest.mark.parametrize("amplitude", [0.1, 0.4])
def test_the_motion_that_a_missing_force_makes_is_told(amplitude: float, asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    record = measured()
    other = disturbed(record, amplitude)
    found = diagnose_records(Task((other,))).left
    made = rms(other.position - record.position) / float(np.std(record.position))
    assert found.base.motion_percent == pytest.approx(100.0 * made, rel=0.25)
    assert found.motion_rms == pytest.approx(float(np.std(other.position)))
    assert found.noise_percent == pytest.approx(100.0 * 1e-5 / found.motion_rms, rel=0.1)


def test_where_nothing_is_left_the_interval_begins_at_zero_and_bounds_it() -> None:
    left = clean().left
    assert not left.extended.seen and not left.exceeds
    assert left.extended.force_interval[0] == 0.0
    assert 0.0 < left.extended.force <= left.extended.force_interval[1] < 0.01
    assert left.base == left.extended


def test_a_free_decay_is_compared_with_the_force_of_its_spring() -> None:
    decay = {"name": "release", "position": 0.02, "duration": 3.0}
    left = diagnose_records(Task((measured(experiment=decay),))).left
    assert left.yardstick == "spring force"
    assert left.yardstick_rms == pytest.approx(600.0 * left.motion_rms, rel=0.01)  # of 1 kg, which the rig has


@pytest.mark.parametrize(
    ("units", "told"), [(("N", "m"), "N per kg"), (("N·m", "rad"), "N·m per kg·m²")], ids=["axis", "joint"]
)
def test_the_missing_force_of_a_free_decay_is_told_for_a_unit_of_mass(
    units: tuple[str, str], told: str, asking_about: Callable[..., None]
) -> None:
    """A rig of any mass decays alike: 0.87 N·m were stated of a joint whose moment of inertia nobody knew."""
    asking_about("cubic_spring")
    decay = {"name": "release", "position": 0.02, "duration": 3.0}
    rubs = measured(experiment=decay, mass=3.0, effects={"coulomb_friction": {"coulomb_force": 0.6}})
    found = diagnose_records(Task((replace(rubs, force_unit=units[0], position_unit=units[1]),)))
    assert found.left.force_unit == told and found.to_json_dict()["remainder"]["force_unit"] == told
    assert f"{told} rms" in found.summary
    assert any("numbers are those of a mass of 1 kg, of a joint 1 kg·m²" in said for said in found.warnings)
    axes = [plot.panels[0].ylabel for plot in article(found).plots if plot.slug.startswith("missing")]
    assert axes and set(axes) == {f"missing force [{told}]"}


def test_the_tolerance_decides_whether_what_is_left_matters(asking_about: Callable[..., None]) -> None:
    """Structure of 0.3 % of the motion, far above the noise."""
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    record = disturbed(measured(noise=1e-6), 0.01)
    verdicts = {}
    for tolerance in (1.0, 1e-3):
        found = diagnose_records(Task((record,), tolerance=tolerance))
        assert found.left.extended.seen and found.left.tolerance_percent == tolerance
        verdicts[tolerance] = found
    assert 1e-3 < verdicts[1.0].left.extended.motion_percent < 1.0
    assert not verdicts[1.0].left.exceeds and verdicts[1e-3].left.exceeds
    assert verdicts[1.0].verdict != verdicts[1e-3].verdict or verdicts[1.0].verdict == "ambiguous"
    assert "less than the tolerance of 1 %" in verdicts[1.0].summary
    assert "more than the tolerance of 0.001 %" in verdicts[1e-3].summary
    assert (verdicts[1.0].characteristics is None) and verdicts[1e-3].characteristics is not None


@pytest.mark.parametrize("tolerance", [-1.0, 100.0, math.nan])
def test_a_tolerance_that_is_no_part_is_refused(tolerance: float) -> None:
    with pytest.raises(UsageError, match="% of the motion; expected 0 to less than 100"):
        pipeline.Options(tolerance=tolerance)


def test_the_json_has_it() -> None:
    found = clean().to_json_dict()
    assert found["tolerance_percent"] == 1.0
    told = found["remainder"]
    assert told["extended"]["motion_percent"] == clean().left.extended.motion_percent
    assert told["force_unit"] == "N" and told["force_percent_of"] == "applied force"
    assert told["base"]["force_interval"] == list(clean().left.base.force_interval)
