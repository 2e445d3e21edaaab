"""Motions that no simulation follows from the first sample on: told, and cut into stretches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import Initial, fit
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.gravity import Gravity
from msd_ident.workflow import pipeline, unstable_motion
from msd_ident.workflow.preparation import prepare
from msd_ident.workflow.unstable_motion import (
    beside_their_starts,
    by_model,
    by_regression,
    cut_into,
    followed,
    growth,
    transitions,
)

MASS, DAMPING, WEIGHT, PERIOD = 0.15, 0.02, 2.8, 2e-3
JOINT = Plant(MASS, DAMPING, 0.0) + Gravity(WEIGHT)


@cache
def held_upright(seconds: float, seed: int = 1, push: float = 0.3, finer: int = 4) -> Record:
    """A pendulum that is swung up and held over its axis by a controller, and pushed by small random torques, which
    nobody records.
    """
    rng = np.random.default_rng(seed)
    angle, speed = 0.0, 0.0
    angles, torques = [], []
    for i in range(round(seconds / PERIOD)):
        wanted = 3.4 if i * PERIOD < 1.0 else -25.0 * (angle - math.pi) - 3.0 * speed
        torque = min(max(wanted, -4.0), 4.0)
        angles.append(angle)
        torques.append(torque)
        pushed = push * rng.standard_normal()
        for _ in range(finer):
            speed += (torque + pushed - WEIGHT * math.sin(angle) - DAMPING * speed) / MASS * PERIOD / finer
            angle += speed * PERIOD / finer
    time = np.arange(len(angles)) * PERIOD
    record = from_samples(time, np.array(torques), np.round(np.array(angles) / 1e-3) * 1e-3)
    return replace(record, position_unit="rad", force_unit="N·m")


def fitted(model: Model, *starts: Initial) -> Any:
    """A fit as far as it is asked about."""
    return SimpleNamespace(model=model, initial=starts)


def test_a_deviation_grows_as_the_linear_theory_says() -> None:
    """x'' = (G/I) x about the upright place: a deviation grows as e^(rate·t)."""
    rate, time = math.sqrt(WEIGHT / MASS), np.arange(0.0, 1.2, PERIOD)
    model = Plant(MASS, 0.0, 0.0) + Gravity(WEIGHT)
    still = replace(from_samples(time, np.zeros(time.size), np.zeros(time.size)), position_unit="rad")
    record = replace(still, position=simulate(model, still, math.pi - 1e-4).position)
    pieces = [record.window(0.3 * i, 0.3 * (i + 1)) for i in range(4)]
    found = growth(transitions(model, pieces))
    assert 0.5 * math.exp(rate * record.duration) < found < 2.0 * math.exp(rate * record.duration)


@pytest.mark.parametrize("model", [Plant(1.0, 2.0, 400.0), Plant(1.0, 2.0, 400.0) + CoulombFriction(0.2)])
def test_a_stable_rig_forgets_its_start(model: Model) -> None:
    time = np.arange(0.0, 4.0, PERIOD)
    record = from_samples(time, np.sign(np.sin(3.0 * time)), np.zeros(time.size))
    record = replace(record, position=simulate(model, record).position)
    assert by_model(fitted(model, Initial()), [record]) is None
    assert by_regression([replace(record, position_unit="rad")]) is None


def test_a_record_in_which_nothing_moves_has_no_growth() -> None:
    time = np.arange(0.0, 1.0, PERIOD)
    still = from_samples(time, np.zeros(time.size), np.zeros(time.size))
    assert growth(transitions(Plant(1.0, 1.0, 0.0), [still])) == 1.0
    assert by_model(fitted(Plant(1.0, 1.0, 0.0), Initial()), [still]) is None
    assert by_regression([replace(still, position_unit="rad")]) is None


def test_a_joint_that_is_held_upright_is_cut_where_it_moves() -> None:
    record = held_upright(6.0)
    found = by_model(fitted(JOINT, Initial()), [record])
    assert found is not None and len(found.records) > 3
    assert found.whole[0].samples == record.samples and found.records == found.parts[0]
    assert f"cut into {len(found.records)} stretches," in found.said and record.name in found.said
    for part in found.records:
        assert part.origin == record.origin and part.hold_known
        first = int(np.searchsorted(record.time, part.time[0]))
        np.testing.assert_array_equal(part.position, record.position[first : first + part.samples])
        np.testing.assert_array_equal(part.force_at(part.time), record.force_at(part.time))
        assert np.ptp(part.position) > 2e-3, "no stretch in which only the last digit changes"


def test_of_many_stretches_some_are_used_and_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A record of a minute was cut into 200: the work had no end, and took 5 GB (public record)."""
    record = held_upright(6.0)
    whole = by_model(fitted(JOINT, Initial()), [record])
    monkeypatch.setattr(unstable_motion, "_MOST", 3)
    found = by_model(fitted(JOINT, Initial()), [record])
    assert whole is not None and found is not None and found.counts == whole.counts == (len(whole.records),)
    assert f"cut into {len(whole.records)} stretches, each with its own start, of which 3 are used." in found.said
    assert "are used" not in whole.said
    one = replace(found, parts=((found.parts[0][0],),), counts=(1,))
    assert "follows the whole record. One stretch of it is used, with its own start. Angles count" in one.said
    assert [part.time[0] for part in found.records] == [
        whole.records[i].time[0] for i in unstable_motion._spread(len(whole.records), 3)
    ]
    assert (
        found.records[0].time[0] == whole.records[0].time[0]
        and found.records[-1].time[-1] == whole.records[-1].time[-1]
    )


