"""A force that acts before its stamps: simulators of other authors make it, and it is no cause of a rig."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.data.resampling import centred
from msd_ident.estimate import fit
from msd_ident.io import SourceOptions, read, write_csv
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import by_name
from msd_ident.workflow import force_lead, pipeline, saved_model, validation
from msd_ident.workflow.law_error import widened
from msd_ident.workflow.preparation import held_otherwise, prepare

RIG, PERIOD, NOISE = Plant(mass=1.0, damping=1.0, stiffness=1500.0), 0.002, 2e-6
FORCE = np.repeat([0.0, 4.0, 0.0, -4.0, 0.0, 2.0, 0.0, -2.0, 0.0, 3.0, 0.0, -3.0, 0.0], 300)


def told(position: np.ndarray, period: float = PERIOD) -> Record:
    """A table with a position and a command in each line."""
    noise, force = NOISE * np.random.default_rng(5).normal(size=position.size), FORCE[: position.size]
    return replace(from_samples(period * np.arange(position.size), force, position + noise), hold_known=False)


def stepped(steps: int = 1) -> Record:
    """A staircase as a simulation tells it that takes a few semi-implicit Euler steps a sample.

    Velocity first, then position with the new velocity: half a step early, to second order.
    """
    position, x, v, step = np.zeros(FORCE.size), 0.0, 0.0, PERIOD / steps
    for i, push in enumerate(FORCE):
        position[i] = x
        for _ in range(steps):
            v += step * (push - RIG.damping * v - RIG.stiffness * x) / RIG.mass
            x += step * v
    return told(position)


def shifted(early: float, period: float = PERIOD) -> Record:
    """The same by an exact solver, with a force that acts so many samples before its stamps."""
    still = told(np.zeros(FORCE.size), period)
    return told(simulate(RIG, replace(still, force_time=still.time - early * period)).position, period)


@pytest.mark.parametrize("steps", [1, 2, 4])
def test_a_step_of_the_integrator_is_no_delay(steps: int, asking_about: Callable[..., None]) -> None:
    """Clean joints of MuJoCo, Bullet, DART and Drake had a time offset of half a step with > 99.9 %."""
    asking_about("coulomb_friction", "time_offset", "actuator_lag")
    found = pipeline.diagnose([stepped(steps)])
    assert found.verdict == "adequate" and not found.causes
    sheet = found.to_json_dict()["data"][0]
    assert sheet["force_lead_s"] == pytest.approx(0.5 * PERIOD / steps, rel=0.1)
    assert sheet["force_hold"] == ("centred" if steps == 1 else "zero")
    (said,) = [one for one in found.findings if one.code == "force_lead"]
    part = "half a sample" if steps == 1 else "less than half a sample"
    assert said.sentence.startswith("The force is assumed to act ") and f"before its stamps, {part}:" in said.sentence
    assert said.sentence in found.warnings and "semi-implicit Euler" in said.sentence
    # Such steps are those of a plant that is lighter by b·h/2, and by parts of k·h².
    assert found.extended.quantities["mass"].value == pytest.approx(1.0 - 0.5 * PERIOD / steps, rel=1e-3)


def test_a_lead_that_no_diagnosis_names_is_found_where_it_is_clear(asking_about: Callable[..., None]) -> None:
    """Without a time offset in the library, the diagnosed model is fitted once more with one."""
    asking_about("coulomb_friction")
    found = pipeline.diagnose([stepped()])
    assert found.verdict == "adequate" and found.records[0].lead == pytest.approx(0.5 * PERIOD)
    right = pipeline.diagnose([shifted(0.0)])
    assert right.records[0].lead == 0.0 and not [one for one in right.findings if one.code == "force_lead"]


@pytest.mark.parametrize(("early", "lead"), [(0.002, 0.0), (0.02, 0.02)])
def test_a_lead_of_next_to_nothing_is_none(early: float, lead: float) -> None:
    """A cart under a controller was said to lead by 1.13e-06 ms, however small that is beside its samples of 1 ms."""
    still = replace(from_samples(PERIOD * np.arange(FORCE.size), FORCE, np.zeros(FORCE.size)), hold_known=False)
    exact = simulate(RIG, replace(still, force_time=still.time - early * PERIOD)).position
    record = replace(still, position=exact + 1e-9 * np.random.default_rng(5).normal(size=exact.size))
    assert force_lead.found(fit(RIG, [record]), [record]) == pytest.approx(lead * PERIOD, rel=1e-2)


@pytest.mark.parametrize("named", [False, True])
def test_a_lead_that_the_error_of_a_law_may_make_is_none(named: bool) -> None:
    """A hardening spring without its law: "simulations with semi-implicit Euler steps do so ... It is no cause"."""
    hard = RIG + by_name("cubic_spring").from_values({"cubic_stiffness": 1e7})
    still = told(np.zeros(FORCE.size))
    record = told(simulate(hard, replace(still, force_time=still.time - 0.3 * PERIOD)).position)
    plain = fit(RIG + by_name("time_offset").within_bounds(0.0) if named else RIG, [record])
    assert plain.see > 30.0 * NOISE
    stated = widened(plain)
    assert force_lead.found(stated, [record]) == 0.0
    assert force_lead.found(fit(hard, [record]), [record]) == pytest.approx(0.3 * PERIOD, rel=0.1)


@pytest.mark.parametrize("early", [-0.5, 0.8, 1.0])
def test_a_delay_and_a_longer_lead_are_causes(early: float, asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "time_offset", "actuator_lag")
    found = pipeline.diagnose([shifted(early)])
    assert [cause.name for cause in found.causes] == ["time_offset"] and found.verdict == "explained"
    assert found.extended.model.effect("time_offset").values[0] == pytest.approx(-early * PERIOD, rel=0.05)
    assert not [one for one in found.findings if one.code in ("force_hold", "force_lead")]


def test_a_sparse_command_leads_by_half_a_sample_of_the_position() -> None:
    """Not by half of the time since the command before."""
    time = 0.01 * np.arange(500)
    record = replace(from_samples(time, time, time), force_time=np.array([0.0, 1.0, 4.0]), force=np.ones(3))
    np.testing.assert_allclose(centred(record).force_time, [-0.005, 0.995, 3.995])


def test_a_known_hold_is_not_asked(tmp_path: Path, asking_about: Callable[..., None]) -> None:
    """A topic's command, or ``--hold zero``, is held from its stamp; ``--hold centred`` says what the data would."""
    asking_about("time_offset")
    write_csv(stepped(), tmp_path / "rig.csv")
    held = pipeline.diagnose([read(tmp_path / "rig.csv", SourceOptions(hold="zero"))])
    assert [cause.name for cause in held.causes] == ["time_offset"]
    early = pipeline.diagnose([read(tmp_path / "rig.csv", SourceOptions(hold="centred"))])
    assert early.verdict == "adequate" and early.extended.see < 1.02 * held.extended.see


