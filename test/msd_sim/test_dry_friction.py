"""Sticking, sliding and reversals against the half-cycle closed form: right to 1e-9 m, and to far less."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_sim.api import simulate
from msd_sim.rig import Rig
from msd_sim.truth import Truth


def half_cycles(time, mass, damping, stiffness, coulomb, static, force, start):
    """Positions at ``time`` from rest at ``start``; and the instant from which the cart sticks.

    Within a half-cycle the direction s lasts, so m x'' + b x' + k x = F - s Fc is linear about xe = (F - s Fc) / k; it
    ends after half a damped period, and the next one begins only where |F - k x| exceeds the static friction.
    """
    """Positions at ``time`` from rest at ``start``; and the instant from which the cart sticks (inf: never)."""
    natural = math.sqrt(stiffness / mass)
    decay = damping / (2.0 * mass)
    assert decay < natural, "closed form for oscillating plants"
    damped = math.sqrt(natural**2 - decay**2)
    position = np.empty_like(time)
    begin, x = 0.0, start
    while True:
        push = force - stiffness * x
        later = time >= begin
        if abs(push) <= static or begin > time[-1]:
            position[later] = x
            return position, begin
        centre = (force - math.copysign(coulomb, push)) / stiffness
        t = time[later] - begin
        swing = np.exp(-decay * t) * (np.cos(damped * t) + decay / damped * np.sin(damped * t))
        position[later] = centre + (x - centre) * swing
        x = centre - (x - centre) * math.exp(-decay * math.pi / damped)
        begin += math.pi / damped


ECP = {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1}
ECP_COULOMB = 0.0133 * 0.9407 * 9.81


def test_step_of_the_paper_and_its_return_agree_with_half_cycles():
    seen = simulate({"rig": "ecp", "experiment": "paper"}).motion
    up, down = seen.time <= 3.0, seen.time >= 3.0
    first, stuck_at = half_cycles(seen.time[up], *ECP.values(), ECP_COULOMB, ECP_COULOMB, 10.425, 0.0)
    second, _ = half_cycles(seen.time[down] - 3.0, *ECP.values(), ECP_COULOMB, ECP_COULOMB, 0.0, first[-1])
    assert np.abs(seen.position[up] - first).max() < 1e-14
    assert np.abs(seen.position[down] - second).max() < 1e-14
    assert 1.0 < stuck_at < 1.3
    resting = (seen.time > stuck_at) & (seen.time < 3.0)
    assert np.ptp(seen.position[resting]) == 0.0 and not seen.velocity[resting].any()


@settings(max_examples=60, deadline=None)
@given(
    mass=st.floats(0.1, 10.0),
    ratio=st.floats(0.0, 0.5),
    stiffness=st.floats(10.0, 5000.0),
    friction=st.floats(0.005, 0.3),
    stiction=st.floats(1.0, 2.0),
    force=st.floats(-20.0, 20.0),
    start=st.floats(-0.05, 0.05),
)
def test_any_plant_from_anywhere(mass, ratio, stiffness, friction, stiction, force, start):
    damping = 2.0 * ratio * np.sqrt(mass * stiffness)
    coulomb = friction * max(abs(force - stiffness * start), 0.1)
    static = stiction * coulomb
    time = np.arange(1500) * 2e-3
    spec = {
        "mass": mass, "damping": damping, "stiffness": stiffness, "initial_position": start, "time": time,
        "effects": {"coulomb_friction": {"coulomb_force": coulomb, "static_force": static}},
        "force_time": [0.0], "force": [force],
    }  # fmt: skip
    seen = simulate(spec).motion.position
    closed, _ = half_cycles(time, mass, damping, stiffness, coulomb, static, force, start)
    assert np.abs(seen - closed).max() < 1e-9 * max(1.0, np.abs(closed).max())


def test_coarse_samples_see_the_same_motion():
    spec = {"rig": "ecp", "experiment": {"name": "release", "position": 0.03}}
    fine, coarse = (simulate({**spec, "rate": rate}).motion.position for rate in (2000.0, 40.0))
    assert np.abs(fine[::50] - coarse).max() < 1e-12


@pytest.mark.parametrize("share", [0.2, 0.999999, 1.0])
def test_a_push_up_to_the_static_friction_never_moves_the_cart(share):
    truth = Truth(1.0, 2.0, 100.0, {"coulomb_friction": {"coulomb_force": 0.3, "static_force": 0.5}})
    rig = Rig(truth)
    rig.push(0.0, 0.5 * share)
    motion = rig.sample(np.linspace(0.0, 1e4, 1001))
    assert rig.sticks and not motion.position.any()


def test_it_leaves_at_once_above_the_static_friction():
    truth = Truth(1.0, 2.0, 100.0, {"coulomb_friction": {"coulomb_force": 0.3, "static_force": 0.5}})
    rig = Rig(truth)
    rig.push(0.0, 0.5 * (1.0 + 1e-9))
    closed, _ = half_cycles(np.array([0.0, 0.01]), 1.0, 2.0, 100.0, 0.3, 0.5, 0.5 * (1.0 + 1e-9), 0.0)
    assert rig.step_to(0.01).position[0] == pytest.approx(closed[1], abs=1e-12)


def test_breakaway_on_a_ramp_happens_at_the_very_instant():
    # push = 2 t reaches 0.5 N at 0.25 s; from there m x'' = 2 (t - 0.25) + (0.5 - 0.3) without spring and damper
    spec = {
        "mass": 1.3, "damping": 0.0, "stiffness": 0.0, "time": np.arange(0.0, 1.0, 0.0101), "hold": "linear",
        "force_time": [0.0, 1.0], "force": [0.0, 2.0],
        "effects": {"coulomb_friction": {"coulomb_force": 0.3, "static_force": 0.5}},
    }  # fmt: skip
    seen = simulate(spec).motion
    t = np.maximum(seen.time - 0.25, 0.0)
    assert np.abs(seen.position - (t**3 / 3.0 + 0.1 * t**2) / 1.3).max() < 1e-13


def test_a_push_that_peaks_between_two_samples_moves_the_cart():
    # 1.001 N of a 50 rad/s disturbance against 1 N of friction: above it for 1.8 ms only, sampled every 20 ms
    effects = {
        "coulomb_friction": {"coulomb_force": 1.0},
        "periodic_disturbance": {"disturbance_amplitude": 1.001, "disturbance_frequency": 50.0},
    }
    seen = simulate({"mass": 0.1, "damping": 0.0, "stiffness": 0.0, "effects": effects, "time": np.arange(0, 1, 0.02),
                     "force_time": [0.0], "force": [0.0]})  # fmt: skip
    fine = simulate({"mass": 0.1, "damping": 0.0, "stiffness": 0.0, "effects": effects, "time": np.arange(0, 1, 1e-4),
                     "force_time": [0.0], "force": [0.0]})  # fmt: skip
    assert np.ptp(fine.motion.position) > 1e-8
    assert np.abs(seen.motion.position - fine.motion.position[::200]).max() < 1e-12


def test_position_dependent_friction_half_cycle():
    # moving up: m x'' + (k + Fc a) x = -Fc from rest at -x0, undamped: a half-cycle about -Fc / (k + Fc a)
    m, k, fc, a, x0 = 0.8, 300.0, 0.4, 12.0, 0.04
    stiff = k + fc * a
    time = np.linspace(0.0, np.pi / np.sqrt(stiff / m), 50)
    effects = {"position_dependent_friction": {"coulomb_force": fc, "position_friction_slope": a}}
    seen = simulate({"mass": m, "damping": 0.0, "stiffness": k, "effects": effects, "initial_position": -x0,
                     "time": time, "force_time": [0.0], "force": [0.0]})  # fmt: skip
    closed = -fc / stiff + (-x0 + fc / stiff) * np.cos(np.sqrt(stiff / m) * time)
    assert np.abs(seen.motion.position - closed).max() < 1e-13


def test_friction_that_falls_with_speed_against_energy():
    # one stroke: m v dv/dx = F - friction(v); time and place of the same stroke by quadrature over v
    from scipy.integrate import quad

    m, force, fc, fs, vs = 1.0, 1.0, 0.3, 0.7, 0.05
    effects = {"stribeck_friction": {"coulomb_force": fc, "static_force": fs, "stribeck_velocity": vs}}
    spec = {"mass": m, "damping": 0.0, "stiffness": 0.0, "effects": effects, "time": [0.0, 0.1, 0.2, 0.4],
            "force_time": [0.0], "force": [force]}  # fmt: skip
    motion = simulate(spec).motion
    for t, x, v in zip(motion.time, motion.position, motion.velocity, strict=True):

        def pull(u):
            return force - fc - (fs - fc) * np.exp(-((u / vs) ** 2))

        assert quad(lambda u: m / pull(u), 0.0, v, epsabs=1e-13, epsrel=1e-13)[0] == pytest.approx(t, abs=1e-11)
        assert quad(lambda u: m * u / pull(u), 0.0, v, epsabs=1e-13, epsrel=1e-13)[0] == pytest.approx(x, abs=1e-11)


def test_a_stop_between_two_samples_is_not_overlooked():
    # m v' = -A sin(w t) - Fc is zero again at sin(w t) = -Fc / A: there the cart would run backwards, for 0.2 ms
    mass, coulomb, amplitude, frequency = 1.0, 0.05, 1.0, 20.0
    effects = {
        "coulomb_friction": {"coulomb_force": coulomb},
        "periodic_disturbance": {"disturbance_amplitude": amplitude, "disturbance_frequency": frequency},
    }
    slowest = (np.pi + np.arcsin(coulomb / amplitude)) / frequency
    loss = (amplitude / frequency * (1.0 - np.cos(frequency * slowest)) + coulomb * slowest) / mass
    spec = {"mass": mass, "damping": 0.0, "stiffness": 0.0, "effects": effects, "force_time": [0.0], "force": [0.0],
            "initial_velocity": loss - 1e-7}  # fmt: skip
    fine, coarse = (simulate(spec | {"time": np.arange(0.0, 0.4, step)}).motion for step in (2e-5, 0.04))
    assert np.count_nonzero(fine.velocity == 0.0) > 0
    assert np.abs(coarse.position - fine.position[::2000]).max() < 1e-12
