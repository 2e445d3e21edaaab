"""msd diagnose: words first, one JSON object a path, errors in one line, exit codes."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

from msd_ident.cli import main as command
from msd_sim.api import simulate

RIG = {
    "mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0,
    "encoder": {"counts_per_metre": 100000.0}, "experiment": {"name": "steps", "force": 8.0, "hold": 0.5},
}  # fmt: skip


def written(path: Path, **more: object) -> Path:
    made = simulate({**RIG, **more})
    place = np.searchsorted(made.force_time, made.time, side="right") - 1
    table = np.stack([made.time, made.force[place], made.position], axis=1)
    np.savetxt(path, table, delimiter=",", header="time_s,force_n,position_m", comments="", fmt="%.10g")
    return path


def run(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr("sys.argv", ["msd", "diagnose", *(str(argument) for argument in arguments)])
    return command.main()


def test_words_and_tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "rubbing.csv", effects={"coulomb_friction": {"coulomb_force": 0.2}})
    assert run(monkeypatch, path) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("rubbing.csv: explained\n")
    assert "The model lacks Coulomb friction (probability > 99.9 %)." in shown.replace("\n", " ")
    assert "on left-out data" in shown


def test_json_on_standard_output_is_one_object_a_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clean = written(tmp_path / "clean.csv", rate=200)
    missing = tmp_path / "missing.csv"
    assert run(monkeypatch, clean, missing, "--json", "-") == 2
    told = capsys.readouterr()
    first, second = (json.loads(line) for line in told.out.splitlines())
    assert first["schema"] == "msd.diagnosis/2" and first["path"] == str(clean)
    assert first["verdict"] == "adequate" and first["causes"] == []
    assert second["path"] == str(missing) and "error" in second
    assert len(told.err.splitlines()) == 1


def test_copies_of_steps_are_made_when_asked_and_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "dragged.csv", rate=200, effects={"quadratic_drag": {"drag_coefficient": 4.0}})
    assert run(monkeypatch, path, "--calibrate", "--json", tmp_path / "found.json") == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "Of the copies with quadratic drag, " in shown
    found = json.loads((tmp_path / "found.json").read_text())["calibration"]
    assert found["rows"][0]["causes"] == ["quadratic_drag"]
    assert found["copies"] == sum(row["copies"] for row in found["rows"]) > 20


def test_together_is_one_experiment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [written(tmp_path / f"{name}.csv", seed=seed, rate=200) for seed, name in enumerate("ab")]
    assert run(monkeypatch, *paths, "--together", "--json", "-") == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert json.loads(line)["path"] == " + ".join(str(path) for path in paths)


def test_nothing_is_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "clean.csv", rate=200)
    target = tmp_path / "found.json"
    target.write_text("kept")
    assert run(monkeypatch, path, "--json", target) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert target.read_text() == "kept"
    assert run(monkeypatch, path, "--json", target, "--quiet", "--overwrite") == 0
    assert json.loads(target.read_text())["verdict"] == "adequate"


def test_page_summary_and_figures_of_one_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "clean.csv", rate=200)
    page, notes, folder = tmp_path / "report.html", tmp_path / "notes.md", tmp_path / "figures"
    everything = ("--report", page, "--markdown", notes, "--figures", folder)
    assert run(monkeypatch, path, *everything, "--quiet") == 0
    assert capsys.readouterr() == ("", "")
    text = page.read_text(encoding="utf-8")
    assert "Mass, damping and stiffness are enough" in text
    assert hashlib.sha256(path.read_bytes()).hexdigest() in text and f"msd diagnose {path}" in text
    assert notes.read_text(encoding="utf-8").startswith("# clean.csv: adequate")
    names = sorted(picture.name for picture in (folder / "clean.csv").iterdir())
    assert {"fit.png", "fit.svg", "missing_velocity.png", "bode.svg"} <= set(names)
    assert run(monkeypatch, path, *everything, "--quiet") == 2
    assert "--overwrite" in capsys.readouterr().err


def test_a_page_into_nowhere_is_refused_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, tmp_path / "none.csv", "--report", tmp_path / "nowhere" / "report.html") == 2
    assert "does not exist; expected one to write report.html into" in capsys.readouterr().err


@pytest.mark.parametrize("printed", [[], ["--json", "-"]], ids=["tables", "json"])
def test_files_are_written_although_nobody_reads_what_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, printed: list[str]
) -> None:
    """As behind ``| head -1``: the table was printed first, and the page and the JSON were never written."""
    path, page = written(tmp_path / "clean.csv", rate=200), tmp_path / "page.html"
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", buffering=1) as deaf:
        monkeypatch.setattr("sys.stdout", deaf)
        assert run(monkeypatch, path, "--report", page, *(printed or ["--json", tmp_path / "found.json"])) == 0
    assert "adequate" in page.read_text()
    assert printed or json.loads((tmp_path / "found.json").read_text())["verdict"] == "adequate"
