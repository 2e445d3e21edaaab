"""``msd identify`` on bad and odd inputs: one clear line and exit code 2, or a result with its warning."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from badinputs import CASES, Case, identify, run, step, table


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_bad_input_gets_its_line(case: Case, tmp_path: Path) -> None:
    found = identify(case, tmp_path)
    assert found.code == case.code, found.err
    lines = found.out.splitlines()
    if case.code == 2:
        assert found.err.startswith("msd: ") and found.err.count("\n") == 1
        assert case.says in found.err
        assert len(lines) <= 1  # options are refused before any path is looked at
        assert all(case.says in json.loads(line)["error"] for line in lines)
    else:
        assert len(lines) == 1
        assert "msd: " not in found.err.replace("msd: compiling", "")
        result = json.loads(lines[0])
        assert any(case.says in sentence for sentence in (*result["warnings"], *result["open"])), found.line


@pytest.mark.parametrize("name", ["my data.csv", "mäß ω.csv"])
def test_paths_with_spaces_and_letters_of_any_language(name: str, tmp_path: Path) -> None:
    found = run("identify", table(step(), tmp_path / name), "--json", "-")
    assert found.code == 0 and json.loads(found.out)["path"].endswith(name)
    assert json.loads(found.out)["warnings"] == []


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--figures", "in.csv"), "is no folder and cannot become one"),
        (("--json", "nowhere/x.json"), "does not exist; expected one to write x.json into: make it"),
        (("--json", "."), "exists; expected a new name"),
        (("--json", ".", "--overwrite"), "is a folder; expected a file to write: give a name in it"),
    ],
)
def test_places_that_cannot_be_written_are_refused(options: tuple[str, ...], says: str, tmp_path: Path) -> None:
    path = table(step(), tmp_path / "in.csv")
    found = run("identify", path, options[0], tmp_path / options[1], *options[2:])
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert says in found.err


def test_nothing_that_is_read_is_replaced(tmp_path: Path) -> None:
    path = table(step(), tmp_path / "in.csv")
    before = path.read_bytes()
    for option in ("--json", "--markdown", "--report"):
        found = run("identify", path, option, path, "--overwrite")
        assert (found.code, found.err.count("\n")) == (2, 1)
        assert "is read, and a result would replace it; expected another file" in found.err
    model = tmp_path / "model.json"
    assert run("identify", path, "--json", model, "--quiet").code == 0
    kept = model.read_bytes()
    found = run("validate", model, path, "--json", model, "--overwrite")
    assert found.code == 2 and "is read, and a result would replace it" in found.err
    assert (path.read_bytes(), model.read_bytes()) == (before, kept)


def test_a_result_may_stand_in_the_folder_of_its_bag(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    assert run("simulate", "--out", bag, "--experiment", "steps", "--quiet").code == 0
    for _ in range(2):
        assert run("identify", bag, "--json", bag / "result.json", "--overwrite", "--quiet").code == 0
    (part,) = bag.glob("*.mcap")
    before = part.read_bytes()
    found = run("identify", bag, "--json", part, "--overwrite")
    assert found.code == 2 and "is read, and a result would replace it" in found.err
    assert part.read_bytes() == before


def test_two_results_never_go_to_one_file(tmp_path: Path) -> None:
    path, both = table(step(), tmp_path / "in.csv"), tmp_path / "both"
    found = run("identify", path, "--json", both, "--report", tmp_path / "." / "both")
    assert found.code == 2 and "two results go to" in found.err and not both.exists()
    rig = tmp_path / "rig.csv"
    found = run("simulate", "--out", rig, "--json", rig)
    assert found.code == 2 and "two results go to" in found.err and not rig.exists()


def test_a_joint_without_its_model_is_refused(tmp_path: Path) -> None:
    path = table(step(), tmp_path / "in.csv")
    found = run("validate", path, "--simulated", path, "--joint", "foo")
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert "--joint foo without --mujoco; expected a MuJoCo model that has the joint" in found.err


def test_a_file_without_a_name_is_refused(tmp_path: Path) -> None:
    """An unset variable of a shell: the result went nowhere, and nothing was said."""
    found = run("identify", table(step(), tmp_path / "in.csv"), "--json", "")
    assert found.code == 2 and "--json names no file; expected a file's name" in found.err


@pytest.mark.parametrize("text", ["[1, 2]", '"hi"', "null", "5", 5000 * "["])
def test_json_that_is_no_result_is_refused(text: str, tmp_path: Path) -> None:
    model = tmp_path / "model.json"
    model.write_text(text, encoding="utf-8")
    found = run("validate", model, table(step(), tmp_path / "in.csv"))
    assert (found.code, found.err.count("\n")) == (2, 1) and "no JSON object; expected a result that msd" in found.err


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--mass", "1e300"), "mass is 1e+300 kg; expected a size from 1e-18 to 1e+18: correct --mass or --known"),
        (("--mass", "abc"), "mass 'abc' is not valid; expected VALUE or VALUE±STD"),
        (("--known", "stiffness=24,5"), "expected NAME=VALUE or NAME=VALUE±STD, with a decimal point"),
        (("--known", "stiffness=690±x"), "expected NAME=VALUE or NAME=VALUE±STD, e.g."),
        (("--model", "no_spring", "--known", "stiffness=6"), "the stiffness is known, and the model has no spring"),
    ],
)
def test_values_that_are_known_are_checked(options: tuple[str, ...], says: str, tmp_path: Path) -> None:
    found = run("identify", table(step(), tmp_path / "in.csv"), *options)
    assert (found.code, found.err.count("\n")) == (2, 1) and says in found.err
