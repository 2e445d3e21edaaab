"""simulate(spec): what it gives, and the one line that nonsense gets."""

from __future__ import annotations

import json

import numpy as np
import pytest

from msd_sim import config, effects, experiments
from msd_sim.api import simulate
from msd_sim.errors import RigError
from msd_sim.rig import Rig
from msd_sim.truth import Truth

PLANT = {"mass": 1.0, "damping": 2.0, "stiffness": 700.0}


def test_the_papers_experiment_on_the_papers_rig():
    seen = simulate({"rig": "ecp", "experiment": "paper"})
    assert seen.time.size == 6000 and seen.time[0] == 0.0 and seen.time[-1] == pytest.approx(5.999)
    assert seen.force_time.tolist() == [0.0, 3.0] and seen.force.tolist() == [pytest.approx(10.425), 0.0]
    assert seen.truth["effects"]["coulomb_friction"]["coulomb_force"] == pytest.approx(0.0133 * 0.9407 * 9.81)
    assert 0.0264 < seen.position.max() < 0.0266  # the printed refined model peaks at 2.649 cm
    json.dumps(seen.truth)


@pytest.mark.parametrize("name", experiments.EXPERIMENTS)
def test_every_experiment_runs(name):
    seen = simulate(PLANT | {"experiment": name, "rate": 200.0})
    assert np.isfinite(seen.position).all() and seen.time.size == seen.position.size > 100


def test_a_sweep_spans_the_frequencies_that_it_names():
    seen = simulate(PLANT | {"experiment": {"name": "sweep", "force": 1.0, "low": 0.2, "high": 2.0, "duration": 30.0}})
    crossings = seen.time[1:][np.diff(np.signbit(seen.force)) != 0]
    natural = np.sqrt(700.0)
    assert np.pi / np.diff(crossings)[0] == pytest.approx(0.2 * natural, rel=0.15)
    assert np.pi / np.diff(crossings)[-1] == pytest.approx(2.0 * natural, rel=0.05)


def test_steps_go_both_ways_at_two_sizes():
    seen = simulate(PLANT | {"experiment": {"name": "steps", "force": 10.0, "fraction": 0.3}})
    assert seen.force.tolist() == [10.0, 0.0, -10.0, 0.0, 3.0, 0.0, -3.0, 0.0]


def test_effects_add_to_a_rig_and_friction_of_their_own_replaces_its_friction():
    drag = simulate({"rig": "ecp", "effects": {"quadratic_drag": {"drag_coefficient": 3.0}}, "duration": 0.1})
    assert set(drag.truth["effects"]) == {"coulomb_friction", "quadratic_drag"}
    other = simulate({"rig": "ecp", "effects": {"stribeck_friction": {}}, "duration": 0.1})
    assert set(other.truth["effects"]) == {"stribeck_friction"}
    more = simulate({"rig": "ecp", "effects": {"coulomb_friction": {"coulomb_force": 0.2}}, "duration": 0.1})
    assert more.truth["effects"]["coulomb_friction"]["coulomb_force"] == 0.2


def test_every_rig_that_ships_runs_and_its_file_says_what_it_is():
    assert "ecp" in config.names() and len(config.names()) >= 6
    for name in config.names():
        assert np.isfinite(simulate({"rig": name, "experiment": "paper"}).position).all()


