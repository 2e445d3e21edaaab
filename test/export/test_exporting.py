"""From a saved result to a file with proof: nearest parameters, steps, scale, draws, robots, refusals."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import effect_examples
import numpy as np
import pytest
import yaml
from exportrigs import NOISE, measured, result, saved
from rich.console import Console

from msd_ident.data.record import Record
from msd_ident.errors import DataError, UsageError
from msd_ident.export import Export, Options, export, into, target
from msd_ident.export import robot as robots
from msd_ident.export.mujoco_replay import averages
from msd_ident.export.plan import force_power, scaled
from msd_ident.model import Model, Plant, Simulator
from msd_ident.report import export as tables
from msd_ident.workflow.saved_model import from_json_dict

ROBOT = """<mujoco><worldbody><body><joint name="cart" type="slide" axis="1 0 0"/><geom size=".02" mass="0.4"/>
<body><joint name="elbow" type="hinge" axis="0 1 0"/><geom size=".02" mass="1e-6"/></body></body>
<body pos="0 9 0"><freejoint name="ball"/><geom size=".02"/></body></worldbody></mujoco>"""


def rig(*names: str) -> tuple[Model, Record]:
    """A model and what was measured of it."""
    model = effect_examples.model(*names)
    return model, measured(model, effect_examples.record(1000.0, duration=1.5))


def made(name: str, folder: Path, *names: str, **options: object) -> Export:
    """A rig exported and replayed."""
    model, record = rig(*names)
    chosen = target(name)
    return export(saved(model), chosen, folder / f"rig{chosen.suffixes[0]}", Options(**options), (record,))  # type: ignore[arg-type]


def test_replay_proves_what_is_exact(tmp_path: Path) -> None:
    found = made("mujoco", tmp_path, "coulomb_friction", "quadratic_drag")
    assert found.proof is not None and found.nearest is None
    assert found.proof.ratio == pytest.approx(1.0, abs=0.02)
    assert found.proof.see("base") > 5.0 * found.proof.see("target")
    assert found.proof.see("ours") == pytest.approx(NOISE, rel=0.1)
    assert f"{found.proof.ratio:.3f} times what it leaves here" in found.sentence
    header = found.out.read_text(encoding="utf-8")
    assert "quadratic drag: exact: second coefficient of damping" in header


def test_steps_are_made_finer_where_the_noise_shows_them(tmp_path: Path) -> None:
    coarse = made("mujoco-xml", tmp_path, "coulomb_friction", steps=1)
    model, record = rig("coulomb_friction")
    quiet = replace(saved(model), noise_floor=NOISE / 30.0)
    fine = export(quiet, target("mujoco-xml"), tmp_path / "fine.xml", Options(), (record,))
    assert coarse.plan.steps == 1 and fine.plan.steps > 4
    assert coarse.proof is not None and fine.proof is not None
    assert fine.proof.distance < 0.2 * coarse.proof.distance


def test_the_callback_needs_no_finer_steps(tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    quiet = replace(saved(model), noise_floor=NOISE / 30.0)
    found = export(quiet, target("mujoco"), tmp_path / "rig.xml", Options(), (record,))
    assert found.plan.steps == 1 and found.proof is not None
    assert found.proof.distance < NOISE / 150.0


def test_a_stiff_law_gets_steps_that_carry_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ripple of a tenth of a millimetre, sampled at 100 Hz: one step a sample would blow up."""
    monkeypatch.chdir(tmp_path)
    model = effect_examples.plant() + effect_examples.by_name("hysteresis")(0.5, 1e-5)
    record = measured(model, effect_examples.record(100.0, duration=3.0))
    for name in ("mujoco", "python"):
        out = tmp_path / f"rig{target(name).suffixes[0]}"
        found = export(replace(saved(model), rate=100.0), target(name), out, Options(), (record,))
        assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.1), name
    coarse = export(saved(model), target("mujoco"), tmp_path / "coarse.xml", Options(steps=1), (record,))
    assert coarse.proof is not None and not coarse.proof.ratio < 2.0
    assert "blows up at steps of 0.01 s: give more --steps" in coarse.sentence
    assert not list(tmp_path.glob("MUJOCO_LOG*"))


