"""Many records: the same digits as one by one, a row for whatever is wrong, nothing done twice, nothing lost."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from batchrigs import step_file

import msd_ident
from msd_ident import parallel
from msd_ident.batching import batch, table
from msd_ident.batching.job import Job
from msd_ident.batching.running import Link
from msd_ident.batching.work import Work
from msd_ident.errors import DataError, UsageError

#: Columns of the run and not of the record.
OF_THE_RUN = ("seconds", "diagnosis_seconds", "worker")

pytestmark = pytest.mark.xdist_group("batching")


def run(
    link: Link, paths: object, out: Path | None = None, job: Job | None = None, **plan: Any
) -> tuple[Any, batch.Run]:
    where = [str(paths)] if isinstance(paths, Path) else list(map(str, paths))  # type: ignore[call-overload]
    return batch.run(where, job or Job(), link, batch.Plan(str(out or ""), **plan))


def of_the_record(row: dict[str, Any]) -> dict[str, str]:
    return {name: repr(value) for name, value in row.items() if name not in OF_THE_RUN}


@pytest.fixture(scope="module")
def kept(link: Link, records: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table of the records."""
    out = tmp_path_factory.mktemp("tables") / "kept.parquet"
    run(link, records, out)
    return out


def test_digits_are_those_of_one_by_one(kept: Path, records: Path) -> None:
    rows = table.read(str(kept)).to_pylist()
    work = Work(Job())
    alone = [row for path in sorted(records.rglob("*.csv")) for row in work(str(path)).rows]
    lost = {name for row in alone for name in row} - set(table.schema().names)
    assert not lost, f"{lost} is in the rows and no column: add it in batching/table.py"
    again = table.made(alone).to_pylist()
    assert list(map(of_the_record, rows)) == list(map(of_the_record, again)) and len(rows) == 4


def test_a_worker_leaves_the_other_cores_to_the_others(records: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def diagnosed(*_: object) -> None:
        seen.append(parallel.threads())
        raise DataError("seen")

    monkeypatch.setattr("msd_ident.workflow.pipeline.diagnose", diagnosed)
    path = str(next(records.rglob("*.csv")))
    with parallel.limited_to(3):
        Work(Job(), threads=1)(path)
        Work(Job())(path)
    assert seen == [1, 3]


def test_row_says_what_was_found_and_from_what(kept: Path) -> None:
    row = table.read(str(kept)).to_pylist()[1]
    assert (row["robot"], row["name"], row["day"]) == ("arm_0", "2026-03-02.csv", "2026-03-02")
    assert row["verdict"] == "adequate" and row["error"] is None
    assert row["stiffness"] == pytest.approx(694.0, rel=2e-3) and row["stiffness_std"] > 0.0
    assert row["temperature"] == 21.0 and row["load"] is None and row["peak_force"] == pytest.approx(10.4)
    assert len(row["covariance"]) == len(row["free"]) ** 2 and row["code"] == Job().code


def test_bad_records_are_rows_and_never_the_end(link: Link, records: Path, tmp_path: Path) -> None:
    (tmp_path / "empty.csv").write_text("")
    good = next(iter(sorted(records.rglob("*.csv"))))
    found, _ = run(link, [tmp_path / "empty.csv", tmp_path / "gone.mcap", good])
    rows = found.to_pylist()
    assert [row["name"] for row in rows] == ["empty.csv", "gone.mcap", good.name]
    assert "No such file" in rows[1]["error"] and rows[1]["verdict"] is None
    assert rows[0]["error"] and "Traceback" not in rows[0]["error"] and rows[2]["error"] is None


def test_resume_does_nothing_twice_and_what_is_new(link: Link, records: Path, kept: Path, tmp_path: Path) -> None:
    lab, out = tmp_path / "lab", tmp_path / "table.parquet"
    shutil.copytree(records, lab)
    shutil.copy(kept, out)
    _, this = run(link, lab, out, resume=True)  # other paths, the same contents
    assert this.reused == 4
    (lab / "arm_0" / "2026-03-01.csv").rename(lab / "arm_1" / "moved.csv")
    step_file(lab / "arm_0" / "2026-03-02.csv", seed=9)
    found, this = run(link, [lab], out, resume=True)
    assert this.reused == 3  # the moved one too
    by_name = {row["name"]: row for row in found.to_pylist() if row["path"].startswith(str(lab))}
    assert by_name["moved.csv"]["robot"] == "arm_1"
    assert by_name["2026-03-02.csv"]["stiffness"] != pytest.approx(
        table.read(str(kept)).to_pylist()[1]["stiffness"], rel=1e-9
    )
    keys = table.keys(found)
    assert len(keys) == len(set(keys))


def test_parts_of_a_run_that_was_cut_off_are_gone_on_with(link: Link, records: Path, tmp_path: Path) -> None:
    out, done = tmp_path / "table.parquet", []

    def cut(count: int, total: int, rows: object) -> None:
        done.append(count)
        if count == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(link, records, out, progress=cut)
    assert not out.exists() and done == [1, 2]
    with pytest.raises(UsageError, match=r"table.parquet.parts exists; .* \(an interrupted run: --resume goes on"):
        run(link, records, out)
    found, this = run(link, records, out, resume=True)
    assert (found.num_rows, this.reused) == (4, 2)
    assert not Path(f"{out}.parts").exists()


def test_another_question_is_another_row(link: Link, records: Path, kept: Path, tmp_path: Path) -> None:
    out = shutil.copy(kept, tmp_path / "table.parquet")
    one = next(iter(sorted(records.rglob("*.csv"))))
    found, this = run(link, [one], Path(out), Job(labels={"robot": "(arm)"}), resume=True)
    assert this.reused == 0 and found.num_rows == 4
    assert {row["name"]: row["robot"] for row in found.to_pylist()}[one.name] == "arm"


def test_a_table_is_not_replaced_unasked(link: Link, records: Path, kept: Path) -> None:
    with pytest.raises(
        UsageError, match=r"exists; expected a new name \(--resume adds to it, --overwrite begins anew\)"
    ):
        run(link, records, kept)


def test_nothing_to_do_is_said(link: Link, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="holds no record; expected bags, or files that end in"):
        run(link, tmp_path)
    with pytest.raises(UsageError, match="no paths; expected folders"):
        run(link, [])


def test_python_gives_a_table_or_futures(link: Link, records: Path) -> None:
    one = sorted(records.rglob("*.csv"))[0]
    found = msd_ident.batch([one], client=link.client)
    futures = msd_ident.batch([one], client=link.client, wait=False)
    (row,) = futures[str(one)].result()
    assert row["stiffness"] == found.to_pylist()[0]["stiffness"]
    with pytest.raises(UsageError, match="futures without a client"):
        msd_ident.batch([one], wait=False)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"labels": {"colour": "(x)"}}, "label 'colour'; expected one of robot, day"),
        ({"labels": {"robot": "arm"}}, "has no group; expected one in brackets"),
        ({"labels": {"robot": "("}}, "is no regular expression"),
    ],
)
def test_jobs_that_make_no_sense_are_refused(given: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError) as refused:
        Job(**given)
    assert says in str(refused.value)
