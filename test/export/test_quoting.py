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
from exportrigs import saved

from msd_ident.export import TARGETS, Target, into
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
ROBOT = (
    '<mujoco><worldbody><body><joint name="x" type="slide"/><geom size=".02" mass="0.4"/></body></worldbody></mujoco>'
)


def written(target: Target, path: str, folder: Path, file: str = "rig") -> dict[str, str]:
    """What each written file means to its reader, without comments; a file that it cannot read raises."""
    model = effect_examples.model("coulomb_friction", "force_offset")
    told = saved(model, path=path)
    told = replace(told, parameters={name: replace(own, unit=path) for name, own in told.parameters.items()})
    draws = Draws(model.names, np.array([model.values]), np.zeros(1, dtype=np.int64), ((("coulomb_friction",), 1.0),))
    plan = Plan(told, model, draws=draws)
    return {
        one.suffix: meaning(one.suffix, content)
        for one, content in target.files(plan, folder / f"{file}{target.suffixes[0]}").items()
    }


def meaning(suffix: str, content: bytes) -> str:
    """Code without its docstring, XML, YAML and CSV without comments."""
    if suffix == ".fmu":
        parts = zipfile.ZipFile(io.BytesIO(content))
        suffix = ".py"
        content = next(parts.read(name) for name in parts.namelist() if name.endswith(".py") and "Rig" in name)
    text = content.decode()
    if suffix == ".py":
        docstring, *rest = ast.parse(text).body
        assert isinstance(docstring, ast.Expr) and isinstance(docstring.value, ast.Constant)
        return "\n".join(map(ast.unparse, rest))
    if suffix in (".xml", ".sdf", ".urdf"):
        return ElementTree.canonicalize(text, strip_text=True)
    if suffix == ".yaml":
        return repr(yaml.safe_load(text))
    return "\n".join(line for line in text.split("\n") if not line.startswith("#"))


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_a_path_is_text_in_every_file(target: Target, tmp_path: Path) -> None:
    if target.name == "fmu":
        pytest.importorskip("pythonfmu")
    clean = written(target, "rig.csv", tmp_path)
    for path in PATHS if target.name != "fmu" else PATHS[:1]:
        assert written(target, path, tmp_path).items() >= {k: v for k, v in clean.items() if k != ".json"}.items(), path


def test_a_path_is_text_in_a_robot(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT)
    clean = written(into(robot, "mujoco"), "rig.csv", tmp_path)
    for path in PATHS:
        assert written(into(robot, "mujoco"), path, tmp_path) == clean, path


def test_the_name_of_the_model_is_text_in_its_callback_file(tmp_path: Path) -> None:
    mujoco = next(target for target in TARGETS if target.name == "mujoco")
    assert written(mujoco, "rig.csv", tmp_path, 'q"""; import os #') == written(mujoco, "rig.csv", tmp_path)
