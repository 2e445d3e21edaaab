"""Where records lie: folders, patterns, lists, and an object store that really answers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("fsspec", reason="the extra batch is not installed")

from batchrigs import step_file  # noqa: E402

from msd_ident.batching import batch, locations, table  # noqa: E402
from msd_ident.batching.job import Job  # noqa: E402
from msd_ident.batching.running import Link  # noqa: E402
from msd_ident.errors import DataError, SetupError, UsageError  # noqa: E402

BAGS = Path(__file__).resolve().parents[2] / "bags"


def names(found: tuple[str, ...]) -> list[str]:
    return [os.path.basename(path) for path in found]


def test_a_folder_gives_its_bags_and_files(tmp_path: Path) -> None:
    for name in ("b.csv", "a.mcap", "deep/c.mat", "d.mcap.zstd", "e.csv.zst", ".hidden.csv", "notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert names(locations.records([tmp_path])) == ["a.mcap", "b.csv", "d.mcap.zstd", "c.mat"]
    assert names(locations.records([tmp_path / "*.csv", tmp_path / "b.csv"])) == ["b.csv"]
    assert names(locations.records([BAGS])) == ["drag_steps", "paper_step", "release"]


def test_a_list_has_a_path_a_line() -> None:
    assert locations.listed("# today\n a.csv \n\nb.csv\n") == ("a.csv", "b.csv")


@pytest.fixture(scope="module")
def store() -> Iterator[str]:
    server = pytest.importorskip("moto.server", reason="moto is not installed")
    one = server.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    one.start()
    host, port = one.get_host_and_port()
    yield f"http://{host}:{port}"
    one.stop()


@pytest.mark.xdist_group("batching")
@pytest.mark.usefixtures("without_copies")
def test_records_and_table_in_an_object_store(
    store: str, link: Link, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("ACCESS_KEY_ID", "x"), ("SECRET_ACCESS_KEY", "x"), ("ENDPOINT_URL", store)):
        monkeypatch.setenv(f"AWS_{name}", value)
    import s3fs

    files = s3fs.S3FileSystem(endpoint_url=store, skip_instance_cache=True)
    files.mkdir("lab")
    path = step_file(tmp_path / "one.csv")
    files.put_file(str(path), "lab/arm_1/one.csv")
    files.put(str(BAGS / "release"), "lab/arm_1/release", recursive=True)
    found = locations.records(["s3://lab"])
    assert found == ("s3://lab/arm_1/one.csv", "s3://lab/arm_1/release")
    assert names(locations.records(["s3://lab/*/*.csv"])) == ["one.csv"]
    batch.run(found, Job(), link, batch.Plan("s3://lab/table.parquet"))
    rows = table.read("s3://lab/table.parquet").to_pylist()
    assert [(row["name"], row["robot"], row["error"]) for row in rows] == [
        ("one.csv", "arm_1", None), ("release", "arm_1", None)
    ]  # fmt: skip
    here = batch.run([str(path)], Job(), link, batch.Plan())[0].to_pylist()[0]
    assert (rows[0]["stiffness"], rows[0]["sha256"]) == (here["stiffness"], here["sha256"])
    _, this = batch.run(found, Job(), link, batch.Plan("s3://lab/table.parquet", resume=True))
    assert this.reused == 2


@pytest.mark.xdist_group("batching")  # s3fs takes seconds to import
@pytest.mark.parametrize(
    ("path", "error", "says"),
    [
        ("s3://nowhere/x.csv", (SetupError, DataError), "expected"),
        ("nothing://x/y.csv", UsageError, "expected a store that fsspec knows, e.g. s3://bucket/folder"),
    ],
)
def test_stores_that_cannot_be_had_are_said(
    path: str, error: type[Exception], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "x")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "x")
    monkeypatch.setenv("AWS_MAX_ATTEMPTS", "1")
    with pytest.raises(error, match=says), locations.local(path):
        pass
