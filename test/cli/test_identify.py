"""msd identify and msd paper as a user types them: tables, JSON, pictures, exit codes, one line an error."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest
from badinputs import Outcome, run
from once import paper_study

from msd_ident import export as exporting
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import SetupError
from msd_ident.export import Export
from msd_ident.export.target import Target
from msd_ident.io import write_csv
from msd_ident.paper import method
from msd_ident.workflow.saved_model import SavedModel
from msd_sim.api import simulate


def msd(*words: str | Path, expect: int = 0) -> Outcome:
    """The command in this process."""
    done = run(*words)
    assert done.code == expect, done.out + done.err
    return done


def process(*words: str | Path, expect: int = 0) -> subprocess.CompletedProcess[str]:
    """The command as its own process."""
    call = [sys.executable, "-m", "msd_ident.cli.main", *map(str, words)]
    done = subprocess.run(call, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == expect, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done


@pytest.fixture(scope="module")
def once() -> Iterator[None]:
    """The paper's study, which is always the same, is made once for the tests here."""
    made = paper_study()
    with mock.patch.object(method, "study", lambda progress: made):
        yield


@pytest.fixture(scope="module")
def step_csv(tmp_path_factory: pytest.TempPathFactory) -> Path:
    data = simulate({"rig": "ecp", "experiment": "paper", "seed": 3})
    sparse = Record(time=data.time, position=data.position, force_time=data.force_time, force=data.force)
    record = from_samples(data.time, sparse.force_at(data.time), data.position)
    path = tmp_path_factory.mktemp("data") / "step.csv"
    write_csv(record, path)
    return path


def test_tables_pictures_and_json_of_one_file(step_csv: Path, tmp_path: Path) -> None:
    done = msd("identify", step_csv, "--json", tmp_path / "out.json", "--figures", tmp_path / "figures")
    for words in ("Features (Table 1)", "Standard form (Table 2)", "Physical parameters (Table 3)", "Joint refit"):
        assert words in done.out
    assert max(len(line) for line in done.out.splitlines() if "figures:" not in line) <= 80
    found = json.loads((tmp_path / "out.json").read_text())
    assert found["path"] == str(step_csv)
    assert found["refined"]["parameters"]["mass"]["value"] == pytest.approx(0.9407, rel=1e-3)
    pictures = sorted((tmp_path / "figures").rglob("*.png"))
    assert [picture.name for picture in pictures] == ["bode.png", "figure_7_model.png", "figure_8_residual.png"]
    assert all(picture.stat().st_size > 10_000 for picture in pictures)


def test_json_on_standard_output_stands_alone_and_a_failing_path_does_not_stop_the_others(
    step_csv: Path, tmp_path: Path
) -> None:
    missing = tmp_path / "nothing.csv"
    done = process("identify", missing, step_csv, "--json", "-", expect=2)
    first, second = (json.loads(line) for line in done.stdout.splitlines())
    assert first["path"] == str(missing) and "error" in first
    assert second["schema"] == "msd.identification/1" and second["path"] == str(step_csv)
    assert len(done.stderr.strip().splitlines()) == 1 and str(missing) in done.stderr


def test_results_are_not_overwritten_unless_told(step_csv: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    target.write_text("mine")
    done = msd("identify", step_csv, "--json", target, expect=2)
    assert "exists" in done.err and "--overwrite" in done.err and target.read_text() == "mine"
    msd("identify", step_csv, "--json", target, "--overwrite", "--quiet")
    assert json.loads(target.read_text())["schema"] == "msd.identification/1"


def _changed(path: Path, target: Path, change: str) -> Path:
    """The step's CSV, damaged in the way named."""
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    if change == "five samples":
        rows = rows[:5]
    elif change in ("nan", "inf"):
        rows[100, 2] = float(change)
    elif change == "constant":
        rows[:, 2] = 0.0
    elif change == "backwards":
        rows = np.vstack((rows, rows))
    elif change == "millimetres":
        rows[:, 2] *= 1000.0
    np.savetxt(target, rows, delimiter=",", header="time_s,force_n,position_m", comments="", fmt="%.9g")
    return target


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("five samples", "5 position samples; expected at least 20"),
        ("inf", "expected a finite number"),
        ("constant", "never"),
        ("backwards", "backwards"),
    ],
)
def test_data_that_cannot_be_used_gets_one_line(step_csv: Path, tmp_path: Path, change: str, words: str) -> None:
    done = msd("identify", _changed(step_csv, tmp_path / "bad.csv", change), expect=2)
    assert words in done.err
    assert len(done.err.strip().splitlines()) == 1


def test_a_position_that_is_no_number_is_a_missing_sample_and_said(step_csv: Path, tmp_path: Path) -> None:
    done = msd("identify", _changed(step_csv, tmp_path / "gap.csv", "nan"))
    assert "samples, 6.00 s, 1 missing" in done.out


