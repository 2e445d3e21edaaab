"""``msd export``, ``--export`` and ``msd validate --mujoco`` as a user types them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import effect_examples
import numpy as np
import pytest
from badinputs import run
from exportrigs import measured, pushes, result, saved

from msd_ident.export import target
from msd_ident.export.plan import Plan


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a record and its result."""
    folder = tmp_path_factory.mktemp("export")
    model = effect_examples.model("coulomb_friction", "cubic_spring")
    record = measured(model, pushes(3.0))
    rows = np.column_stack([record.time, record.force_at(record.time), record.position])
    header = "time_s,force_n,position_m"
    np.savetxt(folder / "rig.csv", rows, delimiter=",", header=header, comments="", fmt="%.9g")
    (folder / "result.json").write_text(json.dumps(result(model)))
    return folder


@pytest.mark.xdist_group("export_cli")
def test_export_proves_itself_on_its_own_record(rig: Path) -> None:
    whole = ("export", rig / "result.json", "--to", "mujoco", "--out", rig / "rig.xml")
    found = run(*whole, "--report", rig / "page.html")
    assert found.code == 0, found.err
    assert "In mujoco the model leaves" in found.out and "third coefficient of stiffness" in found.out
    page = (rig / "page.html").read_text(encoding="utf-8")
    assert "msd export" in page and "third coefficient of stiffness" in page and "m, b, k alone, in mujoco" in page
    again = run(*whole)
    assert again.code == 2 and "exists; expected a new name" in again.err


@pytest.mark.xdist_group("export_cli")
def test_export_without_its_record_says_so(rig: Path, tmp_path: Path) -> None:
    (tmp_path / "alone.json").write_text((rig / "result.json").read_text())
    found = run("export", tmp_path / "alone.json", "--to", "mujoco", "--out", tmp_path / "rig.xml", "--json", "-")
    assert found.code == 0 and found.err == ""
    told = json.loads(found.out)
    assert told["replay"] is None and told["not_replayed"] == "its own record rig.csv is not here: give --replay PATH"


