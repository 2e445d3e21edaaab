"""The solver on its own: closed forms, sticking, sampling, threads, limits."""

from __future__ import annotations

import math
import time as clock
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import hypothesis
import numpy as np
import pytest
from effect_examples import EXAMPLES, example, model, plant, record
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.record import Record, from_samples
from msd_ident.errors import UsageError
from msd_ident.model import Effect, Plant, Simulator, simulate
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.second_mode import SecondMode
from msd_ident.model.effects.stiffness_drift import StiffnessDrift
from msd_ident.model.effects.stribeck_friction import StribeckFriction


def driven(force: np.ndarray, rate: float, hold: str = "zero") -> Record:
    """A record of this force at even samples."""
    time = np.arange(force.size) / rate
    return Record(time=time, position=0.0 * time, force_time=time, force=force, hold=hold)


def free(rate: float = 1000.0, duration: float = 2.0) -> Record:
    """A record without force."""
    return driven(np.zeros(int(duration * rate) + 1), rate)


# Closed forms


def test_coulomb_ring_down_loses_the_same_every_half_cycle() -> None:
    """Without damping each half-swing is shorter by 2 Fc/k than the one before; the cart ends where friction holds."""
    mass, stiffness, friction, start = 1.0, 100.0, 0.5, 0.0432
    half = math.pi / math.sqrt(stiffness / mass)
    time = np.linspace(0.0, 12 * half, 12 * 200 + 1)
    measured = Record(time=time, position=0.0 * time, force_time=time[:1], force=time[:1])
    x = simulate(Plant(mass, 0.0, stiffness) + CoulombFriction(friction), measured, start).position
    turns = x[::200]
    expected = [start]
    while abs(expected[-1]) * stiffness > friction:
        expected.append(-math.copysign(abs(expected[-1]) - 2.0 * friction / stiffness, expected[-1]))
    expected += [expected[-1]] * (13 - len(expected))
    assert np.max(np.abs(turns - expected)) <= 1e-15
    assert np.all(x[200 * 5 :] == x[-1])


@given(
    damping=st.sampled_from([0.0, 0.5, 20.0, 2.0 * math.sqrt(694.1), 300.0]),
    stiffness=st.sampled_from([0.0, 694.1]),
    x=st.integers(-50, 50).map(lambda n: 0.001 * n),
    v=st.integers(-50, 50).map(lambda n: 0.02 * n),
    force=st.integers(-50, 50).map(lambda n: 0.2 * n),
)
def test_any_damping_and_stiffness_match_the_closed_form(
    damping: float, stiffness: float, x: float, v: float, force: float
) -> None:
    """Underdamped, critical, overdamped, without spring, without damper, neither."""
    from scipy.linalg import expm

    measured = driven(np.full(401, force), 200.0)
    ours = simulate(Plant(1.0, damping, stiffness), measured, x, v)
    generator = np.array([[0.0, 1.0, 0.0], [-stiffness, -damping, 1.0], [0.0, 0.0, 0.0]])
    for i in (1, 37, 400):
        there = expm(generator * measured.time[i]) @ (x, v, force)
        size = 1e-3 + np.abs(there[:2]).max()
        assert np.abs(ours.position[i] - there[0]) <= 1e-10 * size
        assert np.abs(ours.velocity[i] - there[1]) <= 1e-10 * size * 30.0


# Sticking


@pytest.mark.parametrize("friction", ["coulomb_friction", "stribeck_friction", "position_dependent_friction"])
def test_a_cart_below_breakaway_stays_forever(friction: str) -> None:
    hold = {"coulomb_friction": 0.3, "stribeck_friction": 0.4, "position_dependent_friction": 0.3}[friction]
    force = (hold - 1e-9) * np.sign(np.sin(np.arange(100_001) * 0.05))
    for way in ("zero", "linear"):
        moved = simulate(model(friction), driven(force, 1000.0, way))
        assert np.all(moved.position == 0.0) and np.all(moved.velocity == 0.0)


@pytest.mark.parametrize("friction", ["coulomb_friction", "stribeck_friction", "position_dependent_friction"])
def test_a_ramp_moves_it_when_it_exceeds_breakaway(friction: str) -> None:
    """A ramp of 1 N/s reaches the breakaway force between two samples; motion starts there, as jerk·t³/6 at first."""
    hold = {"coulomb_friction": 0.3, "stribeck_friction": 0.4, "position_dependent_friction": 0.3}[friction]
    whole = model(friction).with_values({"coulomb_force": hold})
    if friction == "stribeck_friction":
        whole = whole.with_values({"static_force": hold})
    time = np.arange(0.0, 1.0, 0.004) - 0.0013
    measured = Record(time=time, position=0.0 * time, force_time=np.array([-1.0, 2.0]), force=np.array([-1.0, 2.0]),
                      hold="linear")  # fmt: skip
    x = simulate(whole, measured).position
    before = (time >= -hold) & (time <= hold)
    assert np.all(x[before] == 0.0)
    late = (time > hold) & (time < hold + 0.012)
    rise = (time[late] - hold) ** 3 / 6.0 / whole["mass"]
    assert np.allclose(x[late], rise, rtol=0.05, atol=1e-12)
    assert np.count_nonzero(late) >= 3