@pytest.mark.parametrize("effect", ["hysteresis", "stribeck_friction", "cogging", "stiffness_drift"])
def test_predicted_cost_is_the_replayed_one(effect: str, tmp_path: Path) -> None:
    found = made("mujoco-xml", tmp_path, effect)
    assert found.proof is not None and found.nearest is not None and found.nearest.see is not None
    assert found.proof.see("target") == pytest.approx(found.nearest.see, rel=0.05)
    assert found.proof.see("ours") < found.proof.see("target") < 1.02 * found.proof.see("base")
    assert f"without {effect.replace('_', ' ').replace('stribeck', 'Stribeck')}; " in found.nearest.sentence
    assert "Predicted cost: it leaves" in found.out.read_text(encoding="utf-8")


def test_without_a_record_nothing_is_dropped_in_silence(tmp_path: Path) -> None:
    found = export(saved(rig("hysteresis")[0]), target("sdf"), tmp_path / "rig.sdf")
    text = found.out.read_text(encoding="utf-8")
    assert "without hysteresis; nothing was fitted in their place" in " ".join(text.split())
    assert found.proof is None and "gz sim" in found.sentence


def test_formats_of_gazebo_say_the_joint(tmp_path: Path) -> None:
    effects = [effect_examples.example(name) for name in ("coulomb_friction", "force_offset")]
    model = Plant(0.9, 4.0, 700.0) + effects[0] + effects[1]
    for name in ("sdf", "urdf"):
        out = tmp_path / f"rig.{name}"
        export(saved(model), target(name), out, Options(joint="cart"))
        root = ElementTree.parse(out).getroot()
        joint = next(one for one in root.iter("joint") if one.get("name") == "cart" and one.get("type") == "prismatic")
        if name == "sdf":
            told = {key: float(str(joint.findtext(f"axis/dynamics/{key}"))) for key in ("damping", "friction")}
            assert float(str(joint.findtext("axis/dynamics/spring_reference"))) == pytest.approx(-0.5 / 700.0)
            assert float(str(joint.findtext("axis/dynamics/spring_stiffness"))) == 700.0
        else:
            dynamics = joint.find("dynamics")
            assert dynamics is not None
            told = {key: float(str(dynamics.get(key))) for key in ("damping", "friction")}
        assert told == {"damping": 4.0, "friction": 0.3}


