"""``msd batch``, ``compare`` and ``watch`` as a user types them: refusals in one line, and what they print."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("pyarrow", reason="the extra batch is not installed")

from badinputs import run, step  # noqa: E402
from badinputs import table as table_of  # noqa: E402
from batchrigs import row  # noqa: E402

from msd_ident.batching import batch, cluster, table  # noqa: E402


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A table of forty days of two robots, one of which changed."""
    rows = [row(n) for n in range(40)]
    rows = [{**one, "stiffness": one["stiffness"] * (1.0 if n < 25 else 0.97)} for n, one in enumerate(rows)]
    rows += [row(n, "other") for n in range(40)]
    table.Store(str(tmp_path / "lab.parquet")).finish(table.made(rows))
    return tmp_path / "lab.parquet"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("batch", "{empty}", "--out", "t.parquet"), "holds no record; expected bags, or files that end in"),
        (("batch", "{empty}", "--out", "t.csv"), "t.csv is no table's name; expected one that ends in .parquet"),
        (("batch", "--list", "nowhere.txt", "--out", "t.parquet"), "cannot read the list nowhere.txt"),
        (("batch", "--out", "t.parquet"), "no paths; expected folders, patterns or records"),
        (
            ("batch", "x.csv", "--out", "t.parquet", "--scheduler", "tcp://127.0.0.1:9"),
            "no scheduler at tcp://127.0.0.1:9",
        ),
        (("batch", "x.csv", "--out", "t.parquet", "--workers", "-1"), "-1 workers; expected at least 1"),
        (("batch", "x.csv", "--out", "t.parquet", "--label", "robot"), "--label 'robot'; expected NAME=VALUE"),
        (
            ("batch", "a/x.csv", "b.csv", "--out", "t.parquet", "--label", "robot=arm_(.)", "--label", "day=(b)"),
            "label robot: 'arm_(.)' matches no path, e.g. not",
        ),
        (
            ("batch", "x.csv", "--out", "t.parquet", "--all-joints", "--force", "a"),
            "--all-joints takes force and position",
        ),
        (("compare", "{lab}", "--by", "colour"), "no column colour to compare by; expected one of robot, joint, day"),
        (("compare", "{lab}", "--by", "joint"), "the column joint is empty in all rows; expected what to compare by"),
        (("compare", "nowhere.parquet"), "nowhere.parquet is not there; expected a table: make it with msd batch"),
        (("compare", "{lab}", "x.csv"), "beside other paths; expected one table, or records alone"),
        (("compare", "{lab}", "--force-scale", "2"), "--force-scale with the table {lab}; expected it for records: a"),
        (("compare", "{lab}", "--start", "3"), "--start with the table {lab}; expected it for records: a table has"),
        (("compare", "{lab}", "--label", "robot=(z)"), "--label with the table {lab}; expected it for records"),
        (("watch", "{lab}", "--covariate", "load=x"), "--covariate with the table {lab}; expected it for records"),
        (("watch", "{lab}", "--all-joints"), "--all-joints with the table {lab}; expected it for records"),
        (("watch", "{lab}", "--false-alarms", "0"), "0 false alarms a year; expected more than 0, at most 365"),
        (
            ("watch", "{lab}", "--follow", "-1"),
            "--follow takes seconds above 0, not -1; expected a period of at most a year",
        ),
        (("watch", "{lab}", "--follow", "nan"), "--follow takes seconds above 0, not nan; expected a period"),
        (("watch", "{lab}", "--follow", "inf"), "--follow takes seconds above 0, not inf; expected a period"),
        (("watch", "{lab}", "--follow", "1e10"), "--follow takes seconds above 0, not 1e+10; expected a period"),
        (("watch", "{lab}", "--follow", "5", "--json", "-"), "--follow with --json -; expected a file"),
    ],
)
def test_what_makes_no_sense_is_one_line(
    words: tuple[str, ...], says: str, lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster.connect, "__defaults__", (0.5,))  # nobody will answer, however long it waits
    (tmp_path / "empty").mkdir()
    found = run(*(word.format(empty=tmp_path / "empty", lab=lab) for word in words))
    assert (found.code, found.out) == (2, "")
    assert found.err.startswith("msd: ") and found.err.count("\n") == 1 and says.format(lab=lab) in found.err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("batch a.csv --out t.parquet --report a.csv", "a.csv is read, and a result would replace it"),
        ("batch rig --out t.parquet --report rig/b.csv", "b.csv is read, and a result would replace it"),
        ("batch --list all.txt --out t.parquet --report all.txt", "all.txt is read, and a result would replace it"),
        ("batch a.csv --out t.parquet --report ./t.parquet", "two results go to t.parquet"),
        ("compare lab.parquet --json lab.parquet", "lab.parquet is read, and a result would replace it"),
        ("compare rig --report rig/b.csv", "b.csv is read, and a result would replace it"),
        ("watch ./lab.parquet --json lab.parquet", "lab.parquet is read, and a result would replace it"),
        ("watch rig --json rig/b.csv", "b.csv is read, and a result would replace it"),
        ("watch rig --table k.parquet --report k.parquet", "two results go to k.parquet"),
    ],
)
def test_no_result_replaces_what_is_read_nor_another_result(
    words: str, says: str, lab: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(lab.parent)
    (lab.parent / "rig").mkdir()
    for name in ("a.csv", "rig/b.csv"):
        table_of(step(), lab.parent / name)
    (lab.parent / "all.txt").write_text("a.csv\n", encoding="utf-8")
    before = {path: path.read_bytes() for path in lab.parent.rglob("*") if path.is_file()}
    found = run(*words.split(), "--overwrite")
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1) and says in found.err
    assert {path: path.read_bytes() for path in lab.parent.rglob("*") if path.is_file()} == before


