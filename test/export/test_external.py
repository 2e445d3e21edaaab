"""Somebody else's simulation against a record: its one mistake is named, what cannot be run is refused."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import effect_examples
import numpy as np
import pytest
from exportrigs import measured, pushes, saved

from msd_ident.data.record import Record
from msd_ident.errors import DataError, UsageError
from msd_ident.estimate import Initial
from msd_ident.export import target
from msd_ident.export.plan import Plan
from msd_ident.external import Comparison, FunctionSimulation, MujocoSimulation, TableSimulation, compare
from msd_ident.model import Model, Simulator

FUNCTION = """
import numpy as np

def simulate(time, force, position, velocity):
    x, v, found = position, velocity, []
    h = (time[1] - time[0]) / 10
    for u in force:
        found.append(x)
        for _ in range(10):
            v += h * (u - 3.927 * v - 800.0 * x) / 0.9407
            x += h * v
    return np.array(found)

def short(time, force, position, velocity):
    return np.zeros(3)

def broken(time, force, position, velocity):
    raise ValueError("no such rig")

def leaving(time, force, position, velocity):
    raise SystemExit(3)

def wild(time, force, position, velocity):
    return np.full(time.size, np.nan)
"""


@pytest.fixture(scope="module")
def rig() -> tuple[Model, Record]:
    """A rig with dry friction, and its record."""
    model = effect_examples.model("coulomb_friction")
    return model, measured(model, pushes(3.0))


def against(wrong: Model, record: Record, folder: Path) -> Comparison:
    """A MuJoCo model with these values compared with a record."""
    plan = Plan(saved(wrong), wrong, joint="cart", steps=4)
    for path, content in target("mujoco").files(plan, folder / "theirs.xml").items():
        path.write_bytes(content)
    return compare(MujocoSimulation(folder / "theirs.xml", "cart"), (record,))


@pytest.mark.xdist_group("comparison")
def test_nothing_is_wrong_with_the_right_one(rig: tuple[Model, Record], tmp_path: Path) -> None:
    found = against(*rig, tmp_path)
    assert found.differences == ()
    assert "no significant difference from the rig" in found.sentence and found.explained_percent > 99.99


@pytest.mark.xdist_group("comparison")
def test_friction_that_is_not_there(rig: tuple[Model, Record], tmp_path: Path) -> None:
    model, record = rig
    found = against(model.without("coulomb_friction"), record, tmp_path)
    (one,) = found.differences
    assert (one.kind, one.name) == ("lacks", "coulomb_friction") and one.probability > 0.9
    assert one.rig.value == pytest.approx(0.3, rel=0.02) and one.simulation.value == pytest.approx(0.0, abs=0.01)
    assert one.sentence.startswith("It lacks Coulomb friction (probability")
    assert one.does == pytest.approx(found.see, rel=0.1)


@pytest.mark.xdist_group("comparison")
def test_a_simulation_that_is_wrong_in_all(rig: tuple[Model, Record], tmp_path: Path) -> None:
    """Far from the rig in every parameter, and without its friction: each is named with an interval that is true."""
    model, record = rig
    wrong = {"mass": 1.1, "damping": 1.0, "stiffness": 1500.0}
    found = against(model.without("coulomb_friction").with_values(wrong), record, tmp_path)
    named = {one.name: one for one in found.differences}
    assert set(named) == {"coulomb_friction", "mass", "damping", "stiffness"}
    assert named["coulomb_friction"].kind == "lacks"
    for name in ("mass", "stiffness"):
        assert named[name].simulation.value == pytest.approx(wrong[name], rel=1e-3)
    assert not any("noise floors of them" in warning for warning in found.warnings)


def test_a_simulation_that_no_model_explains(rig: tuple[Model, Record], asking_about: Callable[..., None]) -> None:
    """Positions with an error that no law has: the corrections are called those of the nearest model."""
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    _, record = rig
    rough = (
        record.position
        + 1e-3 * np.repeat(np.random.default_rng(5).standard_normal(record.samples // 40 + 1), 40)[: record.samples]
    )
    found = compare(TableSimulation("theirs.csv", record.time, rough), (record,))
    assert "the corrections are only those of the nearest model" in found.warnings[-1]
    assert found.to_json_dict()["warnings"][-1] == found.warnings[-1]
    assert not any("the same file" in warning for warning in found.warnings)


def test_the_record_itself_is_no_simulation(rig: tuple[Model, Record], asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    _, record = rig
    found = compare(TableSimulation("copy.csv", record.time, record.position), (record,))
    assert found.warnings[0].startswith(
        f"the simulation copy.csv equals the measured readings of {record.name} in every sample, with their noise: it "
        "is probably the same file"
    )


@pytest.mark.xdist_group("comparison")
def test_a_stiffness_that_is_off(
    rig: tuple[Model, Record], tmp_path: Path, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, record = rig
    found = against(model.with_values({"stiffness": 1.1 * model.stiffness}), record, tmp_path)
    (one,) = found.differences
    assert (one.kind, one.name) == ("value", "stiffness")
    assert abs(one.percent.value - 10.0) < 3.0 * one.percent.std < 0.5
    assert one.sentence.startswith("Its stiffness is ") and "% too large: 763.5" in one.sentence
    told = found.to_json_dict()
    assert told["differences"][0]["simulation"]["value"] == pytest.approx(763.5, rel=1e-3)
    monkeypatch.syspath_prepend(str(repository / "docs" / "generate"))
    import json_contract

    page = (repository / "docs" / "json.md").read_text(encoding="utf-8")
    known = json_contract.documented(page, "msd.external/1")
    assert known - {"path"} == {"warnings[]" if path == "warnings" else path for path in json_contract.paths(told)}


@pytest.mark.xdist_group("comparison")
def test_friction_that_only_the_simulation_has(tmp_path: Path) -> None:
    model = effect_examples.model("actuator_lag")
    record = measured(model, pushes(3.0))
    found = against(model + effect_examples.example("coulomb_friction"), record, tmp_path)
    assert [(one.kind, one.name) for one in found.differences] == [("has", "coulomb_friction")]


@pytest.mark.xdist_group("comparison")
def test_a_python_function(rig: tuple[Model, Record], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "their_rig.py").write_text(FUNCTION)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "leaving_rig.py").write_text("raise SystemExit('no licence')")
    (tmp_path / "broken_rig.py").write_text("1 / 0")
    found = compare(FunctionSimulation("their_rig:simulate"), (rig[1],))
    kinds = {one.name: one for one in found.differences}
    assert kinds["coulomb_friction"].kind == "lacks"
    assert kinds["stiffness"].simulation.value == pytest.approx(800.0, rel=2e-3)
    for name, words in (
        ("short", r"returned shape \(3,\); expected \(3001,\)"),
        ("broken", r"failed on rig with ValueError \(no such rig\)"),
        ("leaving", r"leaving ended the process on rig \(SystemExit 3\); expected positions"),
        ("wild", "blows up; expected positions that stay finite"),
    ):
        with pytest.raises(DataError, match=words):
            FunctionSimulation(f"their_rig:{name}").positions(rig[1], found.diagnosis.extended.initial[0])
    for text, words in (
        ("their_rig", "expected module:function"),
        ("their_rig:none", "has no function none"),
        ("no_such_rig:f", "cannot import no_such_rig"),
        ("leaving_rig:f", r"importing leaving_rig ended the process \(SystemExit no licence\); expected a module"),
        ("broken_rig:f", r"importing broken_rig failed with ZeroDivisionError \(division by zero\); expected a module"),
    ):
        with pytest.raises(UsageError, match=words):
            FunctionSimulation(text).check(rig[1])


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_a_function_gets_a_force_for_each_instant(hold: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten samples are missing, and the later ones still get the force that acts from them to the next."""
    (tmp_path / "their_watch.py").write_text(
        "seen = {}\n\ndef simulate(time, force, position, velocity):\n"
        "    seen.update(time=time, force=force)\n    return 0.0 * time\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "their_watch", raising=False)
    stamps = np.arange(200) * 0.01
    force = np.where(stamps < 1.2, 3.0, -1.0) if hold == "zero" else 2.0 * stamps
    time = np.delete(stamps, range(60, 70))
    record = Record(time, 0.0 * time, stamps, force, hold=hold)  # type: ignore[arg-type]
    found = FunctionSimulation("their_watch:simulate").positions(record, Initial(0.0, 0.0, 0.0))
    seen = sys.modules["their_watch"].seen
    assert found.shape == seen["force"].shape == seen["time"].shape == (190,)
    until = np.append(time[1:], time[-1])
    expected = np.where(time < 1.195, 3.0, -1.0) if hold == "zero" else time + until
    assert seen["force"] == pytest.approx(expected, abs=1e-9)


def test_positions_of_a_file_must_cover_the_record(rig: tuple[Model, Record]) -> None:
    model, record = rig
    positions = Simulator(model, record).positions(model.values)
    whole = TableSimulation("their.csv", record.time, positions)
    whole.check(record)
    half = TableSimulation("their.csv", record.time[:1500], positions[:1500])
    with pytest.raises(DataError, match=r"goes from 0 to 1\.499 s, and rig from 0 to 3 s; expected a simulation"):
        half.check(record)
    assert np.array_equal(whole.positions(record, None), positions)  # type: ignore[arg-type]


def test_a_joint_of_another_kind(rig: tuple[Model, Record], tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="arm"/><geom size=".1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(UsageError, match="is a hinge, which moves in rad, and positions are in m"):
        MujocoSimulation(tmp_path / "arm.xml", "arm").check(rig[1])
    MujocoSimulation(tmp_path / "arm.xml", "arm").check(replace(rig[1], position_unit="rad"))
    with pytest.raises(DataError, match="cannot read .*; expected a MuJoCo model"):
        MujocoSimulation(tmp_path / "none.xml", "arm").check(rig[1])
    assert math.isfinite(rig[0].mass)