@pytest.mark.parametrize("way", ["zero", "linear"])
@pytest.mark.parametrize("lag", [False, True])
def test_a_held_cart_stays_through_changes_of_the_force_and_leaves_where_it_must(way: str, lag: bool) -> None:
    """The general path, which a drag of no weight asks for, rests as long as the exact one and leaves with it."""
    force = np.repeat([3.0, 0.0, 0.2, -0.1, 0.2, 0.0, -3.0, -2.9, -3.1, 0.0], 500)
    whole = Plant(1.0, 20.0, 100.0) + CoulombFriction(1.5)
    whole = whole + ActuatorLag(0.01) if lag else whole
    exact, general = (simulate(one, driven(force, 500.0, way)) for one in (whole, whole + QuadraticDrag(1e-9)))
    rests = exact.velocity[1:] == 0.0
    assert np.count_nonzero(rests) > 1000 and np.count_nonzero(np.diff(rests)) >= 4
    assert np.array_equal(general.velocity[1:] == 0.0, rests)
    assert np.max(np.abs(general.position - exact.position)) <= 1e-7 * spread(exact.position)


def test_a_drifting_spring_lets_go() -> None:
    """At rest under a stretched spring that stiffens: it holds until k(1 + r t) x = Fc, and not longer."""
    whole = Plant(1.0, 1.0, 100.0) + CoulombFriction(1.05) + StiffnessDrift(0.02)
    x = simulate(whole, free(250.0, 4.0), 0.01).position
    time = np.arange(x.size) / 250.0
    assert np.all(x[time <= 2.5 - 0.004] == 0.01)
    assert np.all(x[time >= 2.6] < 0.01)


def test_a_disturbance_shakes_it_loose_only_when_strong_enough() -> None:
    whole = Plant(1.0, 1.0, 100.0) + CoulombFriction(0.5) + PeriodicDisturbance(0.499, 40.0, 0.0)
    assert np.all(simulate(whole, free(250.0), 0.0).position == 0.0)
    stronger = whole.with_values({"disturbance_amplitude": 0.501})
    assert spread(simulate(stronger, free(250.0), 0.0).position) > 0.0


def spread(values: np.ndarray) -> float:
    """Range of a signal."""
    return float(np.ptp(values))


def test_the_second_mass_shakes_the_held_one() -> None:
    """Dry friction holds the cart while the other mass swings on at its own frequency, and its pull breaks it loose."""
    whole = Plant(1.0, 1.0, 100.0) + CoulombFriction(50.0) + SecondMode(0.3, 300.0, 0.0)
    swinging = simulate(whole, free(), 0.0, 3.0)
    stuck = swinging.velocity == 0.0
    assert stuck[-1] and np.count_nonzero(stuck) > 1000
    weaker = whole.with_values({"coulomb_force": 8.0})
    assert spread(simulate(weaker, free(), 0.0, 3.0).position) > spread(swinging.position)


def test_breakaway_above_kinetic_friction_makes_stick_slip() -> None:
    """A slow ramp through Stribeck friction moves in jerks; with Fs = Fc it does not stop again."""
    ramp = driven(np.linspace(0.0, 8.0, 8001), 1000.0, "linear")
    jerky = simulate(Plant(1.0, 0.5, 300.0) + StribeckFriction(0.5, 1.5, 0.01), ramp)
    smooth = simulate(Plant(1.0, 20.0, 300.0) + StribeckFriction(0.5, 0.5, 0.01), ramp)
    stops = np.count_nonzero(np.diff((jerky.velocity == 0.0).astype(int)) == 1)
    assert stops >= 3
    assert np.count_nonzero(np.diff((smooth.velocity == 0.0).astype(int)) == 1) == 0


# Sampling