def test_unit_wrong_by_a_thousand_is_a_warning_with_the_number(step_csv: Path, tmp_path: Path) -> None:
    done = msd("identify", _changed(step_csv, tmp_path / "mm.csv", "millimetres"))
    warnings = " ".join(done.out.split())
    assert "warning" in warnings and "1000" in warnings


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("identify", "--model", "springy"), "model is 'springy'; expected one of auto, spring, no_spring"),
        (("identify", "--loss", "huber"), "loss is 'huber'; expected one of linear, soft_l1"),
        (("identify", "--hold", "first"), "hold is 'first'; expected one of auto, zero, linear, band_limited"),
        (("identify", "--position", "nowhere"), "nowhere"),
    ],
)
def test_bad_options_get_one_line(step_csv: Path, words: tuple[str, ...], said: str) -> None:
    done = msd(words[0], step_csv, *words[1:], expect=2)
    assert said in done.err and len(done.err.strip().splitlines()) == 1


def test_unknown_option_and_missing_path_are_refused_without_a_traceback() -> None:
    assert "--nonsense" in process("identify", "--nonsense", expect=2).stderr
    msd("identify", expect=2)


@pytest.mark.xdist_group("paper")
@pytest.mark.usefixtures("once")
def test_paper_prints_its_tables_and_what_it_cannot_reproduce() -> None:
    done = msd("paper")
    text = " ".join(done.out.split())
    assert "27.16" in text and "694.1" in text and "peaks at 2.649 cm, where the data has 2.554 cm" in text
    assert "No viscous + Coulomb model reproduces" in text
    assert max(map(len, done.out.splitlines())) <= 80


@pytest.mark.xdist_group("paper")
@pytest.mark.usefixtures("once")
def test_paper_as_json_stands_alone_on_standard_output() -> None:
    found = json.loads(msd("paper", "--json", "-").out)
    assert found["schema"] == "msd.paper/1"
    assert found["original"]["damping"]["value"] == pytest.approx(3.927, abs=3e-3)
    assert found["standard_form"]["natural_frequency"]["value"] == pytest.approx(27.16, abs=5e-3)
    peak = found["inconsistency"]["first_peak_cm"]
    assert peak["data"] == pytest.approx(2.554) and abs(peak["best_coulomb_model"] - peak["data"]) > 0.01


@pytest.fixture
def runs_csv(step_csv: Path, tmp_path: Path) -> Path:
    """Two runs side by side: the step twice."""
    once, path = np.loadtxt(step_csv, delimiter=",", skiprows=1), tmp_path / "runs.csv"
    head = ",".join(f"{name} Run #{run}" for run in (1, 2) for name in ("Time (s)", "Force (N)", "Position (m)"))
    np.savetxt(path, np.hstack((once, once)), delimiter=",", header=head, comments="", fmt="%.9g")
    return path


def test_runs_side_by_side_are_not_exported_to_one_file(runs_csv: Path, tmp_path: Path) -> None:
    draws = ("--export", f"draws:{tmp_path / 'draws.csv'}", "--quiet")
    done = msd("identify", runs_csv, "--run", "all", *draws, expect=2)
    assert "--export with 2 results; expected one: give one path, with --run N where it has several runs" in done.err
    assert done.err.count("\n") == 1 and not (tmp_path / "draws.csv").exists()
    msd("identify", runs_csv, "--run", "2", *draws)
    assert (tmp_path / "draws.csv").exists()


def test_a_further_use_that_fails_stops_no_other_and_is_told(
    step_csv: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing, first, second = tmp_path / "nix.csv", tmp_path / "d.csv", tmp_path / "e.csv"
    real = exporting.export

    def full_disk(model: SavedModel, target: Target, out: Path, *more: Any) -> Export:
        if out == first:
            raise SetupError(f"cannot write {out}: no space")
        return real(model, target, out, *more)

    monkeypatch.setattr(exporting, "export", full_disk)
    on = ("--on", missing, "--on", step_csv)
    done = msd("identify", step_csv, *on, "--export", f"draws:{first}", "--export", f"draws:{second}", "--json", "-",
               "--quiet", expect=2)  # fmt: skip
    found = json.loads(done.out)
    assert found["schema"] == "msd.identification/1" and "error" not in found
    bad, good = found["validations"]
    assert bad["path"] == str(missing) and set(bad) == {"path", "error"} and "nix.csv does not exist" in bad["error"]
    assert (good["path"], good["schema"]) == (str(step_csv), "msd.validation/1")
    lost, made = found["exports"]
    assert lost == {"path": str(first), "error": f"cannot write {first}: no space"}
    assert made["target"] == "draws" and second.exists()
    assert done.err.splitlines() == [f"msd: {bad['error']}", f"msd: {lost['error']}"]