def test_mujoco_reads_our_urdf(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = Plant(0.9, 4.0, 0.0) + effect_examples.example("coulomb_friction")
    export(saved(model), target("urdf"), tmp_path / "rig.urdf")
    read = mujoco.MjModel.from_xml_path(str(tmp_path / "rig.urdf"))
    assert (read.dof_damping[0], read.dof_frictionloss[0]) == (4.0, 0.3)


def test_gains_of_a_feedforward(tmp_path: Path) -> None:
    model = effect_examples.model("coulomb_friction", "force_offset")
    export(saved(model), target("gains"), tmp_path / "gains.yaml", Options(joint="cart"))
    told = yaml.safe_load((tmp_path / "gains.yaml").read_text())["/**"]["ros__parameters"]["feedforward"]["cart"]
    assert told == {"kS": 0.3, "kV": 3.927, "kA": 0.9407, "kG": 0.5, "kP": 694.1, "zero": 0.0}


@pytest.mark.parametrize(
    ("position", "units"),
    [
        ("m", {"mass": "kg", "damping": "N·s/m", "stiffness": "N/m", "coulomb_force": "N", "lag_time": "s"}),
        ("rad", {"mass": "kg·m²", "damping": "N·m·s/rad", "stiffness": "N·m/rad", "coulomb_force": "N·m"}),
    ],
)
def test_a_mass_gives_the_header_its_units(position: str, units: dict[str, str], tmp_path: Path) -> None:
    model = effect_examples.model("coulomb_friction", "actuator_lag")
    told = result(model, unit="V", position=position)
    volts = {
        "mass": f"V·s²/{position}",
        "damping": f"V·s/{position}",
        "stiffness": f"V/{position}",
        "coulomb_force": "V",
    }
    for name, own in told["extended"]["parameters"].items():
        own["unit"] = volts.get(name, own["unit"])
    export(from_json_dict(told), target("gains"), tmp_path / "gains.yaml", Options(mass=2.0 * model.mass))
    lines = (tmp_path / "gains.yaml").read_text(encoding="utf-8").splitlines()
    shown = {words[1]: words for words in map(str.split, lines) if words[3:4] == ["+-"]}
    assert {name: shown[name][5] for name in units} == units
    assert float(shown["mass"][2]) == pytest.approx(2.0 * model.mass)
    assert float(shown["mass"][4]) == pytest.approx(1.96 * 0.001 * 2.0 * model.mass, rel=0.05)


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_draws_are_correlated_and_share_the_explanations(ending: str, tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    told = saved(model, rivals=[{"causes": ["quadratic_drag"], "probability": 0.25, "noise_floors": 1.0}])
    export(told, target("draws"), tmp_path / f"draws.{ending}", Options(draws=4000), (record,))
    if ending == "npz":
        columns = dict(np.load(tmp_path / "draws.npz"))
    else:
        lines = (tmp_path / "draws.csv").read_text().splitlines()
        names, *rows = [line.split(",") for line in lines if not line.startswith("#")]
        columns = {name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}
        columns = {name: c if name == "explanation" else c.astype(float) for name, c in columns.items()}
    own = columns["explanation"] == "coulomb_friction"
    assert float(np.mean(own)) == pytest.approx(0.75, abs=0.03)
    assert np.all(columns["coulomb_force"][~own] == 0.0) and np.all(columns["drag_coefficient"][own] == 0.0)
    assert np.corrcoef(columns["mass"][own], columns["stiffness"][own])[0, 1] > 0.3
    assert np.corrcoef(columns["damping"][own], columns["coulomb_force"][own])[0, 1] < -0.3
    assert float(np.mean(columns["stiffness"][own])) == pytest.approx(694.1, rel=1e-3)


def known(name: str, value: float, std: object = 0.0) -> dict[str, object]:
    """A known parameter in the JSON of an identification."""
    return {"name": name, "value": value, "std": std, "unit": "a unit"}


def test_draws_follow_what_was_known(tmp_path: Path) -> None:
    """The known spring has the standard deviation that was given; the fitted values follow it, their ratios do not."""
    model, record = rig("coulomb_friction")
    told = saved(model, known=[known("stiffness", model.stiffness, 7.0)])
    drawn = export(told, target("draws"), tmp_path / "draws.csv", Options(draws=2000), (record,)).plan.draws
    free = export(saved(model), target("draws"), tmp_path / "free.csv", Options(draws=2000), (record,)).plan.draws
    assert drawn is not None and free is not None and drawn.names == free.names
    mass, spring = (drawn.values[:, drawn.names.index(name)] for name in ("mass", "stiffness"))
    assert float(np.mean(spring)) == pytest.approx(model.stiffness, rel=1e-3)
    assert float(np.std(spring)) == pytest.approx(7.0, rel=0.05)
    assert np.corrcoef(spring, mass)[0, 1] > 0.99
    assert float(np.std(free.values[:, free.names.index("stiffness")])) < 0.7
    assert float(np.std(spring / mass)) < 0.1 * 7.0 / model.mass


def test_draws_of_a_decay_have_the_scale_that_was_weighed(tmp_path: Path) -> None:
    model = Plant(2.0, 4.0, 1200.0)
    force = effect_examples.record(200.0, duration=3.0)
    pulled = Simulator(model, replace(force, force=0.0 * force.force)).positions(model.values, 0.05)
    record = replace(force, force=0.0 * force.force, position=pulled + NOISE * np.sin(np.arange(pulled.size) ** 2))
    drawn = []
    for std in (0.0, 0.02):
        told = saved(model, known=[known("mass", 2.0, std)])
        drawn.append(export(told, target("draws"), tmp_path / "d.csv", Options(draws=2000), (record,)).plan.draws)
    exact, weighed = (dict(zip(one.names, one.values.T, strict=True)) for one in drawn if one is not None)
    assert set(exact["mass"]) == {2.0}
    for name in ("mass", "stiffness"):
        assert float(np.std(weighed[name]) / np.mean(weighed[name])) == pytest.approx(0.01, rel=0.05), name
    assert float(np.std(exact["stiffness"])) < 1.0


def test_what_was_known_is_kept_where_a_law_is_replaced(tmp_path: Path) -> None:
    model, record = rig("hysteresis")
    told = saved(model, known=[known("stiffness", 1.02 * model.stiffness, 5.0)])
    found = export(told, target("sdf"), tmp_path / "rig.sdf", Options(), (record,))
    assert found.nearest is not None and found.nearest.model.stiffness == 1.02 * model.stiffness


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"name": "mass", "value": 2.0}, "cannot be read ('std'); expected name, value and std of each: renew"),
        (known("mass", 2.0, None), "cannot be read (float() argument must be a string or a real number"),
        (known("mass", -2.0), "cannot be read (mass is -2 kg; expected a finite value above 0: correct"),
        (known("weight", 2.0), "cannot be read (no parameter is called 'weight'; expected one of mass"),
    ],
)
def test_known_parameters_that_cannot_be_read(told: dict[str, object], words: str, tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    with pytest.raises(DataError) as caught:
        export(saved(model, known=[told]), target("draws"), tmp_path / "draws.csv", Options(), (record,))
    assert words in str(caught.value)


def test_a_mass_gives_newtons() -> None:
    model = effect_examples.model("coulomb_friction", "force_gain_nonlinearity")
    twice, factor = scaled(saved(model), 2.0 * model.mass)
    assert factor == pytest.approx(2.0)
    for name, power in (("stiffness", 1), ("coulomb_force", 1), ("gain_slope", -1), ("force_limit", 1)):
        assert twice[name] == pytest.approx(2.0**power * model[name])
    assert [force_power(unit) for unit in ("N·s²/m²", "1/N", "m/s", "kg", "N/m", "1")] == [1, -1, 0, 1, 1, 0]


def test_volts_move_alike_with_and_without_a_mass(tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    volts = replace(record, force_unit="V")
    for mass in (None, 3.0):
        found = export(saved(model, unit="V"), target("mujoco"), tmp_path / "rig.xml", Options(mass=mass), (volts,))
        assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.02)
    assert 'mass="3.0"' in (tmp_path / "rig.xml").read_text()


def test_draws_of_volts_are_in_newtons_with_a_mass(tmp_path: Path) -> None:
    """The rows scale as the header does: masses and forces with the mass, gains against it, times not."""
    model, record = rig("coulomb_friction", "force_gain_nonlinearity", "actuator_lag")
    volts = replace(record, force_unit="V")
    plans = [
        export(
            saved(model, unit="V"), target("draws"), tmp_path / "draws.csv", Options(mass=mass, draws=3), (volts,)
        ).plan
        for mass in (None, 2.0 * model.mass)
    ]
    (volt, newton) = (plan.draws for plan in plans)
    assert volt is not None and newton is not None
    for name, ratio in (("mass", 2.0), ("coulomb_force", 2.0), ("gain_slope", 0.5), ("lag_time", 1.0)):
        i = volt.names.index(name)
        assert newton.values[:, i] == pytest.approx(ratio * volt.values[:, i]), name
        assert plans[1].value(name) == pytest.approx(ratio * plans[0].value(name)), name
    row = (tmp_path / "draws.csv").read_text().splitlines()[-1]
    assert float(row.split(",")[0]) == newton.values[-1, 0]


def test_a_turned_force_is_turned_back(tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    turned = replace(record, force=-record.force)
    for name in ("mujoco", "python", "python-msd"):
        out = tmp_path / f"rig{target(name).suffixes[0]}"
        found = export(saved(model, force_sign=-1), target(name), out, Options(), (turned,))
        assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.02), name


def test_a_format_without_an_actuator_says_that_the_force_is_to_be_turned(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model, _ = rig("coulomb_friction")
    for name in ("sdf", "urdf", "gains", "mujoco-xml"):
        out = tmp_path / f"rig{target(name).suffixes[0]}"
        tables.print_export(export(saved(model, force_sign=-1), target(name), out), Console(width=200))
        told = " ".join(out.read_text(encoding="utf-8").split())
        inverted = name in ("gains", "mujoco-xml")
        assert ("the force of the actuator is inverted" in told) == inverted
        for text in (told, capsys.readouterr().out):
            assert ("nothing here inverts it: apply minus the force" in text) == (not inverted)
    export(saved(model), target("sdf"), tmp_path / "same.sdf")
    assert "downwards" not in (tmp_path / "same.sdf").read_text(encoding="utf-8")


def test_uneven_samples_are_replayed_at_their_own_instants(tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    rng = np.random.default_rng(3)
    keep = np.sort(rng.permutation(record.samples)[: int(0.9 * record.samples)])
    gaps = replace(record, time=record.time[keep], position=record.position[keep])
    found = export(saved(model), target("mujoco"), tmp_path / "rig.xml", Options(), (gaps,))
    assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.03)


def test_impulse_of_a_force_is_kept() -> None:
    time = np.arange(50) * 0.01
    record = Record(time, 0.0 * time, np.array([0.003, 0.1277]), np.array([2.0, -1.0]))
    impulse = float(np.sum(averages(record, 3)) * 0.01 / 3.0)
    assert impulse == pytest.approx(2.0 * (0.1277 - 0.003) - (0.49 - 0.1277))


@pytest.mark.parametrize("before", ["", 'armature="0.3"'])
def test_into_a_robot(before: str, tmp_path: Path) -> None:
    """The bodies' inertia and the new armature are the identified mass, whatever armature the joint had."""
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT.replace('name="cart"', f'name="cart" {before}', 1))
    model, record = rig("coulomb_friction", "actuator_lag")
    out = tmp_path / "mine.xml"
    found = export(saved(model), into(robot, "mujoco"), out, Options(joint="cart"), (record,))
    assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.02)
    joint = next(one for one in ElementTree.parse(out).getroot().iter("joint") if one.get("name") == "cart")
    assert float(str(joint.get("armature"))) == pytest.approx(0.9407 - 0.4, rel=1e-3)
    assert len(list(ElementTree.parse(out).getroot().iter("body"))) == 3


