"""Every other effect against a closed form of its own."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import airy, ellipj

from msd_sim.api import simulate
from msd_sim.truth import Truth

TIME = np.arange(1001) * 2e-3
FREE = {"mass": 0.8, "damping": 0.0, "stiffness": 200.0, "time": TIME, "force_time": [0.0], "force": [0.0]}
LOOSE = FREE | {"stiffness": 0.0, "force": [2.0]}
OMEGA = math.sqrt(200.0 / 0.8)


def positions(base, effects, **more):
    return simulate(base | {"effects": effects} | more).motion.position


def test_quadratic_drag_tends_to_its_terminal_velocity():
    m, f, c = 0.8, 2.0, 3.0
    closed = m / c * np.log(np.cosh(TIME * math.sqrt(f * c) / m))
    assert np.abs(positions(LOOSE, {"quadratic_drag": {"drag_coefficient": c}}) - closed).max() < 1e-12


@pytest.mark.parametrize("cubic", [3e5, -2e4])
def test_cubic_spring_swings_as_an_elliptic_cosine(cubic):
    k, m, amplitude = 200.0, 0.8, 0.05
    stiff = k + cubic * amplitude**2
    parameter = cubic * amplitude**2 / (2.0 * stiff)
    if parameter >= 0.0:
        closed = amplitude * ellipj(math.sqrt(stiff / m) * TIME, parameter)[1]
    else:  # cn of a negative parameter, by the reciprocal transformation: cn(u|-n) = cd(u sqrt(1+n) | n/(1+n))
        n = -parameter
        _, cn, dn, _ = ellipj(math.sqrt(stiff / m * (1.0 + n)) * TIME, n / (1.0 + n))
        closed = amplitude * cn / dn
    seen = positions(FREE, {"cubic_spring": {"cubic_stiffness": cubic}}, initial_position=amplitude)
    assert np.abs(seen - closed).max() < 1e-11


def test_backlash_lets_the_cart_coast_through_the_gap():
    gap, x0 = 0.004, 0.03
    speed, quarter = OMEGA * (x0 - gap), 0.5 * math.pi / OMEGA
    phase = np.mod(TIME, 4.0 * quarter + 4.0 * gap / speed)
    half = 2.0 * quarter + 2.0 * gap / speed
    sign, t = np.where(phase < half, 1.0, -1.0), np.mod(phase, half)
    closed = sign * np.select(
        [t < quarter, t < quarter + 2.0 * gap / speed],
        [gap + (x0 - gap) * np.cos(OMEGA * t), gap - speed * (t - quarter)],
        -gap - (x0 - gap) * np.sin(OMEGA * (t - quarter - 2.0 * gap / speed)),
    )
    seen = positions(FREE, {"backlash": {"backlash_half_width": gap}}, initial_position=x0)
    assert np.abs(seen - closed).max() < 1e-12


def test_end_stop_throws_the_cart_back():
    m, k, ks, xs, v0 = 0.8, 200.0, 4e3, 0.02, 0.6
    stiff, centre = math.sqrt((k + ks) / m), ks * 0.02 / (k + ks)
    arrives = math.asin(xs * OMEGA / v0) / OMEGA
    speed = v0 * math.cos(OMEGA * arrives)
    contact = 2.0 * (math.pi / 2.0 - math.atan2(stiff * (xs - centre), speed)) / stiff
    half = 2.0 * arrives + contact
    sign, t = np.where(np.mod(TIME, 2.0 * half) < half, 1.0, -1.0), np.mod(TIME, half)
    peak, inside = math.hypot(xs - centre, speed / stiff), t - arrives - contact / 2.0
    closed = sign * np.select(
        [t < arrives, t < arrives + contact],
        [v0 / OMEGA * np.sin(OMEGA * t), centre + peak * np.cos(stiff * inside)],
        v0 / OMEGA * np.sin(OMEGA * (half - t)),
    )
    seen = positions(FREE, {"end_stop": {"stop_position": xs, "stop_stiffness": ks}}, initial_velocity=v0)
    assert np.abs(seen - closed).max() < 1e-11


def test_force_offset_moves_the_place_of_rest():
    seen = positions(FREE, {"force_offset": {"offset_force": 0.5}}, initial_position=-0.5 / 200.0)
    assert np.abs(seen + 0.5 / 200.0).max() < 1e-15


def test_actuator_lag_of_a_step_and_of_a_ramp():
    m, tau = 0.8, 0.03
    fading = np.exp(-TIME / tau)
    step = 2.0 / m * (TIME**2 / 2.0 - tau * TIME + tau**2 * (1.0 - fading))
    lag = {"actuator_lag": {"lag_time": tau}}
    assert np.abs(positions(LOOSE, lag) - step).max() < 1e-12
    ramp = 5.0 / m * (TIME**3 / 6.0 - tau * TIME**2 / 2.0 + tau**2 * TIME - tau**3 * (1.0 - fading))
    seen = positions(LOOSE, lag, force_time=[0.0, 10.0], force=[0.0, 50.0], hold="linear")
    assert np.abs(seen - ramp).max() < 1e-11


def test_a_very_short_lag_is_no_lag():
    lagged = positions(FREE, {"actuator_lag": {"lag_time": 1e-9}}, force=[3.0])
    assert np.abs(lagged - positions(FREE, {}, force=[3.0])).max() < 1e-9


@pytest.mark.parametrize("offset", [0.0123, -0.0123])
def test_time_offset_delays_the_force(offset):
    def closed(time):
        t = np.maximum(time, 0.0)
        return 3.0 / 200.0 * (1.0 - np.cos(OMEGA * t))

    begins = {"force_time": [0.1], "force": [3.0]}
    seen = positions(FREE, {"time_offset": {"time_offset": offset}}, **begins)
    assert np.abs(seen - closed(TIME - 0.1 - offset)).max() < 1e-13


def test_force_gain_and_saturation_map_the_command():
    gain = {"force_gain_nonlinearity": {"gain_slope": 0.05, "force_limit": 4.0}}
    for command, made in ((2.0, 2.2), (-2.0, -2.2), (3.5, 4.0), (-30.0, -4.0)):
        assert np.array_equal(positions(FREE, gain, force=[command]), positions(FREE, {}, force=[made]))


def test_hysteresis_takes_its_work_out_of_the_first_stroke():
    m, f, fh, length = 0.8, 2.0, 0.5, 0.01
    effects = {"hysteresis": {"hysteresis_force": fh, "hysteresis_length": length}}
    motion = simulate(LOOSE | {"effects": effects}).motion
    work = f * motion.position - fh * (motion.position - length * (1.0 - np.exp(-motion.position / length)))
    assert np.abs(0.5 * m * motion.velocity**2 - work).max() < 1e-11


def test_hysteresis_of_a_short_length_is_dry_friction():
    short = positions(FREE, {"hysteresis": {"hysteresis_force": 0.3, "hysteresis_length": 1e-8}}, initial_position=0.05)
    dry = positions(FREE, {"coulomb_friction": {"coulomb_force": 0.3}}, initial_position=0.05)
    assert np.abs(short - dry).max() < 5e-5


def test_periodic_disturbance_forces_the_plant():
    m, k, a, w, phase = 0.8, 200.0, 0.4, 37.0, 0.6
    gain = -a / (k - m * w * w)
    closed = gain * (
        np.sin(w * TIME + phase) - math.sin(phase) * np.cos(OMEGA * TIME)
        - w / OMEGA * math.cos(phase) * np.sin(OMEGA * TIME)
    )  # fmt: skip
    effect = {"disturbance_amplitude": a, "disturbance_frequency": w, "disturbance_phase": phase}
    assert np.abs(positions(FREE, {"periodic_disturbance": effect}) - closed).max() < 1e-12


def test_stiffness_drift_swings_as_airy_functions():
    m, k, r, x0 = 0.8, 200.0, 0.3, 0.04
    scale = (k * r / m) ** (1.0 / 3.0)

    def basis(time):
        ai, ai_slope, bi, bi_slope = airy(-scale * (time + 1.0 / r))
        return ai, -scale * ai_slope, bi, -scale * bi_slope

    a0, da0, b0, db0 = basis(0.0)
    one, two = np.linalg.solve([[a0, b0], [da0, db0]], [x0, 0.0])
    a, _, b, _ = basis(TIME)
    seen = positions(FREE, {"stiffness_drift": {"stiffness_drift_rate": r}}, initial_position=x0)
    assert np.abs(seen - (one * a + two * b)).max() < 1e-11


def test_second_mode_against_the_matrix_exponential():
    m, b, k, m2, k2, b2, f = 0.8, 1.0, 200.0, 0.3, 500.0, 0.7, 2.0
    a = np.array([[0, 1, 0, 0], [-(k + k2) / m, -(b + b2) / m, k2 / m, b2 / m], [0, 0, 0, 1],
                  [k2 / m2, b2 / m2, -k2 / m2, -b2 / m2]])  # fmt: skip
    rest = np.linalg.solve(a, [0, -f / m, 0, 0])
    begin = np.array([0.01, 0.2, 0.01, 0.2])
    closed = [rest[0] + (expm(a * t) @ (begin - rest))[0] for t in TIME[::50]]
    effect = {"second_mass": m2, "second_stiffness": k2, "second_damping": b2}
    seen = positions(FREE, {"second_mode": effect}, damping=b, force=[f], initial_position=0.01, initial_velocity=0.2)
    assert np.abs(seen[::50] - closed).max() < 1e-12


def test_creeping_spring_against_the_matrix_exponential():
    m, k, kc, relax = 0.8, 200.0, 80.0, 0.3
    a = np.array([[0, 1, 0], [-k / m, 0, -1 / m], [0, kc, -1 / relax]])
    closed = [(expm(a * t) @ [0.03, 0, 0])[0] for t in TIME[::50]]
    effect = {"creep_stiffness": kc, "creep_time": relax}
    seen = positions(FREE, {"creeping_spring": effect}, initial_position=0.03)
    assert np.abs(seen[::50] - closed).max() < 1e-12


def test_a_load_that_drops_at_its_turning_point_only_changes_the_pace():
    drop = math.pi / OMEGA
    faster = math.sqrt(200.0 / 0.5)
    closed = 0.03 * np.where(drop > TIME, np.cos(OMEGA * TIME), -np.cos(faster * (TIME - drop)))
    seen = positions(FREE, {"mass_drop": {"dropped_mass": 0.3, "drop_time": drop}}, initial_position=0.03)
    assert np.abs(seen - closed).max() < 1e-12


def test_fading_friction_loses_momentum():
    m, fc, relax, v0 = 0.8, 0.5, 0.4, 2.0
    effect = {"coulomb_force": fc, "fading_time": relax}
    seen = positions(LOOSE, {"fading_friction": effect}, force=[0.0], initial_velocity=v0)
    closed = v0 * TIME - fc * relax / m * (TIME - relax * (1.0 - np.exp(-TIME / relax)))
    assert np.abs(seen - closed).max() < 1e-12


def test_friction_change_stops_a_sliding_cart_sooner():
    v0 = 1.0
    effect = {"coulomb_force": 0.2, "later_coulomb_force": 1.6, "change_time": 0.5}
    seen = positions(LOOSE, {"friction_change": effect}, force=[0.0], initial_velocity=v0)
    first = v0 * TIME - 0.125 * TIME**2
    speed, t = v0 - 0.125, np.clip(TIME - 0.5, 0.0, (v0 - 0.125) / 2.0)
    later = v0 * 0.5 - 0.125 * 0.25 + speed * t - t**2
    assert np.abs(seen - np.where(TIME < 0.5, first, later)).max() < 1e-13


def test_loose_cable_drags_on_the_way_up_inside_its_window_alone():
    m, c, low, high, v0 = 0.8, 4.0, 0.1, 0.3, 1.5
    effect = {"cable_damping": c, "cable_start": low, "cable_end": high}
    up = positions(LOOSE, {"loose_cable": effect}, force=[0.0], initial_velocity=v0)
    enter, rate = low / v0, c / m
    leave = enter - math.log(1.0 - (high - low) * rate / v0) / rate
    dragged = low + v0 / rate * (1.0 - np.exp(-rate * (TIME - enter)))
    after = high + v0 * math.exp(-rate * (leave - enter)) * (TIME - leave)
    closed = np.select([enter > TIME, leave > TIME], [v0 * TIME, dragged], after)
    assert np.abs(up - closed).max() < 1e-12
    down = positions(LOOSE, {"loose_cable": effect}, force=[0.0], initial_position=0.4, initial_velocity=-v0)
    assert np.abs(down - (0.4 - v0 * TIME)).max() < 1e-12


def test_sensor_drift_and_slip_are_in_the_reading_alone():
    effects = {
        "sensor_drift": {"sensor_drift_rate": 1e-3},
        "encoder_slip": {"slip_distance": 0.002, "slip_time": 1.0},
    }
    seen = simulate(FREE | {"effects": effects, "force": [1.0]})
    added = 1e-3 * TIME + np.where(TIME >= 1.0, 0.002, 0.0)
    assert np.array_equal(seen.motion.position, positions(FREE, {}, force=[1.0]))
    assert np.abs(seen.position - seen.motion.position - added).max() < 1e-16


def test_coarse_actuator_makes_whole_steps():
    made = Truth(1.0, 0.0, 1.0, {"coarse_actuator": {"force_step": 0.5}}).actuate(np.array([0.2, 0.3, -1.1]))
    assert made.tolist() == [0.0, 0.5, -1.0]


def test_linear_hold_joins_the_commands_by_straight_lines():
    # triangle of force on a free mass: x'' = F/m, exact cubic pieces
    seen = positions(LOOSE, {}, force_time=[0.5, 1.0, 1.5], force=[0.0, 4.0, 0.0], hold="linear")
    t1, t2, t3 = (np.maximum(TIME - at, 0.0) for at in (0.5, 1.0, 1.5))
    closed = (8.0 * t1**3 - 16.0 * t2**3 + 8.0 * t3**3) / 6.0 / 0.8
    assert np.abs(seen - closed).max() < 1e-12