def test_a_file_in_the_form_of_ros_parameters(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(
        "/msd/rig:\n  ros__parameters:\n    mass: 2.0\n    damping: 1.0\n    stiffness: 50.0\n    effects: [backlash]\n"
        "    backlash.backlash_half_width: 0.003\n    encoder: {noise: 1.0e-5}\n    latency: 0.005\n"
    )
    truth = simulate({"rig": str(file), "duration": 0.5}).truth
    assert truth["mass"] == 2.0 and truth["effects"]["backlash"]["backlash_half_width"] == 0.003
    assert truth["encoder"]["noise"] == 1e-5


def test_time_of_ones_own_from_another_start():
    seen = simulate(PLANT | {"time": [5.0, 5.5, 7.0], "force_time": [4.0], "force": [7.0], "initial_position": 0.01})
    assert seen.time.tolist() == [5.0, 5.5, 7.0] and seen.position[0] == 0.01


NONSENSE = [
    ({"mass": 0.0}, "rig mass is 0 kg; expected 1e-09 or more: moving mass"),
    ({"mass": "heavy"}, "rig mass is 'heavy'; expected a number [kg]: moving mass"),
    ({"stiffness": 1e15}, "rig stiffness is 1e+15 N/m; expected 0 to 1e+12: spring stiffness"),
    ({"stiffness": -1e15}, "rig stiffness is -1e+15 N/m; expected 0 to 1e+12: spring stiffness"),
    ({"damping": -1.0}, "rig damping is -1 N s/m; expected 0 or more: viscous damping"),
    ({"stifness": 3.0}, "a rig has no parameter 'stifness'; expected one of mass,"),
    ({"effects": {"rubber": {}}}, "no effect 'rubber'; expected one of coulomb_friction,"),
    ({"effects": {"backlash": {"gap": 1}}}, "backlash has no parameter 'gap'; expected one of backlash_half_width"),
    ({"effects": {"backlash": {"backlash_half_width": -0.1}}}, "backlash backlash_half_width is -0.1 m; expected 0"),
    ({"effects": "backlash"}, "effects is 'backlash'; expected a list of names"),
    ({"backlash": {"backlash_half_width": 0.1}}, "backlash has parameters but is not in effects; add it"),
    (
        {"effects": {"stribeck_friction": {"coulomb_force": 0.5, "static_force": 0.2}}},
        "stribeck_friction static_force is 0.2 N, below coulomb_force 0.5 N",
    ),
    ({"effects": {"mass_drop": {"dropped_mass": 1.0}}}, "mass_drop dropped_mass is 1 kg of 1 kg; expected less"),
    (
        {"effects": {"loose_cable": {"cable_start": 0.02, "cable_end": 0.01}}},
        "loose_cable runs from 0.02 m to 0.01 m; expected cable_start below cable_end",
    ),
    ({"friction_coefficient": 0.2, "static_friction_coefficient": 0.1}, "static_friction_coefficient is 0.1, below"),
    ({"encoder": {"noise": -1.0}}, "encoder noise is -1 m; expected 0 to 1: standard deviation"),
    ({"encoder": {"nose": 1.0}}, "encoder has no parameter 'nose'; expected one of counts_per_metre,"),
    ({"rate": 0.0}, "rig rate is 0 Hz; expected 0.001 to 1e+06"),
    ({"seed": -1}, "seed is -1; expected a whole number of 0 or more"),
    ({"experiment": "kick"}, "no experiment 'kick'; expected one of paper, step,"),
    ({"experiment": {"name": "step", "fource": 2.0}}, "experiment step has no option 'fource'; expected one of force,"),
    ({"experiment": {"name": "step", "hold": -2.0}}, "experiment step: hold is -2; expected more than 0"),
    ({"experiment": {"name": "step", "force": float("nan")}}, "experiment step: force is nan; expected a finite"),
    ({"duration": -1.0}, "duration is -1.0; expected more than 0 s"),
    ({"duration": 1e9}, "1e+09 s at 1000 Hz are 1000000000000 samples; expected 1 to 50 million"),
    ({"force": [1.0]}, "force and force_time go together; expected both or neither"),
    ({"force": [1.0, 2.0], "force_time": [0.0]}, "1 force stamps for 2 forces; expected as many"),
    ({"force": [1.0, 2.0], "force_time": [0.0, 0.0], "duration": 1.0}, "force stamps do not rise"),
    ({"force": [float("inf")], "force_time": [0.0], "duration": 1.0}, "force stamps or forces that are not finite"),
    ({"force": [1.0], "force_time": [0.0], "experiment": "paper"}, "an experiment and a force; expected one of them"),
    ({"force": [1.0], "force_time": [0.0], "duration": 1.0, "hold": "cubic"}, "hold is 'cubic'; expected 'zero' or"),
    ({"time": [0.0, 0.0]}, "time does not rise; expected finite sampling instants"),
    ({"initial_position": float("nan")}, "the rig starts at nan m"),
    ({"rig": "ferrari"}, "no rig 'ferrari'; expected one of"),
    ({"rig": "no/such/file.yaml"}, "no file no/such/file.yaml; expected a rig's .yaml file, or one of"),
    (
        {"effects": {"cubic_spring": {"cubic_stiffness": -1e7}}, "experiment": {"name": "step", "force": 50.0}},
        "the motion runs away at",
    ),
    (
        {"force": [1e308], "force_time": [0.0], "duration": 1.0},
        "under commands up to 1e+308 N; expected forces that stay finite: check the commands, softening springs",
    ),
]


@pytest.mark.parametrize(("change", "words"), NONSENSE, ids=[str(change)[:60] for change, _ in NONSENSE])
def test_nonsense_gets_one_line(change, words):
    with pytest.raises(RigError) as refused:
        simulate(PLANT | change)
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_plant_must_be_whole():
    with pytest.raises(RigError, match=r"stiffness is missing; expected a number \[N/m\]"):
        simulate({"mass": 1.0, "damping": 1.0})


@pytest.mark.parametrize(
    "text",
    ["", "just words", "/**:\n  ros__parameters:\n", "/**: 3", "a: [1, 2", "identifier: {ros__parameters: {rate: 3}}"],
)
def test_files_that_are_no_rigs(tmp_path, text):
    file = tmp_path / "bad.yaml"
    file.write_text(text)
    with pytest.raises(RigError) as refused:
        simulate({"rig": str(file)})
    assert str(file) in str(refused.value) and "\n" not in str(refused.value)


def test_the_rig_refuses_to_run_backwards():
    rig = Rig(Truth(1.0, 0.0, 1.0, {}))
    rig.sample([0.5])
    with pytest.raises(RigError, match="rise from the rig's present 0.5 s on"):
        rig.sample([0.4])


def test_a_late_force_acts_at_once_and_says_so():
    rig = Rig(Truth(1.0, 0.0, 0.0, {}))
    assert rig.push(0.0, 0.0)
    rig.step_to(1.0)
    assert not rig.push(0.5, 2.0)
    assert rig.step_to(2.0).position[0] == pytest.approx(1.0)
    assert rig.command == 2.0


def test_forces_may_come_in_any_order():
    rig, ordered = Rig(Truth(1.0, 1.0, 100.0, {})), Rig(Truth(1.0, 1.0, 100.0, {}))
    for at, force in ((0.2, 3.0), (0.1, 1.0), (0.3, -2.0)):
        rig.push(at, force)
    ordered.drive([0.1, 0.2, 0.3], [1.0, 3.0, -2.0])
    times = np.linspace(0.0, 0.5, 51)
    assert np.array_equal(rig.sample(times).position, ordered.sample(times).position)


def test_restart_puts_the_cart_at_zero_under_the_same_force():
    rig = Rig(Truth(1.0, 1.0, 100.0, {"actuator_lag": {"lag_time": 0.01}}))
    rig.push(0.0, 5.0)
    rig.step_to(2.0)
    rig.restart()
    assert rig.time == 0.0 and rig.command == 5.0
    assert rig.sample([0.0, 30.0]).position == pytest.approx([0.0, 0.05], abs=1e-6)


def test_a_change_of_truth_goes_on_from_the_present_motion():
    rig = Rig(Truth(1.0, 1.0, 100.0, {}))
    rig.push(0.0, 5.0)
    before = rig.step_to(0.1)
    rig.change(Truth(2.0, 1.0, 100.0, {"coulomb_friction": {"coulomb_force": 0.1}}))
    after = rig.step_to(0.1)
    assert after.position[0] == before.position[0] and after.velocity[0] == before.velocity[0]
    assert rig.step_to(30.0).position[0] == pytest.approx(0.05, abs=1.1e-3)


def test_the_table_of_effects_names_what_the_compiled_code_has():
    from msd_sim.kernel import PARAMETERS

    slots = {p.slot for effect in effects.ALL.values() for p in effect.parameters} | {p.slot for p in effects.PLANT}
    outside = {"-", "gain_slope", "force_limit"}
    limits = {"longest_move", "longest_step"}
    assert slots - outside == set(PARAMETERS.names) - limits