def test_a_hinge_in_degrees(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = tmp_path / "robot.xml"
    robot.write_text(
        '<mujoco><worldbody><body><joint name="arm" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .1 0 0" '
        'size=".01" mass="0.1"/></body></worldbody></mujoco>'
    )
    model = Plant(0.01, 0.02, 1.5) + effect_examples.by_name("end_stop")(0.5, 20.0)
    told = saved(model, unit="N·m", position="rad")
    export(told, into(robot, "mujoco"), tmp_path / "arm.xml", Options(joint="arm"))
    read = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    assert read.jnt_range[0] == pytest.approx([-0.5, 0.5]) and read.jnt_stiffness[0] == 1.5


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        ("wrist", "has no joint 'wrist'; expected one of its joints: cart, elbow, ball"),
        ("ball", "joint ball of {robot} has 6 degrees of freedom (free); expected a slide or a hinge"),
        (
            "elbow",
            "between the world and joint elbow of {robot} there are further degrees of freedom (cart); expected none",
        ),
    ],
)
def test_a_joint_that_is_not_meant(joint: str, words: str, tmp_path: Path) -> None:
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT)
    with pytest.raises(UsageError) as caught:
        export(saved(rig()[0]), into(robot, "mujoco"), tmp_path / "out.xml", Options(joint=joint))
    assert words.format(robot=robot) in str(caught.value)
    assert not (tmp_path / "out.xml").exists()


