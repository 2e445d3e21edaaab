"""``msd design``: what it cannot do is refused before any work, in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from badinputs import run, step, table


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("--check --figure p.foo", "p.foo is no picture's name; expected one that ends in .png, .svg, .pdf"),
        ("--for mass --figure p.png", "--figure with --for; expected it without: it shows what rivals predict"),
        ("--for mass --check", "--check and --for were given; expected one of the two"),
        ("--check --out p.txt", "p.txt is no profile's name; expected one that ends in .yaml or .csv"),
        ("--for mass --out p.YAML", "p.YAML is no profile's name; expected one that ends in .yaml or .csv"),
        ("--check --figure p", "p is no picture's name; expected one that ends in .png, .svg, .pdf"),
    ],
)
def test_what_it_cannot_do_is_refused_before_any_work(
    words: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    table(step(), tmp_path / "a.csv")
    (tmp_path / "lim.yaml").write_text("force: 10\ntravel: 0.05\nduration: 6\n", encoding="utf-8")
    found = run("design", "a.csv", "--limits", "lim.yaml", "--out", "p.yaml", *words.split())
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert found.err.startswith("msd: ") and says in found.err and not (tmp_path / "p.yaml").exists()
