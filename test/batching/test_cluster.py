"""Schedulers and workers: those that are not there, those with other code, those that die."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

distributed = pytest.importorskip("distributed", reason="the extra batch is not installed")

from msd_ident.batching import cluster, running  # noqa: E402
from msd_ident.batching.running import Link, Runner, Task  # noqa: E402
from msd_ident.errors import SetupError, UsageError  # noqa: E402

PACKAGE = Path(cluster.__file__).resolve().parents[1]


def test_a_scheduler_that_is_not_there_is_said() -> None:
    with socket.socket() as nobody:
        nobody.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{nobody.getsockname()[1]}"
        with pytest.raises(
            SetupError, match=f"no scheduler at {address}.*start it with dask scheduler, or leave --sch"
        ):
            cluster.connect(address, 0.5)
    with pytest.raises(UsageError, match="expected an address such as tcp://host:8786"):
        cluster.connect("nonsense://x", 0.5)


@contextmanager
def worker(address: str, **environment: str) -> Iterator[None]:
    command = [sys.executable, "-m", "dask", "worker", address, "--no-nanny", "--no-dashboard", "--nthreads", "1"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, env={**os.environ, **environment}, **quiet)  # type: ignore[call-overload]
    try:
        yield
    finally:
        process.kill()
        process.wait()


def test_two_versions_of_the_code_are_refused(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "msd_ident", ignore=shutil.ignore_patterns("__pycache__", "vendor"))
    with (tmp_path / "msd_ident" / "record.py").open("a") as source:
        source.write("# changed\n")
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None, host="127.0.0.1") as here:
        address = here.scheduler_address
        with (
            worker(address, PYTHONPATH=str(tmp_path)),
            distributed.Client(address, set_as_default=False) as client,
            pytest.raises(SetupError, match=r"runs msd_ident .*, here it is .*1 of 1 workers differ.*one version"),
        ):
            cluster.check_workers(client)


def test_a_scheduler_without_workers_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "WORKER_SECONDS", 0.2)
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None, host="127.0.0.1") as here,
        distributed.Client(here.scheduler_address, set_as_default=False) as client,
        pytest.raises(SetupError, match=r"no workers after 0.2 s; expected at least one: start it with dask worker"),
    ):
        cluster.check_workers(client)


def die_once(path: str) -> str:
    """Take the process along, the first time."""
    mark = Path(path)
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def die(path: str) -> str:
    """Take the process along, every time."""
    os.kill(os.getpid(), signal.SIGKILL)
    return path


@pytest.mark.timeout(110)
def test_a_worker_that_dies_costs_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import dask

    monkeypatch.setattr(running, "MOST_TRIES", 2)
    tasks = [Task(str(tmp_path / "mark"), die_once), Task("always", die), *(Task(str(n), str.upper) for n in range(4))]
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), cluster.this_machine(1) as client:
        found = {answer.task.path: answer for answer in Runner(Link(client), tasks).answers()}
    assert len(found) == len(tasks)
    assert found[str(tmp_path / "mark")].result == "done"
    assert "every worker that took it died, 2 times over" in found["always"].error
    assert "give fewer workers" in found["always"].error
