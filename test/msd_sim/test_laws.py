"""Laws that hold for every effect: energy, mirror images, chunks, sampling; and SciPy as a second opinion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from msd_sim import effects
from msd_sim.api import simulate
from msd_sim.rig import Rig
from msd_sim.truth import Truth

PLANT = {"mass": 0.9, "damping": 1.5, "stiffness": 700.0}
#: Effects on which a force acts alike in both directions.
LOPSIDED = {"asymmetric_spring", "force_offset", "magnet", "loose_cable", "position_dependent_friction", "encoder_slip",
            "eccentric_friction", "periodic_disturbance", "cogging", "sensor_drift", "one_sided_stop",
            "one_way_damping", "two_slope_spring", "two_tone_disturbance", "settling_sensor",
            "sensor_nonlinearity"}  # fmt: skip
FORCE_TIME = np.array([0.0, 0.31, 0.52, 1.1, 1.3])
FORCE = np.array([6.0, -3.0, 9.0, -8.0, 0.0])


def moves(names, rate=500.0, sign=1.0, **more):
    return simulate(
        PLANT | {"effects": dict.fromkeys(names), "rate": rate, "duration": 2.0, "force_time": FORCE_TIME}
        | {"force": sign * FORCE} | more
    )  # fmt: skip


@pytest.mark.parametrize("name", effects.ALL)
def test_sampling_does_not_change_the_motion(name):
    fine, coarse = moves([name], 2000.0), moves([name], 125.0)
    assert np.abs(fine.motion.position[::16] - coarse.motion.position).max() < 1e-11


NARROW = {
    "friction that rises within 0.7 mm/s": {
        "stribeck_friction": {"coulomb_force": 0.06, "static_force": 0.6, "stribeck_velocity": 0.0007}
    },
    "a magnet a third of a millimetre wide": {
        "magnet": {"magnet_strength": 1e-5, "magnet_position": 0.009, "magnet_gap": 0.0003}
    },
    "teeth of half a millimetre": {"cogging": {"cogging_amplitude": 0.5, "cogging_pitch": 5e-4}},
    "a disturbance faster than the samples": {
        "coulomb_friction": {"coulomb_force": 0.3},
        "periodic_disturbance": {"disturbance_amplitude": 0.4, "disturbance_frequency": 900.0},
    },
}


@pytest.mark.parametrize("worn", NARROW.values(), ids=NARROW)
def test_no_force_is_leapt_over(worn):
    spec = PLANT | {"effects": worn, "force_time": FORCE_TIME, "force": FORCE, "initial_velocity": -0.1}
    fine, coarse = (simulate(spec | {"time": np.arange(0.0, 1.0, step)}).motion.position for step in (5e-5, 0.02))
    assert np.abs(fine[::400] - coarse).max() < 1e-10


def test_everything_wrong_at_once():
    sweep = {"name": "sweep", "duration": 6.0}
    seen = simulate(PLANT | {"effects": dict.fromkeys(e.name for e in effects.KNOWN), "experiment": sweep})
    assert np.isfinite(seen.position).all() and 1e-3 < np.ptp(seen.motion.position) < 0.1


@pytest.mark.parametrize("name", sorted(effects.ALL.keys() - LOPSIDED))
def test_the_mirrored_force_gives_the_mirrored_motion(name):
    there, back = moves([name]), moves([name], sign=-1.0)
    assert np.abs(there.motion.position + back.motion.position).max() < 1e-14


#: Parameters that make an effect vanish at 0, where that is not the first one.
STRENGTH = {
    "stribeck_friction": ("coulomb_force", "static_force"),
    "friction_change": ("coulomb_force", "later_coulomb_force"),
    "second_mode": ("second_stiffness", "second_damping"),
    "end_stop": ("stop_stiffness",),
    "rational_stribeck": ("coulomb_force", "static_force"),
    "exponential_stribeck": ("coulomb_force", "static_force"),
    "load_friction": ("coulomb_force", "load_ratio"),
    "sensor_nonlinearity": ("sensor_curvature", "sensor_cubic"),
    "one_sided_stop": ("one_stop_stiffness",),
    "damped_stop": ("soft_stop_stiffness",),
    "two_tone_disturbance": ("low_tone_amplitude", "high_tone_amplitude"),
}


@pytest.mark.parametrize("name", effects.ALL)
def test_an_effect_without_strength_is_no_effect(name):
    none = dict.fromkeys(STRENGTH.get(name, (effects.ALL[name].parameters[0].name,)), 0.0)
    with_it = simulate(PLANT | {"effects": {name: none}, "duration": 2.0, "force_time": FORCE_TIME, "force": FORCE})
    assert np.abs(with_it.position - moves([], 1000.0).position).max() < 1e-13


DISSIPATIVE = ["coulomb_friction", "stribeck_friction", "position_dependent_friction", "quadratic_drag", "hysteresis",
               "fading_friction", "eccentric_friction", "loose_cable", "friction_change", "rational_stribeck",
               "exponential_stribeck", "load_friction", "power_drag", "one_way_damping"]  # fmt: skip


@settings(max_examples=15, deadline=None)
@given(names=st.sets(st.sampled_from(DISSIPATIVE), min_size=1, max_size=3), start=st.floats(-0.08, 0.08),
       speed=st.floats(-1.0, 1.0))  # fmt: skip
def test_losses_never_add_energy(names, start, speed):
    spec = PLANT | {"effects": dict.fromkeys(names), "duration": 2.0, "force_time": [0.0], "force": [0.0]}
    seen = simulate(spec | {"initial_position": start, "initial_velocity": speed, "damping": 0.0}).motion
    energy = 0.5 * 0.9 * seen.velocity**2 + 0.5 * 700.0 * seen.position**2
    if "hysteresis" in names:  # gives back the part of its force that it stored elastically: at most Fh L
        energy[0] += 0.4 * 0.003
        assert energy.max() <= energy[0] * (1.0 + 1e-12)
    else:
        assert np.diff(energy).max() <= 1e-12 * energy[0]


@settings(max_examples=25, deadline=None)
@given(
    names=st.sets(st.sampled_from(sorted(effects.ALL)), max_size=4),
    cuts=st.lists(st.integers(1, 499), max_size=8, unique=True),
)
def test_steps_in_chunks_are_the_same_as_one_run(names, cuts):
    truth = Truth(**PLANT, effects={name: {} for name in names})
    times = np.arange(500) * 4e-3
    whole, pieces = Rig(truth), Rig(truth)
    whole.drive(FORCE_TIME, FORCE)
    for at, force in zip(FORCE_TIME, FORCE, strict=True):
        pieces.push(at, force)
    one = whole.sample(times).position
    many = np.concatenate([pieces.sample(part).position for part in np.split(times, sorted(cuts))])
    assert np.abs(one - many).max() < 1e-12


@pytest.mark.parametrize("swings", [100, pytest.param(1000, marks=pytest.mark.long)])
def test_a_conservative_rig_keeps_its_energy_for_many_swings(swings):
    """An error that adds up would be as large in proportion."""
    spec = PLANT | {"damping": 0.0, "duration": 0.24 * swings, "rate": 10.0, "force_time": [0.0], "force": [0.0]}
    forces = {"cubic_spring": {"cubic_stiffness": 1e5}, "backlash": {"backlash_half_width": 0.002},
              "end_stop": {"stop_position": 0.03, "stop_stiffness": 2e4}, "cogging": {"cogging_amplitude": 0.5},
              "magnet": {}}  # fmt: skip
    seen = simulate(spec | {"effects": forces, "initial_position": 0.034}).motion
    x = seen.position
    potential = (
        350.0 * np.maximum(np.abs(x) - 0.002, 0.0) ** 2 + 2.5e4 * x**4 + 1e4 * np.maximum(np.abs(x) - 0.03, 0) ** 2
    )
    potential -= 0.5 * 0.01 / (2.0 * np.pi) * np.cos(2.0 * np.pi * x / 0.01)
    potential += 1e-3 / 0.003 * np.arctan((0.04 - x) / 0.003)
    energy = 0.45 * seen.velocity**2 + potential
    assert np.ptp(energy) < 2e-12 * swings * abs(energy).max()


def test_all_smooth_effects_together_against_scipy():
    p = {"quadratic_drag": {"drag_coefficient": 2.0}, "cubic_spring": {"cubic_stiffness": 2e5},
         "asymmetric_spring": {"quadratic_stiffness": 3e3}, "force_offset": {"offset_force": 0.4},
         "cogging": {"cogging_amplitude": 0.3, "cogging_pitch": 0.012, "cogging_phase": 0.7},
         "periodic_disturbance": {"disturbance_amplitude": 0.5, "disturbance_frequency": 33.0},
         "stiffness_drift": {"stiffness_drift_rate": 0.05}, "magnet": {},
         "second_mode": {}, "creeping_spring": {}}  # fmt: skip

    def slope(t, y):
        x, v, x2, v2, c = y
        f = 5.0 - 1.5 * v - 700.0 * (1 + 0.05 * t) * x - 2.0 * v * abs(v) - 2e5 * x**3 - 3e3 * x**2 - 0.4 - c
        f -= 0.3 * np.sin(2 * np.pi * x / 0.012 + 0.7) + 0.5 * np.sin(33.0 * t)
        coupling = 800.0 * (x - x2) + 0.5 * (v - v2)
        f += 1e-3 / ((0.04 - x) ** 2 + 0.003**2) - coupling
        return [v, f / 0.9, v2, coupling / 0.2, 80.0 * v - c / 0.5]

    time = np.linspace(0.0, 1.0, 101)
    other = solve_ivp(slope, (0.0, 1.0), np.zeros(5), "DOP853", time, rtol=1e-12, atol=1e-14, max_step=1e-3)
    seen = simulate(PLANT | {"effects": p, "time": time, "force_time": [0.0], "force": [5.0]}).motion
    assert np.abs(seen.position - other.y[0]).max() < 1e-9


def test_other_laws_of_known_families_against_scipy():
    """Each alone, pushed and let go, sliding all the time: what the sign of the speed decides is smooth in between."""

    def two_sided(x, v):
        depth = abs(x) - 0.008
        return np.sign(x) * 5e3 * depth * (1.0 + np.sign(x) * v) if depth > 0.0 else 0.0

    laws = {
        "power_drag": lambda t, x, v: 2.0 * abs(v) ** 1.5 * np.sign(v),
        "one_way_damping": lambda t, x, v: max(v, 0.0),
        "drive_brake": lambda t, x, v: 2.0 * v * (t < 0.5),
        "two_slope_spring": lambda t, x, v: 200.0 * max(x - 0.005, 0.0),
        "one_sided_stop": lambda t, x, v: 5e3 * max(x - 0.008, 0.0),
        "damped_stop": lambda t, x, v: two_sided(x, v),
        "settling_stiffness": lambda t, x, v: 700.0 * 0.03 * np.exp(-t / 2.0) * x,
        "two_tone_disturbance": lambda t, x, v: 0.2 * np.sin(40.0 * t) + 0.2 * np.sin(70.0 * t),
        "rational_stribeck": lambda t, x, v: np.sign(v) * (0.12 + 0.18 / (1.0 + (v / 0.02) ** 2)),
        "exponential_stribeck": lambda t, x, v: np.sign(v) * (0.12 + 0.18 * np.exp(-abs(v) / 0.02)),
        "load_friction": lambda t, x, v: np.sign(v) * (0.05 + 0.03 * abs(700.0 * x)),
    }
    places = {"one_sided_stop": {"one_stop_position": 0.008}, "damped_stop": {"soft_stop_position": 0.008}}
    time = np.linspace(0.0, 0.9, 91)
    for name, law in laws.items():

        def slope(t, y, law=law):
            return [y[1], (6.0 * (t < 0.5) - 1.5 * y[1] - 700.0 * y[0] - law(t, *y)) / 0.9]

        parts, state = [], [0.0, 0.0]
        for begin, end in ((0.0, 0.5), (0.5, 0.9)):
            inside = np.append(time[(time >= begin) & (time < end - 1e-12)], end)
            found = solve_ivp(slope, (begin, end - 1e-12), state, "DOP853", rtol=1e-8, atol=1e-12, max_step=1e-3,
                              t_eval=np.minimum(inside, end - 1e-12))  # fmt: skip
            parts.append(found.y[0][:-1])
            state = found.y[:, -1]
        spec = {"effects": {name: places.get(name, {})}, "time": time[:-1], "force_time": [0.0, 0.5]}
        seen = simulate(PLANT | spec | {"force": [6.0, 0.0]}).motion
        assert np.abs(seen.position - np.concatenate(parts)).max() < 5e-7, name


def test_other_laws_of_actuator_and_sensor_are_as_they_say():
    soft = Truth(**PLANT, effects={"soft_saturation": {"soft_limit": 5.0}})
    assert soft.actuate(np.array([-20.0, 0.1])) == pytest.approx([-5.0 * np.tanh(4.0), 5.0 * np.tanh(0.02)])
    wheel = {"eccentricity": 1e-3, "wheel_circumference": 0.04}
    settling = {"sensor_settling": 2e-3, "sensor_settling_time": 3.0}
    seen = Truth(**PLANT, effects={"sensor_eccentricity": wheel, "settling_sensor": settling})
    read = seen.sensed(np.array([0.0, 3.0]), np.array([0.01, 0.02]))
    assert read == pytest.approx([0.011, 0.02 + 2e-3 * (1.0 - np.exp(-1.0))])