@given(seed=st.integers(0, 10_000), name=st.sampled_from([*sorted(EXAMPLES), "plant"]))
@hypothesis.example(seed=45, name="gain_drift")
def test_the_motion_does_not_depend_on_when_it_is_looked_at(seed: int, name: str) -> None:
    """The same instants from a coarse, irregular look and from a dense one."""
    random = np.random.default_rng(seed)
    whole = model(*([] if name == "plant" else [name]))
    force_time = np.sort(random.uniform(0.0, 1.0, 6))
    force = random.uniform(-9.0, 9.0, 6)
    hold = "linear" if seed % 2 else "zero"
    dense = np.linspace(0.0, 1.0, 1001)
    kept = np.concatenate([[0], np.sort(random.choice(np.arange(1, 1001), 60, replace=False))])
    ways = [
        simulate(whole, Record(time=t, position=0.0 * t, force_time=force_time, force=force, hold=hold)).position
        for t in (dense, dense[kept])
    ]
    # Where a buffer lets go is a kink that no event locates. A ramp times a drifting gain, a parabola, is a line of its
    # impulse between looks, which lie up to a tenth of the record apart here; a held force is a line anyway.
    rough = name in ("buffered_stop", "constraint_stop") or (name == "gain_drift" and hold == "linear")
    allowed = 3e-5 if rough else 1e-6
    assert np.max(np.abs(ways[0][kept] - ways[1])) <= allowed * max(spread(ways[0]), 1e-4)


@given(begin=st.floats(0.01, 1.5), gap=st.floats(0.05, 1.5), name=st.sampled_from([*sorted(EXAMPLES), "plant"]))
def test_a_gap_of_the_readings_does_not_change_the_motion(begin: float, gap: float, name: str) -> None:
    """However often the cart turns while nobody looks."""
    whole = model(*([] if name == "plant" else [name]))
    force_time, force = np.array([0.0, 0.5]), np.array([9.0, -6.0])
    dense = np.linspace(0.0, 3.0, 1501)
    kept = np.flatnonzero((dense <= begin) | (dense >= begin + gap))
    ways = [
        simulate(whole, Record(time=t, position=0.0 * t, force_time=force_time, force=force)).position
        for t in (dense, dense[kept])
    ]
    allowed = 1e-4 if name in ("buffered_stop", "constraint_stop") else 1e-5
    assert np.max(np.abs(ways[0][kept] - ways[1])) <= allowed * max(spread(ways[0]), 1e-4)


@pytest.mark.parametrize("gap", [0.155, 0.305, 0.355, 0.555, 0.655, 1.5, 10.0])
@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize(
    "effects", [(CoulombFriction(0.392),), (EndStop(4e-3, 2e4),), (CoulombFriction(0.392), ActuatorLag(0.02))]
)
def test_an_even_number_of_turns_in_a_gap_is_not_missed(gap: float, hold: str, effects: tuple[Effect, ...]) -> None:
    """The velocity has its old sign again, and the friction was against the motion all the way."""
    whole, force_time = replace(Plant(2.0, 4.0, 1200.0), effects=effects), np.array([0.0, 0.1, 0.1001])
    dense = np.linspace(0.0, 11.0, 11001)
    kept = np.flatnonzero((dense <= 0.45) | (dense >= 0.45 + gap))
    looks = [
        simulate(
            whole,
            Record(time=t, position=0.0 * t, force_time=force_time, force=np.array([0.0, 0.0, 10.0]), hold=hold),
        ).position
        for t in (dense, dense[kept])
    ]
    assert np.max(np.abs(looks[0][kept] - looks[1])) <= 1e-7


def test_a_dip_through_rest_inside_one_sample_is_not_missed() -> None:
    """A short kick back stops the cart and friction holds it for a moment: both turns lie between two samples."""
    whole = Plant(1.0, 0.0, 0.0) + CoulombFriction(1.0)
    force_time = np.array([0.0, 0.101, 0.1015, 0.102])
    force = np.array([1.5, -80.0, 80.0, 1.5])
    coarse, fine = np.arange(25) * 0.02, np.arange(5001) * 1e-4
    looks = [
        simulate(whole, Record(time=t, position=0.0 * t, force_time=force_time, force=force)).position
        for t in (coarse, fine)
    ]
    assert np.max(np.abs(looks[0] - looks[1][:4801:200])) <= 1e-14
    without = simulate(whole, Record(time=coarse, position=0.0 * coarse, force_time=force_time[:1], force=force[:1]))
    assert abs(without.position[-1] - looks[0][-1]) > 1e-4


def test_a_lag_knows_the_force_before_the_record() -> None:
    """A record cut out of a longer one goes on as the longer one did."""
    whole = model("actuator_lag").with_values({"lag_time": 0.05})
    time = np.arange(2001) / 1000.0
    force = np.where(time < 0.5, 6.0, -3.0)
    full = Record(time=time, position=0.0 * time, force_time=np.array([-1.0, 0.5]), force=np.array([6.0, -3.0]))
    whole_motion = simulate(whole, full, 0.0, 0.0)
    cut = full.window(0.3, 2.0)
    part = simulate(whole, cut, whole_motion.position[300], whole_motion.velocity[300])
    assert np.max(np.abs(part.position - whole_motion.position[300:])) <= 1e-13
    assert np.ptp(force) > 0.0


