"""Tables: what is none is refused in words, and what was written is what is read."""

from __future__ import annotations

from pathlib import Path

import pytest

pa = pytest.importorskip("pyarrow", reason="the extra batch is not installed")

import pyarrow.parquet as parquet  # noqa: E402
from batchrigs import row  # noqa: E402

from msd_ident.batching import batch, needs, table  # noqa: E402
from msd_ident.batching.row import PARAMETERS  # noqa: E402
from msd_ident.errors import DataError, SetupError, UsageError  # noqa: E402


def test_what_is_written_is_read(tmp_path: Path) -> None:
    made = table.made([row(1), row(2, error="none", verdict=None)])
    table.Store(str(tmp_path / "t.parquet")).finish(made)
    assert table.read(str(tmp_path / "t.parquet")).equals(made)


def test_every_column_is_in_the_documentation(repository: Path) -> None:
    page = (repository / "docs" / "batch.md").read_text(encoding="utf-8")
    ends = tuple(f"{name}{end}" for name in PARAMETERS for end in ("", "_std"))  # as PARAMETER, base_mass, p_EFFECT
    for name in table.schema().names:
        if not name.startswith("p_") and name.removeprefix("base_") not in ends:
            assert f"`{name}`" in page, f"docs/batch.md does not have the column {name}"


def another(path: Path) -> None:
    """A table of a schema that is to come."""
    parquet.write_table(pa.table({"a": [1]}).replace_schema_metadata({"msd.schema": "msd.batch/9"}), path)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda path: None, "is not there; expected a table: make it with msd batch --out"),
        (lambda path: path.write_text("no"), "is no parquet table"),
        (lambda path: parquet.write_table(pa.table({"a": [1]}), path), "has the schema none; expected msd.batch/1"),
        (another, "has the schema msd.batch/9; expected msd.batch/1: make the table again with this version"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused(make: object, says: str, tmp_path: Path) -> None:
    path = tmp_path / "t.parquet"
    make(path)  # type: ignore[operator]
    with pytest.raises(DataError) as refused:
        table.read(str(path))
    assert says in str(refused.value)


def test_a_later_row_takes_the_place_of_an_earlier_one() -> None:
    both = table.joined([table.made([row(2), row(1)]), table.made([row(2, verdict="unexplained")])])
    found = table.merged(both, {row(1)["path"]: 0, row(2)["path"]: 1}).to_pylist()
    assert [(one["name"], one["verdict"]) for one in found] == [
        ("record_00001.csv", "explained"), ("record_00002.csv", "unexplained")
    ]  # fmt: skip


def test_a_folder_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="nowhere does not exist; expected one to write the table into"):
        table.Store(str(tmp_path / "nowhere" / "t.parquet")).finish(table.made([]))


@pytest.mark.parametrize(
    ("out", "says"),
    [
        ("nowhere/t.parquet", "nowhere does not exist; expected one to write the table into"),
        ("ok.csv/t.parquet", "ok.csv is no folder; expected one to write the table t.parquet into"),
        ("folder.parquet", "folder.parquet is a folder; expected the name of a table to write"),
        ("taken.parquet", "cannot write .*taken.parquet.parts: File exists; expected a writable folder beside the"),
        ("/proc/t.parquet", "cannot write /proc/t.parquet.parts: .*; expected a writable folder beside the table"),
    ],
)
def test_a_place_that_cannot_have_a_table_is_refused_before_the_work(out: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "ok.csv").touch()
    (tmp_path / "taken.parquet.parts").touch()
    (tmp_path / "folder.parquet").mkdir()
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises((UsageError, SetupError), match=says):
        batch.Plan(str(tmp_path / out), overwrite=True).store()
    assert sorted(tmp_path.rglob("*")) == before


def test_the_test_of_a_place_leaves_nothing_there(tmp_path: Path) -> None:
    parts = tmp_path / "kept.parquet.parts"
    parts.mkdir()
    (parts / "1.parquet").touch()
    for name in ("new.parquet", "kept.parquet"):
        table.Store(str(tmp_path / name)).check_place()
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["1.parquet", "kept.parquet.parts"]


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(SetupError, match=r"pyarrow is not installed; .* pip install 'msd_ident\[batch\]'"):
        needs.library("pyarrow")
