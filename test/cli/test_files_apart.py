"""No result replaces a file that is read, nor another result: refused before any work, with and without --overwrite."""

from __future__ import annotations

from pathlib import Path

import pytest
from badinputs import run, step, table

READ = "is read, and a result would replace it; expected another file: give the result a new name"
TWICE = "two results go to"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory: two records and the limits of a rig."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        table(step(), tmp_path / name)
    (tmp_path / "lim.yaml").write_text("force: 10\ntravel: 0.05\nduration: 6\n", encoding="utf-8")
    return tmp_path


def kept(folder: Path) -> dict[str, bytes]:
    """Content of all files."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


@pytest.mark.parametrize("overwrite", [(), ("--overwrite",)])
@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("identify a.csv --on b.csv --json b.csv", f"b.csv {READ}"),
        ("identify a.csv --on b.csv --report ./b.csv", f"b.csv {READ}"),
        ("identify a.csv --on b.csv --export draws:b.csv", f"b.csv {READ}"),
        ("identify a.csv --export draws:a.csv", f"a.csv {READ}"),
        ("diagnose a.csv --export draws:a.csv", f"a.csv {READ}"),
        ("identify a.csv --json q.py --export python:q.py", f"{TWICE} q.py"),
        ("identify a.csv --json q.json --export python-msd:q.py", f"{TWICE} q.json"),
        ("identify a.csv --export draws:d.csv --export draws:d.csv", f"{TWICE} d.csv"),
        ("design a.csv b.csv --limits lim.yaml --out b.csv", f"b.csv {READ}"),
        ("design a.csv b.csv --limits lim.yaml --json b.csv", f"b.csv {READ}"),
        ("design a.csv --limits lim.yaml --out lim.yaml", f"lim.yaml {READ}"),
        ("design a.csv --limits lim.yaml --json lim.yaml", f"lim.yaml {READ}"),
        ("design a.csv --limits lim.yaml --out j.csv --json j.csv", f"{TWICE} j.csv"),
        ("design a.csv --limits lim.yaml --out j.svg --figure j.svg", f"{TWICE} j.svg"),
    ],
)
def test_it_is_refused_and_nothing_changes(words: str, says: str, overwrite: tuple[str, ...], folder: Path) -> None:
    before = kept(folder)
    found = run(*words.split(), *overwrite)
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert found.err.startswith("msd: ") and says in found.err
    assert kept(folder) == before


def test_what_goes_to_files_of_its_own_is_written(folder: Path) -> None:
    words = "identify a.csv --on b.csv --json q.json --export draws:d.csv --export python:q.py --quiet"
    assert run(*words.split()).code == 0
    assert {"q.json", "d.csv", "q.py"} <= set(kept(folder))