# Limits


def test_a_motion_that_runs_away_ends_as_nan_and_soon() -> None:
    whole = Plant(1.0, 0.1, 100.0) + CubicSpring(-1e6)
    began = clock.perf_counter()
    x = simulate(whole, record(1000.0), 0.05, 1.0).position
    assert np.isnan(x[-1]) and not np.isnan(x[0])
    assert clock.perf_counter() - began < 30.0


@pytest.mark.parametrize(("amplitude", "ends"), [(10.0, False), (1e3, True)])
def test_a_run_of_ever_smaller_steps_is_given_up(amplitude: float, ends: bool) -> None:
    """A thousand radians of a cogging's swing between two samples: no record shows them."""
    time = np.linspace(0.0, 1.0, 20)
    seldom = from_samples(time, np.zeros(20), np.zeros(20))
    x = simulate(Plant(1.0, 0.0, 0.0) + Cogging(amplitude, 1e-3, 0.0), seldom, 3e-4).position
    assert np.isfinite(x[0]) and np.isnan(x[-1]) == ends


@pytest.mark.parametrize("values", [{"mass": 1e-9}, {"damping": 1e9}, {"stiffness": 1e12}, {"mass": 1e12}])
@pytest.mark.parametrize("names", [(), ("coulomb_friction",), ("backlash",), ("actuator_lag",)])
def test_extreme_parameters_end_soon_and_stay_finite(values: dict[str, float], names: tuple[str, ...]) -> None:
    """What a search may try on its way: no hang on the exact path, even with odd segment lengths."""
    whole = model(*names).with_values(values)
    measured = record(250.0)
    jittered = replace(measured, time=measured.time + np.linspace(0.0, 1e-3, measured.samples) ** 1.01)
    for look in (measured, jittered):
        assert np.all(np.isfinite(simulate(whole, look, 0.001, 0.0).position))


def test_wrong_masses_give_nan_not_an_exception() -> None:
    simulator = Simulator(plant(), record())
    for wrong in ([0.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, math.nan, 1.0], [1.0, 1.0, math.inf]):
        assert np.all(np.isnan(simulator.positions(wrong)))


# Calls


def test_threads_get_the_same_numbers() -> None:
    simulators = [Simulator(model(name), record(500.0)) for name in sorted(EXAMPLES)]
    alone = [s.positions(s.model.values) for s in simulators]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda s: s.positions(s.model.values), simulators * 4))
    for i, x in enumerate(together):
        assert np.array_equal(x, alone[i % len(alone)])


def test_positions_many_says_what_shape_it_wants() -> None:
    with pytest.raises(UsageError, match=r"values have shape \(2, 7\); expected \(any, 3\)"):
        Simulator(plant(), record()).positions_many(np.ones((2, 7)), np.zeros(2), np.zeros(2))


def test_position_is_what_the_sensor_says_and_velocity_that_of_the_mass() -> None:
    drifting = simulate(model("sensor_drift"), record())
    still = simulate(plant(), record())
    assert np.allclose(drifting.position - still.position, 1e-4 * drifting.time, rtol=0.0, atol=1e-16)
    assert np.array_equal(drifting.velocity, still.velocity)


# Combinations


def test_two_dry_frictions_are_refused_in_words() -> None:
    message = (
        "coulomb_friction and stribeck_friction are both dry friction laws; expected one at most: "
        "drop coulomb_friction or stribeck_friction"
    )
    with pytest.raises(UsageError, match=message):
        plant() + example("stribeck_friction") + example("coulomb_friction")


def test_the_same_effect_twice_is_refused_in_words() -> None:
    with pytest.raises(UsageError, match="force_offset stands in the model twice; expected once"):
        plant() + ForceOffset(1.0) + ForceOffset(2.0)


def test_play_of_a_spring_that_is_not_there_is_refused_in_words() -> None:
    with pytest.raises(UsageError, match=r"backlash acts on the spring, and the plant has none \(stiffness 0\)"):
        Plant(1.0, 1.0, 0.0) + Backlash(0.001)


def test_order_of_adding_does_not_matter() -> None:
    one = plant() + example("cogging") + example("actuator_lag")
    other = plant() + example("actuator_lag") + example("cogging")
    assert one == other and one.effect_names == ("actuator_lag", "cogging")