def test_a_regression_finds_the_weight_and_cuts_only_what_is_unstable() -> None:
    time = np.arange(0.0, 4.0, PERIOD)
    hanging = from_samples(time, 0.5 * np.sign(np.sin(3.0 * time)), np.zeros(time.size))
    hanging = replace(hanging, position_unit="rad", force_unit="N·m")
    hanging = replace(hanging, position=np.round(simulate(JOINT, hanging).position, 4))
    assert by_regression([hanging]) is None
    found = by_regression([hanging, held_upright(6.0)])
    assert found is not None and found.parts[0] == (found.whole[0],) and len(found.parts[1]) > 3
    assert found.said.count("is unstable") == 1
    assert by_regression([replace(held_upright(6.0), position_unit="m")]) is None, "no joint"


def led_on_the_level(seconds: float, hidden: float, seed: int) -> Record:
    """An arm with an upright axis, led by a proportional controller, with a pendulum on it that nobody measures."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / PERIOD)) * PERIOD
    wanted = np.sign(np.sin(2.0 * math.pi * time / 3.0))
    angle = speed = swing = rate = 0.0
    angles, torques = [], []
    for goal in wanted:
        torque = 3.0 * (goal - angle)
        angles.append(angle + 1e-5 * rng.standard_normal())
        torques.append(torque)
        for _ in range(4):
            pulled = hidden * (60.0 * swing + 0.2 * rate)
            speed += (torque - 0.4 * speed + pulled) / 0.06 * PERIOD / 4
            rate -= (60.0 * swing + 0.2 * rate + (torque - 0.4 * speed + pulled) / 0.06) * PERIOD / 4
            angle, swing = angle + speed * PERIOD / 4, swing + rate * PERIOD / 4
    record = from_samples(time, np.array(torques), np.array(angles))
    return replace(record, position_unit="rad", force_unit="N·m")


@pytest.mark.parametrize("hidden", [0.0, 0.006])
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_an_arm_that_a_controller_leads_on_the_level_is_not_unstable(hidden: float, seed: int) -> None:
    """The controller pulls to a place as a weight would push away from it: a regression calls that a weight."""
    record = led_on_the_level(9.0, hidden, seed)
    assert by_regression([record]) is None
    weight = Plant(0.06, 0.4, 0.0) + Gravity(2.0)
    cut = unstable_motion._cut(weight, (math.pi,), [record])
    assert cut.said and cut.needless, "a weight is looked at, and does nothing"


def kicked(seed: int) -> Record:
    """A pendulum that hangs, kicked all the time by a coil that nobody measures: it never gets as high as its axis."""
    rng = np.random.default_rng(seed)
    time = 0.05 * np.arange(620)
    angle, speed, angles = 0.0, 0.0, []
    for i in range(time.size):
        angles.append(angle + 2e-3 * rng.standard_normal())
        if i % 25 == 0:
            speed += 4.5 * (-1.0 if speed < 0.0 else 1.0) * rng.uniform(0.3, 1.0)
            speed *= 0.3 if abs(angle) > 1.1 else 1.0
        for _ in range(50):
            speed -= (100.0 * math.sin(angle) + 0.3 * speed) * 1e-3
            angle += speed * 1e-3
    return replace(from_samples(time, np.zeros(time.size), np.array(angles)), position_unit="rad", force_unit="N·m")


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_pendulum_that_stays_below_its_axis_is_not_unstable(seed: int) -> None:
    """A measured one was cut into 8 stretches, and said to be held by a controller; no force acts in that record."""
    record = kicked(seed)
    assert float(np.max(np.abs(record.position))) < 0.5 * math.pi
    assert by_regression([record]) is None


def stepped(seed: int) -> Record:
    """A joint on a spring that rises after a step of the force, by 0.1 rad in all, in gusts that nobody recorded."""
    rng, time = np.random.default_rng(seed), 0.05 * np.arange(210)
    step = 5.0 * (time >= 1.0)
    gust = 0.3 * lfilter([math.sqrt(1.0 - 0.9**2)], [1.0, -0.9], rng.standard_normal(210)) * (time >= 1.0)
    moved = simulate(Plant(0.6, 12.0, 48.0), from_samples(time, step + gust, 0.0 * time)).position
    seen = np.radians(np.round(np.degrees(moved), 2))
    return replace(from_samples(time, step, seen), position_unit="rad", force_unit="V")


@pytest.mark.parametrize("seed", [1, 2])
def test_a_joint_that_rises_and_stays_is_not_unstable(seed: int) -> None:
    """A regression gave it a spring of 1e5 V/rad and a weight that cancels it: "cut into 9 stretches ... hangs"."""
    assert by_regression([stepped(seed)]) is None


def test_a_weight_that_the_stretches_do_not_show_is_none() -> None:
    """Of a measured axis that stands upright a regression found a weight. A fit to the stretches left too little of it,
    while no model without it followed the whole record either.
    """
    record = led_on_the_level(9.0, 0.0, 1)
    drifts = replace(record, force=record.force + 0.5 * np.sin(0.7 * record.time) ** 2)
    cut = unstable_motion._cut(Plant(0.06, 0.4, 0.0) + Gravity(2.0), (math.pi,), [drifts])
    assert cut.said and cut.weighed.see < 0.5 * cut._fitted(cut.model.without("gravity")).see
    assert cut.needless


def test_what_is_known_of_the_records_holds_for_the_stretches() -> None:
    prepared = prepare([held_upright(6.0)])
    cut = by_regression(prepared.records)
    assert cut is not None
    into = cut_into(prepared, cut)
    assert into.records == cut.records and into.form is None and not into.asks_hold
    assert into.warnings == (cut.said, *prepared.warnings) and into.findings == prepared.findings
    assert into.rest_before == (None,) * len(cut.records)


def test_a_start_explains_a_straight_line_and_no_more() -> None:
    time = np.arange(0.0, 1.0, PERIOD)
    record = from_samples(time, np.zeros(time.size), 3.0 * time + time**2)
    (left,) = beside_their_starts([record])
    np.testing.assert_allclose(left.position, time**2 - np.polyval(np.polyfit(time, time**2, 1), time), atol=1e-12)


@pytest.mark.parametrize("push", [0.0, 0.3])
def test_a_record_is_followed_as_a_whole_where_nothing_disturbs_it(push: float) -> None:
    """Of a motion that is a little unstable, and not disturbed, the stretches' model leaves only noise."""
    record = held_upright(4.5, push=push, finer=40)
    cut = by_model(fitted(JOINT, Initial()), [record])
    assert cut is not None
    assert followed(fit(JOINT, cut.records), cut) == (push == 0.0)
    assert (by_regression([record]) is None) == (push == 0.0), "what is followed needs no cut"