@pytest.mark.parametrize(
    ("defaults", "body", "own"),
    [
        ('<default class="rail"><joint type="slide"/></default>', 'childclass="rail"', ""),
        ('<default class="rail"><joint type="slide"/><default class="fine"><joint damping="1"/></default></default>',
         "", 'class="fine"'),
        ('<joint type="slide"/><default class="fine"><geom rgba="1 0 0 1"/></default>', 'childclass="fine"', ""),
        ('<joint type="slide"/><default class="arm"><joint type="hinge"/></default>', 'childclass="arm"',
         'class="main"'),
    ],
)  # fmt: skip
def test_a_joint_is_what_its_default_classes_make_it(defaults: str, body: str, own: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    path = tmp_path / "robot.xml"
    path.write_text(
        f"<mujoco><default>{defaults}</default><worldbody><body {body}><frame><body>"
        f'<joint name="cart" {own}/><geom size=".02"/></body></frame></body></worldbody></mujoco>'
    )
    tree = robots.parsed(path)
    assert robots.joint(tree, path, "cart", "m").get("name") == "cart"
    with pytest.raises(UsageError, match="joint cart of .* is a slide, which moves in m, and positions are in rad"):
        robots.joint(tree, path, "cart", "rad")


#: More draws than are made.
MANY = Options(draws=1_000_001)


def test_other_refusals(tmp_path: Path) -> None:
    model, record = rig("coulomb_friction")
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT)
    assumed = result(Plant(1.0, 0.4, 170.0))
    assumed["extended"]["parameters"]["mass"]["std"] = 0.0
    ratios = from_json_dict(assumed)
    turning = saved(model, position="rad", unit="N·m")
    heavy = saved(Plant(0.3, 3.9, 694.0))
    cases = [
        (lambda: export(saved(model, position="count"), target("mujoco"), tmp_path / "a.xml"), "are in count"),
        (lambda: export(ratios, target("sdf"), tmp_path / "a.sdf"), "(its mass of 1 kg is assumed); expected"),
        (lambda: export(ratios, target("gains"), tmp_path / "a.yaml"), "export to mujoco, mujoco-xml, python"),
        (lambda: export(saved(model, unit="V"), target("urdf"), tmp_path / "a.urdf"), "are in V; expected a force"),
        (lambda: export(saved(model), target("mujoco"), tmp_path / "a.sdf"), "expected a name that ends in .xml"),
        (lambda: export(saved(model), target("python"), tmp_path / "a-b.py"), "a name that Python can import"),
        (lambda: export(saved(model), target("python"), tmp_path / "json.py"), "a name of its own, e.g. --out rig.py:"),
        (lambda: export(saved(model), target("python-msd"), tmp_path / "numpy.py"), "the place of Python's numpy"),
        (lambda: export(saved(model), target("draws"), tmp_path / "a.csv"), "draws need the record"),
        (lambda: export(saved(model), target("draws"), tmp_path / "a.csv", Options(draws=0)), "expected at least 1"),
        (
            lambda: export(saved(model), target("draws"), tmp_path / "a.csv", MANY),
            "expected at most 1000000, whose file",
        ),
        (lambda: export(saved(model), target("mujoco"), tmp_path / "a.xml", Options(mass=1.0)), "has newtons already"),
        (lambda: export(ratios, target("sdf"), tmp_path / "a.sdf", Options(mass=-1.0)), "mass is -1; expected more"),
        (lambda: export(turning, into(robot, "mujoco"), tmp_path / "a.xml", Options("cart")), "a slide, which moves"),
        (lambda: export(heavy, into(robot, "mujoco"), tmp_path / "a.xml", Options("cart")), "have 0.4 kg, more than"),
        (lambda: into(robot, "sdf"), "--into with --to sdf; expected --to mujoco"),
        (lambda: target("unity"), "no target is called 'unity'; expected one of mujoco, mujoco-xml"),
    ]
    for call, words in cases:
        with pytest.raises(UsageError) as caught:
            call()
        assert words in str(caught.value)
    with pytest.raises(UsageError, match="is in N and rad; expected N and m"):
        export(saved(model), target("mujoco"), tmp_path / "a.xml", Options(), (replace(record, position_unit="rad"),))
    (tmp_path / "no.xml").write_text("<robot/>")
    with pytest.raises(DataError, match="holds <robot>; expected a MuJoCo model"):
        export(saved(model), into(tmp_path / "no.xml", "mujoco"), tmp_path / "a.xml")
    assert not list(tmp_path.glob("a.*")) and not list(tmp_path.glob("*.py"))


