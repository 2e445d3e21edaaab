"""A force that has nothing to do with the motion: said in one line, and never of a rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.real.rigs import RIGS, Rig, folder
from msd_ident.data.quality.relation import accounted, without_spring
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError
from msd_ident.io import read
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.gravity import Gravity
from msd_ident.workflow import pipeline
from msd_sim import api, lottery


def moved_by_hand(seed: int, seconds: float = 20.0) -> Record:
    """A joint that a hand moves to and fro, and the effort of a motor that is off."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 0.01)
    position = np.convolve(rng.standard_normal(time.size + 200), np.hanning(200), "valid")[: time.size]
    return from_samples(time, 0.05 * rng.standard_normal(time.size), 0.02 * position)


def test_a_pendulum_that_goes_round_is_held_by_its_weight() -> None:
    """Its force and motion were said to have nothing to do with each other: of a spring they have not."""
    time = np.arange(0.0, 10.0, 0.01)
    torque = 0.2 * np.sign(np.sin(2.0 * np.pi * 0.45 * time) + 0.6 * np.sin(2.0 * np.pi * 0.31 * time))
    still = replace(from_samples(time, torque, np.zeros(time.size)), position_unit="rad", force_unit="N·m")
    angle = simulate(Plant(0.08, 0.005, 0.0) + Gravity(1.4), still, 3.0, 3.0).position
    assert np.ptp(angle) > 4.0 * np.pi
    record = replace(still, position=angle)
    assert accounted(replace(record, position_unit="m")) < 0.0 < 0.95 < accounted(record)


@pytest.mark.parametrize("seed", range(5))
def test_an_angle_moved_by_hand_is_refused_too(seed: int) -> None:
    for times in (1.0, 30.0):  # hardly bent, and over turns
        hand = moved_by_hand(seed)
        record = replace(hand, position=times * hand.position, position_unit="rad", force_unit="N·m")
        assert accounted(record) < 0.2


@pytest.mark.parametrize("seed", range(5))
def test_a_joint_moved_by_hand_is_refused_in_one_line(seed: int) -> None:
    record = moved_by_hand(seed)
    assert accounted(record) < 0.2
    for solve in (pipeline.identify, pipeline.diagnose):
        with pytest.raises(DataError, match="accounts for . % of the force's variation.*a hand may move the cart"):
            solve([record])


@pytest.mark.parametrize(
    ("noise", "experiment"),
    [
        pytest.param(noise, experiment, marks=() if i == j else pytest.mark.long)
        for i, noise in enumerate(lottery.NOISES)
        for j, experiment in enumerate(("sweep", "steps", "ramp"))
    ],
)
def test_no_rig_is_refused(noise: lottery.Noise, experiment: str) -> None:
    """Whatever is wrong with it, strong or weak."""
    told = []
    for seed, name in enumerate((*lottery.NAMES, *lottery.ODDITIES, None)):
        draw = lottery.draw(seed, name, seed % 2 == 0, experiment, 250.0, ranges="wide", noise=noise)
        made = api.simulate(draw.spec)
        if np.ptp(made.motion.position) < 10.0 * draw.noise:
            continue  # a cart that sticks: said by others
        share = accounted(Record(made.time, made.position, made.force_time, made.force))
        assert not share < 0.4, (name, seed, share)
        told.append(not np.isnan(share))
    assert any(told)


def test_a_cart_that_runs_into_stiff_stops_again_and_again_is_not_refused() -> None:
    """At resonance most of its force is that of the stops, which no mass, damping and stiffness make."""
    tones = [{"frequency": part * 5.9, "amplitude": 0.6} for part in (0.31, 0.57, 0.83, 1.17, 1.6, 2.3)]
    time = np.arange(0.0, 10.0, 0.005)
    force = sum(one["amplitude"] * np.sin(2.0 * np.pi * one["frequency"] * time + i) for i, one in enumerate(tones))
    made = api.simulate(
        {"mass": 1.86, "damping": 2.9, "stiffness": 2580.0, "friction_coefficient": 0.0, "seed": 1, "rate": 200.0,
         "effects": {"end_stop": {"stop_position": 1.14e-3, "stop_stiffness": 35_000.0}}, "duration": 10.0,
         "encoder": {"counts_per_metre": 0.0, "noise": 3e-7}, "force_time": list(time), "force": list(force)}
    )  # fmt: skip
    assert accounted(Record(made.time, made.position, made.force_time, made.force)) > 0.8


def test_a_spring_shows_in_the_force_and_none_does_not() -> None:
    """However coarse the windows: no joint is pushed by its place because a window's weights do not sum up to 0."""
    time = np.arange(0.0, 6.0, 0.004)
    force = 1.5 * np.sign(np.sin(2.3 * time + 0.1))
    for stiffness in (0.0, 40.0):
        made = api.simulate(
            {"mass": 0.18, "damping": 0.7, "stiffness": stiffness, "friction_coefficient": 0.0, "seed": 2,
             "rate": 250.0, "duration": 6.0, "encoder": {"counts_per_metre": 0.0, "noise": 1e-3},
             "effects": {"force_offset": {"offset_force": 0.2}}, "force_time": list(time), "force": list(force)}
        )  # fmt: skip
        record = Record(made.time, 2.0 + made.position, made.force_time, made.force)
        sprung, free = without_spring(record, 1e-3)
        assert sprung > 0.9
        assert sprung - free > 0.3 if stiffness else sprung - free < 0.01
    assert np.isnan(without_spring(moved_by_hand(1, seconds=1.0))).all()


def test_what_does_not_vary_tells_nothing() -> None:
    """One step that acts from the first sample on, a release, and a record of few samples."""
    for experiment in ("step", "release"):
        made = api.simulate(lottery.draw(1, None, False, experiment).spec)
        assert np.isnan(accounted(Record(made.time, made.position, made.force_time, made.force)))
    assert np.isnan(accounted(moved_by_hand(1, seconds=1.0)))


def test_one_step_that_a_noisy_encoder_saw_is_no_unrelated_force() -> None:
    """All variation of the force is in the few windows around the step, where noise is as large."""
    lots = np.random.default_rng(1)
    for _ in range(200):
        omega, zeta, noise = lots.uniform(5.0, 12.0), 10.0 ** lots.uniform(-2.3, -1.2), lots.choice([1e-3, 3e-3, 1e-2])
        time = np.arange(lots.integers(800, 1500)) / (omega / (2.0 * np.pi) * lots.uniform(16.0, 90.0))
        onset, damped = 0.05 * time[-1], omega * np.sqrt(1.0 - zeta**2)
        t = np.maximum(time - onset, 0.0)
        response = 1.0 - np.exp(-zeta * omega * t) * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))
        position = 0.2 * (response + noise * lots.standard_normal(time.size))
        share = accounted(Record(time, position, np.array([onset]), np.array([0.2 * omega**2])), 0.2 * noise)
        assert not share < 0.4, (omega, zeta, noise, share)


@pytest.mark.parametrize("rig", [rig for rig in RIGS if rig.options.force != "none"], ids=lambda rig: rig.name)
def test_no_measured_rig_is_refused(rig: Rig) -> None:
    if not (folder() / rig.path).is_file():
        pytest.skip(f"no {folder() / rig.path}")
    assert accounted(read(folder() / rig.path, rig.options)) > 0.8