@pytest.mark.parametrize("samples", [20, 39, 41, 500, 1000, 5000])
def test_a_stretch_of_each_piece_has_samples_enough_for_a_record(samples: int) -> None:
    time = np.arange(samples) * PERIOD
    record = from_samples(time, np.sin(time), np.cos(time))
    pieces = unstable_motion._pieces(record)
    parts = unstable_motion._parts(record, pieces, range(len(pieces)))
    np.testing.assert_array_equal(np.concatenate([part.time for part in parts]), time)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_its_weight_is_found_and_nothing_is_certain(seed: int, asking_about: Callable[..., None]) -> None:
    """Of the whole record a tone, a force offset and friction that settles were certain; the inertia was 20 % off."""
    asking_about("gravity", "periodic_disturbance")
    found = pipeline.diagnose([held_upright(7.0, seed)])
    assert "gravity" in [cause.name for cause in found.causes]
    assert all(cause.probability < 0.9 + 1e-6 for cause in found.causes)
    assert found.extended.model["gravity_moment"] == pytest.approx(WEIGHT, rel=0.02)
    assert found.extended.model.mass == pytest.approx(MASS, rel=0.02)
    assert len(found.records) > 3 and "is unstable" in found.warnings[0]
    assert any("which friction also does: no cause is certain" in said for said in found.warnings)