def test_the_table_of_a_watch_may_be_watched_again(lab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has the name that --table has by default, and is only read then."""
    monkeypatch.chdir(lab.parent)
    lab.rename("msd_watch.parquet")
    assert run("watch", "msd_watch.parquet", "--json", "w.json", "--quiet").code == 0


@pytest.mark.parametrize(
    ("finished", "says"),
    [
        (1, "finished records are in t.parquet.parts: go on with --resume"),
        (0, "no record was finished"),
    ],
)
def test_an_interrupted_batch_says_how_to_go_on(
    finished: int, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(paths: object, job: object, link: object, plan: batch.Plan) -> None:
        store = table.Store(plan.out)
        store.add([row(n) for n in range(finished)])
        store.flush()
        raise KeyboardInterrupt

    link = SimpleNamespace(client=SimpleNamespace(dashboard_link=""))
    monkeypatch.setattr(batch, "linked", lambda *_: contextlib.nullcontext(link))
    monkeypatch.setattr(batch, "run", interrupted)
    monkeypatch.chdir(tmp_path)
    found = run("batch", "a.csv", "--out", "t.parquet")
    assert (found.code, found.out, found.err) == (130, "", f"msd: interrupted; {says}\n")


@pytest.mark.parametrize(("failed", "code"), [(2, 2), (1, 0)])
def test_a_batch_without_any_result_says_why(
    failed: int, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Single records may fail; a job that is wrong for all of them passed as a success."""
    bad = [{**row(n), "verdict": None, "error": "no signal is called 'x'"} for n in range(failed)]
    made = table.made([*bad, *(row(n) for n in range(failed, 2))])
    monkeypatch.setattr(batch, "linked", lambda *_: contextlib.nullcontext(link))
    monkeypatch.setattr(batch, "run", lambda *_: (made, SimpleNamespace(reused=0)))
    link = SimpleNamespace(client=SimpleNamespace(dashboard_link=""))
    monkeypatch.chdir(tmp_path)
    found = run("batch", "a.csv", "b.csv", "--out", "t.parquet")
    assert found.code == code and found.out == f"t.parquet: 2 rows, {failed} with an error, 0 records done before\n"
    said = "msd: no record of t.parquet has a result (no signal is called 'x'); expected one at least: the reason of"
    assert found.err.startswith(said) if code else found.err == ""


def test_a_watch_of_a_table_keeps_none(lab: Path) -> None:
    found = run("watch", lab, "--table", "kept.parquet")
    assert found.code == 2 and found.err.count("\n") == 1
    assert "--table beside" in found.err and "which is one already; expected records: leave --table away" in found.err


@pytest.mark.parametrize("command", ["watch", "compare"])
def test_a_path_that_leads_nowhere_is_refused_before_anything_is_written(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    table_of(step(), tmp_path / "a.csv")
    found = run(command, "a.csv", "nowhere", "--workers", "1")
    assert (found.code, found.out, found.err.count("\n")) == (2, "", 1)
    assert "nowhere is not there; expected a record, or a folder or pattern of them" in found.err
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_watch_keeps_units_and_free_decays_apart(tmp_path: Path) -> None:
    """A record in counts is no change of one in metres, nor is a decay, whose mass of 1 kg is assumed."""
    days = [row(n) for n in range(10)]
    days += [row(n, position_unit="count", mass=4e-6, stiffness=3e-3) for n in range(10, 18)]
    days += [row(n, force_unit="V", mass=0.19) for n in range(18, 21)]
    days += [row(n, mass=1.0, mass_std=0.0, stiffness=738.0) for n in range(21, 22)]
    days += [row(n, "other") for n in range(8)]
    table.Store(str(tmp_path / "lab.parquet")).finish(table.made(days))
    found = run("watch", tmp_path / "lab.parquet", "--check")
    assert found.code == 0
    lines = [line.strip() for line in found.out.splitlines()]
    starts = ("arm (N, count): no alarm in 8 records", "arm (N, m): no alarm in 10 records", "other: no alarm in 8")
    assert all(line.startswith(start) for line, start in zip(lines, starts, strict=False))
    assert lines[3:] == [
        "left out: arm (V, m) has 3 records; expected at least 8 to watch it",
        "left out: arm (free decays in m) has 1 record; expected at least 8 to watch it",
    ]


def test_watch_says_who_changed_and_when(lab: Path, tmp_path: Path) -> None:
    found = run("watch", lab, "--check", "--report", tmp_path / "watch.html", "--json", tmp_path / "watch.json")
    assert found.code == 1
    lines = dict(line.split(": ", 1) for line in found.out.splitlines())
    assert lines["arm"].startswith("stiffness changed by -") and "no alarm in 40 records" in lines["other"]
    told = [json.loads(line) for line in (tmp_path / "watch.json").read_text().splitlines()]
    assert [one["schema"] for one in told] == ["msd.watch/1"] * 2
    changes = [(one["parameter"], one["record"]) for one in told[0]["change_points"]]
    assert changes == [("stiffness", "record_00025.csv")]
    assert (tmp_path / "watch.html").stat().st_size > 10_000
