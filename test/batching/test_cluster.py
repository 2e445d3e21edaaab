"""Schedulers and workers: those that are not there, those with other code, those that die."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

distributed = pytest.importorskip("distributed", reason="the extra batch is not installed")

from batchrigs import die, die_once  # noqa: E402

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


def test_own_workers_are_not_profiled_and_other_clusters_keep_their_settings() -> None:
    import dask

    before = dask.config.get("distributed.worker.profile.enabled")
    with cluster.this_machine(1) as client:
        (found,) = client.run(lambda: __import__("dask").config.get("distributed.worker.profile.enabled")).values()
    assert found is False and before is True
    assert dask.config.get("distributed.worker.profile.enabled") is True


@contextmanager
def worker(address: str, folder: Path) -> Iterator[None]:
    """A worker that finds its modules in this folder first."""
    command = [sys.executable, "-m", "dask", "worker", address, "--no-nanny", "--no-dashboard", "--nthreads", "1"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, env={**os.environ, "PYTHONPATH": str(folder)}, cwd=folder, **quiet)  # type: ignore[call-overload]
    try:
        yield
    finally:
        process.kill()
        process.wait()


def test_two_versions_of_the_code_are_refused(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "msd_ident", ignore=shutil.ignore_patterns("__pycache__", "vendor"))
    with (tmp_path / "msd_ident" / "record.py").open("a") as source:
        source.write("# changed\n")
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=":0", protocol="tcp://") as here:
        address = here.scheduler_address
        with (
            worker(address, tmp_path),
            distributed.Client(address, set_as_default=False) as client,
            pytest.raises(SetupError, match=r"runs msd_ident .*, here it is .*1 of 1 workers differ.*one version"),
        ):
            cluster.check_workers(client)


def test_a_scheduler_without_workers_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "WORKER_SECONDS", 0.2)
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=":0", protocol="tcp://") as here,
        distributed.Client(here.scheduler_address, set_as_default=False) as client,
        pytest.raises(SetupError, match=r"no workers after 0.2 s; expected at least one: start it with dask worker"),
    ):
        cluster.check_workers(client)


@pytest.mark.timeout(110)
def test_a_worker_that_dies_costs_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import dask

    monkeypatch.setattr(running, "MOST_TRIES", 2)
    once = [Task(str(tmp_path / "mark"), die_once), *(Task(str(number), str.upper) for number in range(4))]
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), cluster.this_machine(1) as client:
        found = {answer.task.path: answer for answer in Runner(Link(client), once).answers()}
        (always,) = Runner(Link(client), [Task("always", die)]).answers()
    assert sorted(found) == sorted(task.path for task in once)
    assert found[str(tmp_path / "mark")].result == "done"
    assert "every worker that took it died, 2 times over" in always.error
    assert "give fewer workers" in always.error


INTERRUPTED = """
import os, signal, sys
import distributed
from msd_ident.batching import cluster

def interrupt():
    os.killpg(0, signal.SIGINT)  # as a terminal does: the workers too

place, start, close = sys.argv[1], distributed.Nanny.start_unsafe, distributed.LocalCluster.close

async def starting(nanny):
    interrupt()
    return await start(nanny)

def closing(*given, **named):
    interrupt()
    return close(*given, **named)

def main():
    if place == "start":
        distributed.Nanny.start_unsafe = starting
    if place == "end":
        distributed.LocalCluster.close = closing
    try:
        with cluster.this_machine(1) as client:
            assert client.run(os.getpid)
            if place == "work":
                interrupt()
    except KeyboardInterrupt:
        print("interrupted", {one.status.name for one in distributed.LocalCluster._instances})

if __name__ == "__main__":
    main()
"""


@pytest.mark.parametrize("place", ["start", "work", "end"])
def test_a_ctrl_c_waits_for_dask_and_its_workers_never_hear_it(place: str, tmp_path: Path) -> None:
    """An interrupted start left a cluster that could not be closed; interrupted workers printed tracebacks."""
    (tmp_path / "script.py").write_text(INTERRUPTED)
    command = [sys.executable, str(tmp_path / "script.py"), place]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120.0, start_new_session=True, cwd=tmp_path)
    assert (done.stdout, done.stderr, done.returncode) == ("interrupted {'closed'}\n", "", 0)
