"""Files whose names hold a byte that is no UTF-8."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from badinputs import run, step
from badinputs import table as table_of

from msd_ident.writing import readable

NAME, SHOWN = os.fsdecode(b"bad\xff.csv"), "bad\\udcff.csv"


@pytest.fixture
def odd(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    table_of(step(), tmp_path / NAME)
    return tmp_path


def test_results_show_the_byte_as_its_escape(odd: Path) -> None:
    found = run("identify", NAME, "--json", "o.json", "--report", "o.html", "--markdown", "o.md", "--quiet")
    assert (found.code, found.err) == (0, "")
    assert f'"path": "{SHOWN}"' in (odd / "o.json").read_text(encoding="utf-8")
    assert json.loads((odd / "o.json").read_text(encoding="utf-8"))["path"] == NAME
    assert SHOWN in (odd / "o.html").read_text(encoding="utf-8") and SHOWN in (odd / "o.md").read_text(encoding="utf-8")


def test_a_figure_has_it_in_its_title(odd: Path) -> None:
    assert run("identify", NAME, "--figures", "figures", "--quiet").code == 0
    assert any((odd / "figures").rglob("*.png"))


@pytest.mark.parametrize("words", [("--json", "-"), ()])
def test_a_strict_terminal_prints_it(words: tuple[str, ...], odd: Path) -> None:
    command = [sys.executable, "-m", "msd_ident.cli.main", "identify", NAME, *words]
    strict = {**os.environ, "PYTHONIOENCODING": "utf-8:strict", "COLUMNS": "200"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=120.0, env=strict, cwd=odd)
    assert (done.returncode, done.stderr) == (0, "") and SHOWN in done.stdout


def test_a_batch_has_a_row_for_it(odd: Path) -> None:
    table = pytest.importorskip("msd_ident.batching.table")
    pytest.importorskip("pyarrow", reason="the extra batch is not installed")
    from msd_ident.batching.row import identity
    from msd_ident.batching.work import page_name

    (row,) = table.made([identity(str(odd / NAME), {})]).to_pylist()
    assert (row["path"], row["name"]) == (f"{readable(str(odd))}/{SHOWN}", SHOWN)
    assert page_name(NAME, "").endswith(".html")


def test_a_bags_fingerprint_holds_it(odd: Path) -> None:
    from msd_ident.data.provenance import fingerprint

    before = fingerprint(odd)
    (odd / NAME).rename(odd / "good.csv")
    assert fingerprint(odd)[0] == before[0] and fingerprint(odd)[1] != before[1]
