"""One example of every effect, on one plant: what the contract tests run on. A new effect adds its line here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from msd_ident.data.record import FloatArray, Hold, Record
from msd_ident.model import Effect, Model, Plant
from msd_ident.model.effects import by_name

MASS, DAMPING, STIFFNESS = 0.9407, 3.927, 694.1

#: Parameter values that make each effect plainly visible on the plant above under 10 N.
EXAMPLES: dict[str, dict[str, float]] = {
    "actuator_lag": {"lag_time": 0.004},
    "asymmetric_spring": {"quadratic_stiffness": 4e3},
    "backlash": {"backlash_half_width": 0.002},
    "bilinear_spring": {"bend_position": 0.006, "bend_stiffness": 150.0},
    "bouc_wen": {"hysteresis_stiffness": 120.0, "loading_rate": 40.0, "unloading_rate": 250.0},
    "buffered_stop": {
        "buffer_centre": 0.001, "buffer_reach": 0.017, "buffer_stiffness": 5e3, "buffer_damping": 20.0,
    },
    "cogging": {"cogging_amplitude": 0.3, "cogging_pitch": 0.01, "cogging_phase": 0.4},
    "cogging_harmonic": {
        "cogging_amplitude": 0.3, "cogging_pitch": 0.02, "cogging_phase": 0.4, "harmonic_amplitude": 0.2,
        "harmonic_phase": 0.9,
    },
    "constraint_stop": {
        "buffer_centre": 0.001, "buffer_reach": 0.017, "buffer_stiffness": 1e3, "buffer_damping": 10.0,
        "constraint_share": 0.9,
    },
    "coulomb_friction": {"coulomb_force": 0.3},
    "cubic_spring": {"cubic_stiffness": 2e5},
    "curved_stiffness_drift": {
        "stiffness_drift_rate": 0.05, "stiffness_drift_curvature": -0.03, "stiffness_drift_turn": 0.004,
    },
    "damped_stop": {"stop_position": 0.018, "stop_stiffness": 5e3, "stop_damping": 0.8},
    "direction_dependent_damping": {"damping_difference": 1.5},
    "drive_damping": {"drive_damping": 2.0},
    "drive_hysteresis": {"remanent_force": 0.4, "crossing_force": 3.0},
    "eccentricity_harmonic": {
        "eccentricity": 1e-4, "eccentricity_pitch": 0.02, "eccentricity_phase": 0.5, "second_eccentricity": 5e-5,
        "second_eccentricity_phase": -0.7,
    },
    "end_stop": {"stop_position": 0.018, "stop_stiffness": 5e3},
    "fading_damping": {"fading_damping": 3.0, "fading_speed": 0.15, "fading_exponent": 2.0},
    "force_dead_zone": {"dead_zone": 0.6},
    "force_gain_asymmetry": {"gain_asymmetry": 0.05},
    "force_gain_nonlinearity": {"gain_slope": 0.01, "force_limit": 11.0},
    "force_offset": {"offset_force": 0.5},
    "gain_drift": {"gain_drift_rate": 0.02},
    "gravity": {"gravity_moment": 300.0},
    "frame_compliance": {"frame_compliance": 1e-4},
    "friction_drift": {"coulomb_force": 0.4, "friction_drift_rate": -0.2},
    "friction_ripple": {
        "coulomb_force": 0.3, "friction_ripple": 0.5, "friction_pitch": 0.012, "friction_phase": 0.0,
    },
    "growing_damping": {"damping_slope": 100.0, "damping_growth": 30.0},
    "hysteresis": {"hysteresis_force": 0.4, "hysteresis_length": 0.003},
    "lagging_drive_damping": {"drive_damping": 3.0, "relaxation_time": 0.02},
    "load_dependent_friction": {"coulomb_force": 0.1, "load_ratio": 0.03},
    "modulated_disturbance": {
        "disturbance_amplitude": 0.3, "disturbance_frequency": 60.0, "disturbance_phase": 0.3,
        "modulation_frequency": 8.0, "lower_sideband_amplitude": 0.1, "lower_sideband_phase": -0.4,
        "upper_sideband_amplitude": 0.15, "upper_sideband_phase": 0.9,
    },
    "one_sided_stop": {"one_stop_position": 0.018, "one_stop_stiffness": 5e3},
    "periodic_disturbance": {
        "disturbance_amplitude": 0.3, "disturbance_frequency": 60.0, "disturbance_phase": 0.3,
    },
    "position_dependent_damping": {"damping_slope": 100.0},
    "position_dependent_friction": {"coulomb_force": 0.3, "position_friction_slope": 20.0},
    "power_drag": {"drag_force": 0.5, "drag_speed": 0.4, "drag_exponent": 1.5},
    "power_spring": {"power_force": 1.5, "power_position": 0.02, "power_exponent": 2.0},
    "quadratic_drag": {"drag_coefficient": 3.0},
    "relaxing_spring": {"relaxing_damping": 4.0, "relaxation_time": 0.05},
    "rubbing_second_mode": {
        "second_mass": 0.2, "second_stiffness": 800.0, "second_damping": 0.5, "second_friction": 0.3,
        "second_creep": 0.002,
    },
    "position_dependent_gain": {"gain_gradient": 2.0, "gain_curvature": -300.0},
    "position_dependent_inertia": {"inertia_slope": 8.0},
    "scale_drift": {"scale_drift_rate": 0.02},
    "smooth_friction": {"smooth_friction": 0.4, "creep_speed": 0.02},
    "smooth_friction_turn": {"smooth_friction": 0.4, "creep_speed": 0.02, "turn_exponent": 2.0},
    "smooth_stribeck_friction": {
        "smooth_friction": 0.3, "peak_friction": 0.5, "peak_velocity": 0.03, "creep_speed": 0.003,
    },
    "second_mode": {"second_mass": 0.2, "second_stiffness": 800.0, "second_damping": 0.5},
    "sensor_eccentricity": {"eccentricity": 1e-4, "eccentricity_pitch": 0.02, "eccentricity_phase": 0.5},
    "settling_sensor": {"sensor_settling": 2e-4, "sensor_settling_time": 0.7},
    "settling_friction": {"coulomb_force": 0.2, "friction_excess": 1.5, "friction_settling_time": 0.6},
    "settling_stiffness": {"settling_ratio": 0.04, "settling_time": 0.7},
    "sensor_drift": {"sensor_drift_rate": 1e-4},
    "sensor_nonlinearity": {"sensor_curvature": 2.0, "sensor_cubic": -60.0},
    "stiffness_drift": {"stiffness_drift_rate": 0.02},
    "stribeck_shape": {
        "coulomb_force": 0.2, "static_force": 0.4, "stribeck_velocity": 0.03, "stribeck_exponent": 1.0,
    },
    "stribeck_friction": {"coulomb_force": 0.2, "static_force": 0.4, "stribeck_velocity": 0.02},
    "time_offset": {"time_offset": 0.0023},
    "two_tone_disturbance": {
        "disturbance_amplitude": 0.3, "disturbance_frequency": 60.0, "disturbance_phase": 0.0,
        "second_tone_amplitude": 0.2, "second_tone_frequency": 90.0, "second_tone_phase": 0.0,
    },
}  # fmt: skip

_SETTLED = 1.0 + EXAMPLES["settling_stiffness"]["settling_ratio"]

#: The same laws in the words of msd_sim where it has others: its effect, its parameters, and what its plant differs by.
RIG: dict[str, tuple[str, dict[str, float], dict[str, float]]] = {
    "bilinear_spring": ("two_slope_spring", EXAMPLES["bilinear_spring"], {}),
    "damped_stop": (
        "damped_stop",
        {"soft_stop_position": 0.018, "soft_stop_stiffness": 5e3, "soft_stop_damping": 0.8},
        {},
    ),
    "direction_dependent_damping": ("one_way_damping", {"up_damping": 3.0}, {"damping": DAMPING - 1.5}),
    "drive_damping": ("drive_brake", {"driven_damping": 2.0}, {}),
    "friction_ripple": (
        "eccentric_friction", {"coulomb_force": 0.3, "eccentric_ratio": 0.5, "eccentric_pitch": 0.012}, {}
    ),
    "lagging_drive_damping": ("slow_brake", {"slow_brake_damping": 3.0, "slow_brake_time": 0.02}, {}),
    "load_dependent_friction": ("load_friction", EXAMPLES["load_dependent_friction"], {}),
    "power_drag": ("power_drag", {"power_drag": 0.5 / 0.4**1.5}, {}),
    "relaxing_spring": ("creeping_spring", {"creep_stiffness": 80.0, "creep_time": 0.05}, {}),
    "settling_sensor": ("settling_sensor", EXAMPLES["settling_sensor"], {}),
    "settling_stiffness": (
        "settling_stiffness",
        {"settling_ratio": 1.0 / _SETTLED - 1.0, "settling_time": 0.7},
        {"stiffness": STIFFNESS * _SETTLED},
    ),
    "two_tone_disturbance": (
        "two_tone_disturbance",
        {
            "low_tone_amplitude": 0.3, "low_tone_frequency": 60.0,
            "high_tone_amplitude": 0.2, "high_tone_frequency": 90.0,
        },
        {},
    ),
    "stribeck_shape": (
        "exponential_stribeck", {"coulomb_force": 0.2, "static_force": 0.4, "stribeck_velocity": 0.03}, {},
    ),
}  # fmt: skip


def plant() -> Model:
    """The plant of the examples."""
    return Plant(MASS, DAMPING, STIFFNESS)


def example(name: str) -> Effect:
    """The example of one effect."""
    assert name in EXAMPLES, f"{name} has no example yet: add one to EXAMPLES"
    return by_name(name)(**EXAMPLES[name])


def model(*names: str) -> Model:
    """The plant with the examples of these effects."""
    whole = plant()
    for name in names:
        whole = whole + example(name)
    return whole


def neutral(name: str) -> Effect:
    """The example with the values that make its effect vanish."""
    effect = by_name(name)
    return effect(**{**EXAMPLES[name], **dict(effect.neutral)})


def record(rate: float = 250.0, hold: Hold = "zero", duration: float = 3.0, start: float = 0.0) -> Record:
    """Steps up, down and off, or a chirp where the force is linear between its samples."""
    time = np.arange(int(duration * rate) + 1) / rate
    if hold == "zero":
        force = np.where(time < 0.4 * duration, 10.4, np.where(time < 0.7 * duration, -6.0, 0.0))
    else:
        force = 8.0 * np.sin(2.0 * np.pi * 1.5 * time * (1.0 + time / duration))
    return Record(time=start + time, position=0.0 * time, force_time=start + time, force=force, hold=hold)


def silent(rate: float = 250.0, duration: float = 2.0) -> Record:
    """No force at all."""
    time = np.arange(int(duration * rate) + 1) / rate
    return Record(time=time, position=0.0 * time, force_time=time[:1], force=time[:1])


def followed(
    slope: Callable[[float, FloatArray], list[float]], seen: Record, *, states: int = 2, method: str = "RK45"
) -> FloatArray:
    """Positions at the samples of a record from rest at zero, by scipy from sample to sample.

    Args:
        slope: of position and velocity [m, m/s], and of further states, at a time.
        seen: the record; its force is held between samples.
        states: how many there are.
        method: of ``solve_ivp``.
    """
    state, positions = np.zeros(states), [0.0]
    for begin, end in zip(seen.time[:-1], seen.time[1:], strict=True):
        run = solve_ivp(slope, (begin, end - 1e-12), state, method=method, rtol=1e-8, atol=1e-13, max_step=2e-4)
        state = run.y[:, -1]
        positions.append(float(state[0]))
    return np.array(positions)
