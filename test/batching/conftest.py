"""One small cluster for all tests of a process, in its own threads, and a few records."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

distributed = pytest.importorskip("distributed", reason="the extra batch is not installed")

from batchrigs import step_file  # noqa: E402

from msd_ident.batching.running import Link  # noqa: E402


@pytest.fixture(scope="session")
def link() -> Iterator[Link]:
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=":0") as client:
        yield Link(client)


@pytest.fixture(scope="session")
def records(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of two robots with two records each."""
    folder = tmp_path_factory.mktemp("lab")
    for number in range(4):
        step_file(folder / f"arm_{number // 2}" / f"2026-03-0{number + 1}.csv", seed=number, temperature=20.0 + number)
    return folder
