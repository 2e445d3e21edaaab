"""Paths and names from outside in exported files: text in each format, whatever signs they hold."""

from __future__ import annotations

import ast
import io
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import effect_examples
import numpy as np
import pytest
import yaml
from exportrigs import measured, saved

from msd_ident.errors import UsageError
from msd_ident.export import TARGETS, Options, Target, export, into, target
from msd_ident.export.plan import Plan
from msd_ident.export.posterior import Draws

PATHS = [
    '"""\nraise SystemExit("ran")\n"""',
    'q"""; import os #.csv',
    'ends with """',
    "C:\\new\\Users\\x.csv",
    "ends with \\",
    "two\nlines: [",
    "b---x-->.csv",
    "<&\"'>",
    "\x00\x1b\x85\u2028\r\t",
    "\udce9.csv",
]
JOINT = 'arm/\\ "1" <&> \'--->'
ROBOT = (
    '<mujoco><worldbody><body><joint name="x" type="slide"/><geom size=".02" mass="0.4"/></body></worldbody></mujoco>'
)


def written(one: Target, path: str, folder: Path, name: str = "rig", joint: str = "x") -> dict[str, list[str]]:
    """What the reader of each written file finds in it; a file that it cannot read raises."""
    model = effect_examples.model("coulomb_friction", "force_offset", "backlash", "sensor_drift")
    told = saved(model, path=path)
    told = replace(told, parameters={name: replace(own, unit=path) for name, own in told.parameters.items()})
    draws = Draws(model.names, np.array([model.values]), np.zeros(1, dtype=np.int64), ((("coulomb_friction",), 1.0),))
    plan = Plan(told, model, joint, draws=draws)
    return {
        file.suffix: contents(file.suffix, content)
        for file, content in one.files(plan, folder / f"{name}{one.suffixes[0]}").items()
    }


def contents(suffix: str, content: bytes) -> list[str]:
    """The nodes of code but its docstring, and names, attributes, values and lines that are no comments."""
    if suffix == ".fmu":
        parts = zipfile.ZipFile(io.BytesIO(content))
        suffix = ".py"
        content = next(parts.read(name) for name in parts.namelist() if name.endswith(".py") and "Rig" in name)
    text = content.decode()
    if suffix == ".py":
        docstring, *rest = ast.parse(text).body
        assert isinstance(docstring, ast.Expr) and isinstance(docstring.value, ast.Constant)
        nodes = [node for part in rest for node in ast.walk(part)]
        fields = [(type(node).__name__, str(value)) for node in nodes for _, value in ast.iter_fields(node)
                  if not isinstance(value, ast.AST | list)]  # fmt: skip
        return [word for field in fields for word in field]
    if suffix in (".xml", ".sdf", ".urdf"):
        found = ElementTree.fromstring(text).iter()
        return [word for one in found for word in (one.tag, str(one.text).strip(), *sum(one.items(), ()))]
    if suffix == ".yaml":
        return [event.value for event in yaml.parse(text) if isinstance(event, yaml.ScalarEvent)]
    return [line for line in text.split("\n") if not line.startswith("#")]


@pytest.mark.parametrize("one", TARGETS, ids=lambda one: one.name)
def test_a_path_is_text_in_every_file(one: Target, tmp_path: Path) -> None:
    if one.name == "fmu":
        pytest.importorskip("pythonfmu")
    clean = written(one, "rig.csv", tmp_path)
    for path in PATHS if one.name != "fmu" else PATHS[:1]:
        assert written(one, path, tmp_path).items() >= {k: v for k, v in clean.items() if k != ".json"}.items(), path


def test_a_path_is_text_in_a_robot(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT)
    clean = written(into(robot, "mujoco"), "rig.csv", tmp_path)
    for path in PATHS:
        assert written(into(robot, "mujoco"), path, tmp_path) == clean, path


def test_the_name_of_the_model_is_text_in_its_callback_file(tmp_path: Path) -> None:
    named, clean = (written(target("mujoco"), "rig.csv", tmp_path, name) for name in ('q"""; import os #', "rig"))
    assert named == clean


@pytest.mark.parametrize("name", ["mujoco", "mujoco-xml", "mujoco-fragment", "sdf", "urdf", "gains"])
def test_the_name_of_a_joint_is_text_in_every_file(name: str, tmp_path: Path) -> None:
    clean, found = (written(target(name), "rig.csv", tmp_path, joint=joint) for joint in ("NAME_OF_IT", JOINT))
    assert found == {suffix: [word.replace("NAME_OF_IT", JOINT) for word in words] for suffix, words in clean.items()}
    assert all(any(JOINT in word for word in words) for words in found.values())


def test_a_joint_of_any_name_is_replayed(tmp_path: Path) -> None:
    model = effect_examples.model("coulomb_friction")
    record = measured(model, effect_examples.record(1000.0, duration=1.0))
    for name in ("mujoco", "mujoco-xml"):
        found = export(saved(model), target(name), tmp_path / f"{name}.xml", Options(JOINT), (record,))
        assert found.proof is not None and found.proof.ratio == pytest.approx(1.0, abs=0.05), name


@pytest.mark.parametrize("joint", ["", " ", "two\nlines", "\udce9"])
def test_a_joint_without_a_name_is_refused(joint: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"^--joint '.*'; expected a name that can be read: give the joint's own"):
        export(saved(effect_examples.model()), target("sdf"), tmp_path / "rig.sdf", Options(joint))
    assert not (tmp_path / "rig.sdf").exists()
