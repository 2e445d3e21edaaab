"""Parameters known beforehand: a free decay gives newtons, and what is not sure about them is in the intervals."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from badinputs import run

from msd_ident.data.record import Record, from_samples
from msd_ident.errors import UsageError
from msd_ident.io import write_csv
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.quantity import Quantity
from msd_ident.workflow import pipeline
from msd_ident.workflow.identification import Identification
from msd_ident.workflow.known_parameters import Known, check, contradicted, parse, parse_all

RIG = Plant(mass=0.8, damping=0.5, stiffness=200.0) + CoulombFriction(0.05)


def decay() -> Record:
    time = np.arange(3000) * 2e-3
    still = from_samples(time, np.zeros(3000), np.zeros(3000))
    position = simulate(RIG, still, 0.02).position + np.random.default_rng(5).normal(0.0, 1e-6, 3000)
    return replace(still, position=position)


def identified(*known: str) -> Identification:
    return pipeline.identify([decay()], pipeline.Options(known=parse_all(known)))


def test_a_free_decay_gives_newtons() -> None:
    for known in ("mass=0.8", "stiffness=200", "coulomb_force=0.05"):
        found = identified(known)
        for name in ("mass", "damping", "stiffness", "coulomb_force"):
            assert found.refined.parameters[name].value == pytest.approx(RIG[name], rel=2e-2), (known, name)
        assert not any("known only as ratios" in sentence for sentence in found.open)
    assert identified().refined.parameters["mass"].value == 1.0
    assert any("weigh the moving mass and give --mass" in sentence for sentence in identified().open)


def test_what_sets_no_scale_leaves_ratios() -> None:
    found = identified("coulomb_force=0")
    assert found.refined.parameters["mass"].value == 1.0
    assert any("known only as ratios" in sentence for sentence in found.open)


def test_an_uncertain_value_makes_the_others_uncertain() -> None:
    sure, unsure = identified("mass=0.8").refined.parameters, identified("mass=0.8±0.04").refined.parameters
    assert unsure["mass"].std == pytest.approx(0.04)
    for name in ("damping", "stiffness", "coulomb_force"):
        assert unsure[name].std == pytest.approx(np.hypot(sure[name].std, 0.05 * sure[name].value), rel=0.05)
    # Both forces and the weight grow with the mass: µ does not.
    assert unsure["friction_coefficient"].std == pytest.approx(sure["friction_coefficient"].std, rel=0.2)


def pushed(drag: float = 0.0) -> Record:
    """A cart under steps of the force, without dry friction; with a drag that grows with the speed's square."""
    time = np.arange(2000) * 2e-3
    force = np.where(time % 2.0 < 1.0, 2.0, 0.0)
    still = from_samples(time, force, np.zeros(2000))
    plant = Plant(mass=0.8, damping=0.5, stiffness=200.0)
    moved = simulate(plant + QuadraticDrag(drag) if drag else plant, still).position
    return replace(still, position=moved + np.random.default_rng(5).normal(0.0, 1e-6, 2000))


def test_a_known_value_that_the_data_contradicts_is_named() -> None:
    def warned(record: Record, *known: str) -> str:
        return " ".join(pipeline.identify([record], pipeline.Options(known=parse_all(known))).warnings)

    said = warned(pushed(), "mass=0.75", "stiffness=200")
    assert re.search(r"mass is given as 0.75, and is 0.(79999|80000)\d* ± \S+ kg by the data. Check the value", said)
    assert "stiffness is given" not in said and "the model lacks something" not in said
    assert "Check the value" not in warned(pushed(), "mass=0.8", "stiffness=200")
    assert "the model lacks something" in warned(pushed(20.0), "mass=0.75"), "its laws are wrong with any mass"


def test_a_unit_that_is_wrong_by_a_thousand_is_told_beside_a_known_value() -> None:
    """A force in mN: that the known mass is wrong took the place of the doubt."""
    record = replace(pushed(), force=1e3 * pushed().force)
    said = pipeline.identify([record], pipeline.Options(known=parse_all(["mass=2000"]))).warnings
    assert any(one.startswith("The mass is 2000 kg: is a unit wrong by a factor of 1000?") for one in said)
    assert any("by the data. Check the value, or leave it out." in one for one in said)
    right = contradicted(parse_all(["mass=0.8"]), {"mass": Quantity(800.1, 0.01, "kg")}, 30.0)
    assert right.endswith("or leave it out. Or is a unit of the record wrong by a factor of 1000?")


