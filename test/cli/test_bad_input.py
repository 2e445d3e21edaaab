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
        (("--json", "nowhere/x.json"), "does not exist; expected one to write x.json into"),
        (("--json", "."), "exists; expected a new name"),
    ],
)
def test_places_that_cannot_be_written_are_refused(options: tuple[str, str], says: str, tmp_path: Path) -> None:
    path = table(step(), tmp_path / "in.csv")
    found = run("identify", path, options[0], tmp_path / options[1])
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert says in found.err