def test_no_limit_of_the_force_is_none_in_every_file(tmp_path: Path) -> None:
    """Without a limit and without a bend the gain does nothing: XML has no word for it, Python has infinity."""
    model = effect_examples.plant() + effect_examples.by_name("force_gain_nonlinearity")(0.0, math.inf)
    record = measured(model, effect_examples.record(1000.0, duration=1.0))
    for name in ("mujoco", "mujoco-xml", "python"):
        out = tmp_path / f"{name.replace('-', '_')}{target(name).suffixes[0]}"
        found = export(saved(model), target(name), out, Options(), (record,))
        assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.02), name
        assert ("force_limit = math.inf" in out.read_text(encoding="utf-8")) == (name == "python")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_file_gets_finite_numbers_only(value: float, tmp_path: Path) -> None:
    for name in ("mujoco", "sdf", "urdf", "python"):
        out = tmp_path / f"rig{target(name).suffixes[0]}"
        with pytest.raises(DataError, match=rf"a number of the model is {value:g}; expected a finite one"):
            export(replace(saved(rig()[0]), zeros=(value,)), target(name), out)
        assert not out.exists()


def test_json_keeps_its_contract(tmp_path: Path, repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(repository / "docs" / "generate"))
    import json_contract

    page = (repository / "docs" / "json.md").read_text(encoding="utf-8")
    told = made("mujoco-xml", tmp_path, "hysteresis").to_json_dict()
    known = json_contract.documented(page, "msd.export/1")
    assert set(json_contract.paths(told)) | {"nearest", "replay", "parameters.NAME"} == known | {"parameters.NAME"}


def test_json_is_strict(tmp_path: Path) -> None:
    told = made("mujoco-xml", tmp_path, "hysteresis").to_json_dict()
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert told["nearest"]["dropped"] == ["hysteresis"] and told["effects"][0]["kind"] == "approximated"
    assert math.isfinite(told["replay"]["see_target_m"]) and told["schema"] == "msd.export/1"