def test_known_values_stand_in_the_result() -> None:
    told = identified("stiffness=200±0.5 N/m").to_json_dict()
    assert told["known"] == [{"name": "stiffness", "value": 200.0, "std": 0.5, "unit": "N/m"}]


def test_the_command_takes_them(tmp_path: Path) -> None:
    path = tmp_path / "decay.csv"
    write_csv(decay(), path)
    found = run("identify", path, "--force", "none", "--mass", "0.8±0.01", "--json", "-")
    assert found.code == 0
    told = json.loads(found.out)
    assert told["known"][0] == {"name": "mass", "value": 0.8, "std": 0.01, "unit": "kg"}
    assert told["refined"]["parameters"]["stiffness"]["value"] == pytest.approx(200.0, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("stiffness=24.25", Known("stiffness", 24.25)),
        (" stiffness = 24.25 ± 0.1 ", Known("stiffness", 24.25, 0.1)),
        ("mass=9.86e-1+-2e-3kg", Known("mass", 0.986, 0.002, "kg")),
        ("damping=.5+/-.1 N*s/m", Known("damping", 0.5, 0.1, "N·s/m")),
        ("offset_force=-3", Known("offset_force", -3.0)),
    ],
)
def test_ways_to_write_it(text: str, known: Known) -> None:
    assert parse(text) == known


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "heavy",
            "--known 'heavy' is not valid; expected NAME=VALUE or NAME=VALUE±STD, e.g. stiffness=24.25±0.1",
        ),
        ("weight=3", "no parameter is called 'weight'; expected one of mass, damping, stiffness, "),
        ("mass=0", "mass is 0 kg; expected a finite value above 0: correct --mass or --known"),
        ("stiffness=-2", "stiffness is -2 N/m; expected a finite value from 0: correct --known"),
        ("mass=1±-1", "the standard deviation of mass is -1; expected 0 or more: correct --mass or --known"),
    ],
)
def test_what_cannot_be_known(text: str, words: str) -> None:
    with pytest.raises(UsageError) as refused:
        parse(text)
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_one_value_for_each() -> None:
    with pytest.raises(UsageError, match="mass is given twice; expected one value: remove one of them"):
        parse_all(["mass=1"], "2")


@pytest.mark.parametrize(
    ("text", "units", "words"),
    [
        ("mass=986 g", ("N", "m"), "mass is given in g; expected kg, its unit on this rig: convert it"),
        ("mass=1 kg", ("N·m", "rad"), "mass is given in kg; expected kg·m², its unit on this rig"),
        (
            "mass=1",
            ("V", "m"),
            "mass is known in kg, and is in V·s²/m on this rig; expected a force in N and a position in m",
        ),
        (
            "drag_coefficient=1",
            ("N", "m"),
            "drag_coefficient is known, but the fitted model has none; expected one of mass,",
        ),
    ],
)
def test_what_does_not_go_with_the_rig(text: str, units: tuple[str, str], words: str) -> None:
    record = replace(decay(), force_unit=units[0], position_unit=units[1])
    with pytest.raises(UsageError) as refused:
        check([parse(text)], RIG, record)
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_unit_of_the_rig_is_taken() -> None:
    check([parse("mass=1 kg·m²")], RIG, replace(decay(), force_unit="N·m", position_unit="rad"))
    check([parse("mass=1 V·s²/m")], RIG, replace(decay(), force_unit="V"))


def test_a_diagnosis_does_not_silently_ignore_them() -> None:
    with pytest.raises(
        UsageError, match="known parameters in a diagnosis; expected none, because it fits all parameters"
    ):
        pipeline.diagnose([decay()], pipeline.Options(known=parse_all(["mass=1"])))


def test_the_weighed_spring(shared_data: Path) -> None:
    path = shared_data / "real" / "hanging_spring_mesh.csv"
    if not path.exists():
        pytest.skip(f"no {path}")
    found = json.loads(run("identify", path, "--force", "none", "--known", "stiffness=24.25", "--json", "-").out)
    assert found["refined"]["parameters"]["mass"]["value"] == pytest.approx(0.1398, rel=2e-3)