@pytest.mark.parametrize("steps", [1, 3])
def test_a_saved_model_says_when_the_force_of_another_record_acts(
    steps: int, asking_about: Callable[..., None]
) -> None:
    asking_about("time_offset")
    model = saved_model.from_json_dict(pipeline.diagnose([stepped(steps)]).to_json_dict())
    assert validation.validate(model, [replace(stepped(steps), name="other")]).see < 1.05 * NOISE


def again(*records: Record) -> list[Record]:
    """The records as they are diagnosed after a first fit."""
    prepared = prepare(records)
    found = held_otherwise(prepared, fit(RIG, prepared.records))
    return list(prepared.records if found is None else found.records)


def test_a_lead_near_half_a_sample_is_not_rounded_to_it() -> None:
    (record,) = again(shifted(0.475))
    assert record.lead == pytest.approx(0.475 * PERIOD, rel=0.01)
    assert fit(RIG, record).see < 1.02 * NOISE


def test_one_lead_of_records_with_two_rates_is_bounded_by_the_faster_one() -> None:
    slow, fast = shifted(0.1, 4.0 * PERIOD), shifted(0.4)
    assert [one.lead for one in again(slow, fast)] == [pytest.approx(0.4 * PERIOD, rel=0.02)] * 2
    assert [one.lead for one in again(shifted(0.25, 4.0 * PERIOD), shifted(1.0))] == [0.0, 0.0], "a time offset"


def test_a_short_record_is_shifted_with_a_long_one() -> None:
    long, short = again(shifted(0.25), replace(shifted(0.25).window(0.55, 0.9), name="short"))
    assert long.lead == short.lead == pytest.approx(0.25 * PERIOD, rel=0.05)


def test_the_lead_is_asked_after_the_hold_and_not_twice() -> None:
    prepared = prepare([shifted(0.25)])
    found = held_otherwise(prepared, fit(RIG, prepared.records))
    assert found is not None
    assert held_otherwise(found, fit(RIG, found.records)) is None
