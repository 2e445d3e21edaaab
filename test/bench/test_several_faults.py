"""Rigs with several faults: their motion against scipy, and what a draw promises."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.several_faults import simulate
from bench.several_faults.rig import EXPERIMENTS, FAULTS, Rig, draw

#: One process compiles the simulation, which takes longer than all that it simulates.
pytestmark = pytest.mark.xdist_group("several faults")

#: Faults whose law is smooth, so that another integrator agrees to many digits.
SMOOTH = {"cubic": 4e5, "square": 3e3, "drag": 5.0, "ripple": 0.2, "pitch": 0.004, "ripple_phase": 0.3, "offset": -0.3}
#: A rig whose spring pushes it on: the first that this seed draws.
AWAY = 144
TIMED = {"aging": 0.05, "tone": 0.2, "tone_frequency": 17.0, "second_mass": 0.2, "second_stiffness": 400.0}


def rig(faults: dict[str, dict[str, float]], held: int = 250) -> Rig:
    """Steps of the force, each held for so many samples."""
    commands = np.repeat((0.0, 4.0, -3.0, 1.0), held)
    plant = {"mass": 0.8, "damping": 1.5, "stiffness": 300.0}
    return Rig(
        seed=1, plant=plant, faults=faults, experiment="steps", commands=commands, size=4.0, rate=500.0, noise=0.0,
        count=0.0,
    )  # fmt: skip


def by_scipy(made: Rig) -> np.ndarray:
    """Positions of a rig with smooth laws and a drive without faults, piece by piece of its force."""
    law, found = made.law, []
    state = np.zeros(4)

    def rates(time: float, now: np.ndarray, force: float) -> list[float]:
        x, v, y, w = now
        spring = law.stiffness * (1.0 + law.aging * time) * x + law.square * x**2 + law.cubic * x**3
        joint = law.second_stiffness * (x - y) + law.second_damping * (v - w)
        rest = force - law.offset - law.damping * v - law.drag * v * abs(v) - spring - joint
        rest += law.tone * np.sin(law.tone_frequency * time)
        rest -= law.ripple * np.sin(2.0 * np.pi * x / law.pitch + law.ripple_phase)
        return [v, rest / law.mass, w, joint / law.second_mass if law.second_mass else 0.0]

    held = made.commands.size // 4
    for piece, force in enumerate(made.commands[::held]):
        times = (held * piece + np.arange(held + 1)) / made.rate
        path = solve_ivp(rates, times[[0, -1]], state, "DOP853", times, args=(force,), rtol=1e-11, atol=1e-13).y
        found.append(path[0, :-1])
        state = path[:, -1]
    return np.concatenate(found)


@pytest.mark.parametrize("values", [{}, SMOOTH, TIMED, {**SMOOTH, **TIMED, "second_damping": 0.5}])
def test_the_motion_is_that_of_another_integrator(values: dict[str, float]) -> None:
    made = rig({"fault": values}, held=100)
    assert simulate.readings(made) == pytest.approx(by_scipy(made), abs=1e-9)


@pytest.mark.parametrize("gap", [0.0, 1e-4])
def test_the_plant_at_rest_is_that_of_a_small_step_there(gap: float) -> None:
    """A constant force moves the place of rest on a bent spring, and a bent sensor has another scale there."""
    faults = {
        "force_offset": {"offset": -0.9}, "asymmetric_spring": {"square": 1.5e4}, "cubic_spring": {"cubic": 2e6},
        "sensor_nonlinearity": {"bend": 3.0, "bow": -200.0}, "backlash": {"gap": gap},
    }  # fmt: skip
    small = 1e-3
    made = replace(rig(faults), commands=np.repeat((0.0, small), 15000))
    if gap:
        assert made.at_rest == made.plant, "a play shows the zero"
        return
    read = simulate.readings(made)
    assert made.at_rest["stiffness"] == pytest.approx(small / (read[-1] - read[14999]), rel=1e-3)
    assert abs(made.at_rest["stiffness"] / made.plant["stiffness"] - 1.0) > 0.05
    bare = replace(made, faults={name: faults[name] for name in faults if name != "sensor_nonlinearity"})
    assert bare.at_rest["mass"] == made.plant["mass"] and made.at_rest["mass"] != made.plant["mass"]
    ratio = made.at_rest["stiffness"] / made.at_rest["mass"]
    assert ratio == pytest.approx(bare.at_rest["stiffness"] / bare.at_rest["mass"]), "no sensor changes a frequency"


def test_what_holds_a_cart_is_what_it_says() -> None:
    """A constant force: inside the play nothing pushes back; behind a stop both springs do; friction takes its part."""
    long = replace(rig({}), commands=np.full(3000, 3.0), plant={"mass": 0.8, "damping": 25.0, "stiffness": 300.0})
    rest = {
        "backlash": ({"gap": 0.002}, 3.0 / 300.0 + 0.002),
        "end_stop": ({"stop": 0.004, "stop_stiffness": 700.0}, (3.0 + 700.0 * 0.004) / 1000.0),
        "one_sided": ({"stop": 0.02, "stop_stiffness": 700.0}, 0.01),
        "gain": ({"gain_slope": 0.1}, 3.0 * (1.0 + 0.1 * 3.0 / 4.0) / 300.0),
        "sensor": ({"bend": 2.0, "bow": 100.0}, 0.01 + 2.0 * 0.01**2 + 100.0 * 0.01**3),
        "drift": ({"drift": 0.001}, 0.01 + 0.001 * 2999 / 500.0),
    }
    for name, (values, place) in rest.items():
        assert simulate.readings(replace(long, faults={name: values}))[-1] == pytest.approx(place, rel=1e-6), name
    creeping = {"friction": 1.0, "creep": 1e-4, "peak": 1.5}
    stuck = simulate.readings(replace(long, commands=np.full(3000, 0.9), faults={"dry": creeping}))
    assert 0.0 < stuck[-1] < 0.9 / 300.0, "it creeps towards the spring's balance"


def test_delay_and_lag_are_of_the_drive() -> None:
    plain = simulate.readings(rig({}))
    late = simulate.readings(rig({"time_offset": {"delay": 3.0 / 500.0}}))
    assert late[3:] == pytest.approx(plain[:-3], abs=1e-12) and not late[:3].any()
    lagging = simulate.readings(rig({"actuator_lag": {"lag": 1e-9}}))
    step = round(1.0 / (500.0 * simulate.STEPS), 9)
    assert np.abs(lagging - plain).max() < 2.0 * step * np.abs(np.diff(plain)).max() * 500.0
    assert np.abs(simulate.readings(rig({"actuator_lag": {"lag": 0.01}})) - plain).max() > 1e-4


def test_one_way_damping_and_bumps_change_sign_and_place() -> None:
    """Damping that is b + d one way and b - d the other: a rig that is pushed the other way moves like one with -d."""
    there = rig({"one": {"one_way": 0.8}})
    back = replace(there, commands=-there.commands, faults={"one": {"one_way": -0.8}})
    assert simulate.readings(there) == pytest.approx(-simulate.readings(back), abs=1e-12)
    rough = {"friction": 0.3, "creep": 1e-3, "bump": 0.5, "pitch": 0.004}
    assert (
        np.abs(
            simulate.readings(rig({"rough": rough})) - simulate.readings(rig({"rough": {**rough, "bump": 0.0}}))
        ).max()
        > 1e-5
    )


def test_a_draw_is_the_same_for_the_same_seed_and_has_three_to_five_faults_that_act() -> None:
    kinds: set[str] = set()
    for seed in range(40):
        made = draw(seed, EXPERIMENTS[seed % 3])
        kinds |= set(made.faults)
        assert 3 <= len(made.faults) <= 5 and made.commands.size <= 7000
        assert sum("friction" in values for values in made.faults.values()) <= 1
        if seed < 3:
            again = draw(seed, EXPERIMENTS[seed % 3])
            assert again.faults == made.faults and np.array_equal(again.commands, made.commands)
            if not seed:
                assert np.array_equal(simulate.readings(again), simulate.readings(made))
            assert min(simulate.changes(made).values()) > 1.0
    assert kinds == set(FAULTS), "each kind comes up"


def test_a_rig_that_runs_away_says_so() -> None:
    away = replace(rig({"square": {"square": 1e6}}), seed=7)
    with pytest.raises(simulate.RunsAway, match=r"rig 7 \(square\) runs away; expected a motion that stays finite"):
        simulate.readings(away)


def test_of_a_rig_that_runs_away_another_one_is_drawn() -> None:
    with pytest.raises(simulate.RunsAway):
        simulate.readings(draw(AWAY, EXPERIMENTS[AWAY % 3]))
    found = simulate.drawn(AWAY, EXPERIMENTS[AWAY % 3])
    assert np.isfinite(simulate.readings(found)).all() and found.seed == AWAY
    assert simulate.drawn(0, "steps").faults == draw(0, "steps").faults


def test_it_shares_nothing_with_the_others() -> None:
    for path in Path(simulate.__file__).parent.glob("*.py"):
        names = [
            node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom | ast.Import)
        ]
        said = " ".join(ast.unparse(node) for node in names)
        assert "msd_ident" not in said and "msd_sim" not in said and "mujoco" not in said