@pytest.fixture(scope="module")
def millimetres(rig: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same record with other headings and units, and the result that ``msd identify`` wrote of it."""
    folder = tmp_path_factory.mktemp("millimetres")
    time, force, position = np.loadtxt(rig / "rig.csv", delimiter=",", skiprows=1).T
    header = "clock,current,laser"
    rows = np.column_stack([time, force, 1e3 * position])
    np.savetxt(folder / "rig.csv", rows, delimiter=",", header=header, comments="", fmt="%.9g")
    reading = ("--time", "clock", "--force", "current", "--force-unit", "N", "--position", "laser")
    made = run("identify", folder / "rig.csv", *reading, "--position-unit", "mm", "--json", folder / "result.json")
    assert made.code == 0, made.err
    return folder


@pytest.mark.xdist_group("export_cli")
def test_its_own_record_is_read_as_the_result_was(millimetres: Path) -> None:
    """Without the options given again, its record had "no column called position"."""
    told = json.loads((millimetres / "result.json").read_text())
    assert told["read_with"] == {
        "force": "current", "position": "laser", "time": "clock", "force_unit": "N", "position_unit": "mm"
    }  # fmt: skip
    whole = ("export", millimetres / "result.json", "--to", "python", "--json", "-", "--out")
    found = run(*whole, millimetres / "rig.py")
    assert found.code == 0, found.err
    assert json.loads(found.out)["replay"]["see_target_m"] == pytest.approx(told["refined"]["see_m"], rel=0.1)
    other = json.loads(run(*whole, millimetres / "other.py", "--position", "no such").out)
    assert other["replay"] is None and "no such" in other["not_replayed"], "what is given counts"
    metres = json.loads(run(*whole, millimetres / "metres.py", "--position-scale", "0.001").out)
    assert metres["replay"]["see_target_m"] == pytest.approx(told["refined"]["see_m"], rel=0.1)


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    "wrong", [{"gears": "3"}, {"force": 7}, {"start": "soon"}, {"rate": True}, {"end": 10**400}, {"end": None}]
)
def test_a_reading_that_is_none_is_told_and_the_export_written(
    wrong: dict[str, object], millimetres: Path, tmp_path: Path
) -> None:
    told = json.loads((millimetres / "result.json").read_text()) | {"read_with": wrong}
    (tmp_path / "result.json").write_text(json.dumps(told))
    (tmp_path / "rig.csv").write_bytes((millimetres / "rig.csv").read_bytes())
    (tmp_path / "result.json").write_text(json.dumps(told | {"path": "rig.csv"}))
    found = run("export", tmp_path / "result.json", "--to", "python", "--out", tmp_path / "rig.py", "--json", "-")
    assert found.code == 0 and (tmp_path / "rig.py").exists(), found.err
    said = "expected an option of how a record is read, and its value"
    assert said in json.loads(found.out)["not_replayed"]


@pytest.mark.xdist_group("export_cli")
def test_a_run_of_a_file_is_replayed(rig: Path, tmp_path: Path) -> None:
    time, force, position = np.loadtxt(rig / "rig.csv", delimiter=",", skiprows=1).T
    runs = [f"{name} Run #{number}" for number in (1, 2) for name in ("Time (s)", "Force (N)", "Position (m)")]
    rows = np.column_stack([time, force, 0.5 * position, time, force, position])
    np.savetxt(tmp_path / "runs.csv", rows, delimiter=",", header=",".join(runs), comments="", fmt="%.9g")
    made = run("identify", tmp_path / "runs.csv", "--run", "2", "--json", tmp_path / "result.json")
    assert made.code == 0, made.err
    found = run("export", tmp_path / "result.json", "--to", "python", "--out", tmp_path / "rig.py", "--json", "-")
    told = json.loads((tmp_path / "result.json").read_text())
    assert told["read_with"] == {"run": "2"} and told["path"].endswith("runs.csv run 2")
    replay = json.loads(found.out)["replay"]
    assert replay is not None and replay["see_target_m"] == pytest.approx(told["refined"]["see_m"], rel=0.1)


@pytest.mark.xdist_group("export_cli")
def test_a_result_of_several_records_is_replayed_on_all_and_replaces_none(rig: Path, tmp_path: Path) -> None:
    lines = (rig / "rig.csv").read_text().splitlines(keepends=True)
    for name, end in (("rig.csv", len(lines)), ("again.csv", -1)):  # the same to the last line would count once
        (tmp_path / name).write_text("".join(lines[:end]))
    told = json.loads((rig / "result.json").read_text()) | {"path": "rig.csv + again.csv"}
    (tmp_path / "both.json").write_text(json.dumps(told))
    whole = ("export", tmp_path / "both.json", "--out")
    refused = run(*whole, tmp_path / "again.csv", "--to", "draws", "--overwrite")
    assert refused.code == 2 and "again.csv is read, and a result would replace it" in refused.err
    found = run(*whole, tmp_path / "rig.xml", "--to", "mujoco", "--json", "-")
    assert found.code == 0 and len(json.loads(found.out)["replay"]["records"]) == 2, found.err
    (tmp_path / "again.csv").unlink()
    alone = json.loads(run(*whole, tmp_path / "one.xml", "--to", "mujoco", "--json", "-").out)
    assert alone["not_replayed"] == "its own record rig.csv + again.csv is not here: give --replay PATH"


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "python", "--out", "a.py", "--draws", "5"), "--draws with --to python; expected --to draws: leave"),
        (
            ("--to", "python", "--out", "a.py", "--steps", "5"),
            "--steps with --to python, which has none; expected a MuJoCo",
        ),
        (("--to", "python", "--out", "a.py", "--replay", "r.csv"), "--no-replay with --replay r.csv; expected one of"),
        (("--to", "mujoco", "--out", "a.xml", "--draws", "5"), "--draws with --to mujoco; expected --to draws: leave"),
    ],
)
def test_what_a_target_does_not_use_is_refused(
    options: tuple[str, ...], words: str, rig: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = run("export", rig / "result.json", "--no-replay", *options)
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize("name", ["python", "python-msd", "mujoco"])
def test_a_path_in_a_result_is_never_run(name: str, rig: Path, tmp_path: Path) -> None:
    told = json.loads((rig / "result.json").read_text())
    told["path"] = f'"""\nopen({str(tmp_path / "ran")!r}, "w")\n"""'
    (tmp_path / "result.json").write_text(json.dumps(told))
    out = tmp_path / f"rig{target(name).suffixes[0]}"
    found = run("export", tmp_path / "result.json", "--to", name, "--out", out, "--replay", rig / "rig.csv")
    assert found.code == 0 and "the model leaves" in found.out, found.err
    assert not (tmp_path / "ran").exists()


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "sdf", "--out", "a.sdf"), "--fragment with --to sdf; expected --to mujoco, whose elements it writes"),
        (("--to", "gains", "--out", "a.xml"), "--fragment with --to gains; expected --to mujoco"),
        (("--to", "mujoco", "--out", "a.xml", "--into", "robot.xml"), "--fragment with --into, which writes a whole"),
        (("--to", "mujoco", "--out", "a.xml", "--joint", ""), "--joint ''; expected a name that can be read"),
    ],
)
def test_a_fragment_is_of_one_joint_in_mujoco(
    options: tuple[str, ...], words: str, rig: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = run("export", rig / "result.json", "--no-replay", "--fragment", *options)
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "draws", "--out", "r.csv", "--replay", "r.csv"), "r.csv is read, and a result would replace it"),
        (("--to", "draws", "--out", "rig.csv"), "rig.csv is read, and a result would replace it"),
        (("--to", "python", "--out", "a.py", "--json", "rig.csv"), "rig.csv is read, and a result would replace it"),
        (("--to", "python", "--out", "a.py", "--json", "model.json"), "model.json is read, and a result would"),
        (("--to", "python-msd", "--out", "model.py"), "model.json is read, and a result would replace it"),
        (("--to", "mujoco", "--out", "robot.xml", "--into", "robot.xml"), "robot.xml is read, and a result would"),
        (("--to", "python", "--out", "a.py", "--report", "a.py"), "two results go to a.py; expected a file for each"),
        (("--to", "python-msd", "--out", "a.py", "--json", "a.json"), "two results go to a.json; expected a file"),
    ],
)
def test_nothing_that_is_read_or_written_is_replaced(
    options: tuple[str, ...], words: str, rig: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, source in (("r.csv", "rig.csv"), ("rig.csv", "rig.csv"), ("model.json", "result.json")):
        (tmp_path / name).write_bytes((rig / source).read_bytes())
    (tmp_path / "robot.xml").write_text("<mujoco/>")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    found = run("export", "model.json", *options, "--overwrite", "--figures", "pictures")
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.xdist_group("export_cli")
def test_a_path_that_no_disk_has_is_no_record(rig: Path, tmp_path: Path) -> None:
    told = json.loads((rig / "result.json").read_text())
    (tmp_path / "model.json").write_text(json.dumps(told | {"path": 600 * "long"}))
    found = run("export", tmp_path / "model.json", "--to", "python", "--out", tmp_path / "a.py", "--json", "-")
    assert found.code == 0, found.err
    assert json.loads(found.out)["not_replayed"].endswith("is not here: give --replay PATH")


@pytest.mark.xdist_group("export_cli")
def test_a_fragment_is_written(rig: Path, tmp_path: Path) -> None:
    found = run("export", rig / "result.json", "--fragment", "--to", "mujoco", "--out", tmp_path / "a.xml")
    assert found.code == 0 and "<mujocoinclude>" in (tmp_path / "a.xml").read_text(encoding="utf-8")


@pytest.mark.xdist_group("export_cli")
def test_identify_exports_in_one_go(rig: Path, tmp_path: Path) -> None:
    out = tmp_path / "rig.py"
    found = run("identify", rig / "rig.csv", "--export", f"python:{out}", "--json", "-")
    assert found.code == 0, found.err
    (told,) = json.loads(found.out)["exports"]
    assert told["target"] == "python" and told["replay"]["see_target_m"] > 0.0 and out.exists()


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--export", "mujoco"), "expected TARGET:FILE, e.g. --export mujoco:rig.xml"),
        (("--export", "unity:rig.x"), "no target is called 'unity'"),
        (("--export", "mujoco:rig.sdf"), "expected a name that ends in .xml"),
        (("--export", "mujoco:nowhere/rig.xml"), "nowhere does not exist"),
    ],
)
def test_exports_are_refused_before_any_work(options: tuple[str, str], words: str, rig: Path) -> None:
    found = run("identify", rig / "rig.csv", *options)
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1


@pytest.mark.xdist_group("export_cli")
def test_simulated_positions_of_a_file(rig: Path, tmp_path: Path, asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring", "force_gain_nonlinearity")
    made = run("export", rig / "result.json", "--to", "mujoco", "--out", tmp_path / "rig.xml", "--no-replay")
    assert made.code == 0 and "Not replayed: --no-replay." in made.out
    found = run("validate", rig / "rig.csv", "--mujoco", tmp_path / "rig.xml", "--joint", "x", "--json", "-")
    assert found.code == 0, found.err
    told = json.loads(found.out)
    assert told["schema"] == "msd.external/1" and told["explained_percent"] > 99.9
    positions = np.loadtxt(rig / "rig.csv", delimiter=",", skiprows=1)[:, [0, 2]] * [1.0, 0.9]
    header = "time_s,position_m"
    np.savetxt(tmp_path / "theirs.csv", positions, delimiter=",", header=header, comments="", fmt="%.9g")
    found = run("validate", rig / "rig.csv", "--simulated", tmp_path / "theirs.csv", "--json", "-")
    assert found.code == 0, found.err
    assert json.loads(found.out)["differences"]


@pytest.mark.xdist_group("export_cli")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "no record to try the model on; expected msd validate RESULT.json PATH…"),
        (("--mujoco", "robot.xml"), "--mujoco without --joint; expected the joint"),
        (("--mujoco", "robot.xml", "--joint", "x"), "cannot read robot.xml"),
        (("--mujoco", "robot.xml", "--joint", "x", "--callable", "a:b"), "expected one simulation at a time"),
    ],
)
def test_validate_is_refused(options: tuple[str, ...], words: str, rig: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(rig)
    found = run("validate", rig / "rig.csv", *options)
    assert found.code == 2 and words in found.err


@pytest.fixture(scope="module")
def theirs(rig: Path) -> Path:
    """A MuJoCo model of the rig whose stiffness is a tenth too large."""
    model = effect_examples.model("coulomb_friction", "cubic_spring")
    wrong = model.with_values({"stiffness": 1.1 * model.stiffness})
    for path, content in target("mujoco-xml").files(Plan(saved(wrong), wrong, steps=8), rig / "theirs.xml").items():
        path.write_bytes(content)
    return rig / "theirs.xml"


@pytest.mark.xdist_group("export_cli")
def test_a_page_about_somebody_elses_simulation(rig: Path, theirs: Path, tmp_path: Path) -> None:
    whole = ("validate", rig / "rig.csv", "--mujoco", theirs, "--joint", "x", "--report", tmp_path / "page.html")
    found = run(*whole, "--require", "99.99", "--json", tmp_path / "told.json")
    assert found.code == 1 and "Its stiffness is" in found.out and "The simulation lacks a force of" in found.out
    told = json.loads((tmp_path / "told.json").read_text())
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    sections = ("verdict", "differences", "fit", "lacking_force", "parameters", "data")
    assert [page.index(f'id="r1-{name}"') for name in sections] == sorted(
        page.index(f'id="r1-{name}"') for name in sections
    )
    assert told["differences"][0]["sentence"] in page and "through the actuator" in told["how"]
    fitted = told["models"]["simulation"]["parameters"]
    for key, value in (
        ("see_m", told["see_m"]), ("missing_force_rms", told["missing_force_rms"]),
        ("differences.0.rig.value", told["differences"][0]["rig"]["value"]),
        ("models.simulation.parameters.stiffness.value", fitted["stiffness"]["value"]),
    ):  # fmt: skip
        assert f'<data value="{value!r}" data-key="{key}">' in page
    again = run(*whole)
    assert again.code == 2 and "exists; expected a new name" in again.err


@pytest.mark.xdist_group("export_cli")
def test_options_of_a_saved_result_are_not_for_a_simulation(rig: Path, theirs: Path) -> None:
    found = run("validate", rig / "rig.csv", "--mujoco", theirs, "--joint", "x", "--refit-zero")
    assert found.code == 2 and "expected neither: they are about a saved result" in found.err
