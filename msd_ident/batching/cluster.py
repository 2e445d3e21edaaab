"""The Dask cluster of a batch: processes on this machine, or a scheduler that runs elsewhere."""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from types import FrameType
from typing import TYPE_CHECKING

from msd_ident.batching.code import code_version
from msd_ident.batching.needs import library
from msd_ident.errors import MsdError, SetupError, UsageError

if TYPE_CHECKING:
    from distributed import Client, LocalCluster

#: How long a scheduler may take to answer, and a cluster to show a worker [s].
ANSWER_SECONDS, WORKER_SECONDS = 10.0, 30.0
#: Dask's settings for workers with one long task each: its profiler walks the stack of a task a hundred times a second,
#: its event loops wake fifty times. Both take Python's lock from the task: together 4 % of a diagnosis.
FEW_INTERRUPTIONS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "2s",
}


@contextmanager
def quiet() -> Iterator[None]:
    """Hide Dask's own warnings, which are for the operator of the cluster; a lost worker is reported elsewhere."""
    library("distributed")  # it gives its loggers levels of their own
    rooms = ("distributed", "tornado", "asyncio")
    below = ("distributed.", "tornado.")
    names = [*rooms, *(name for name in logging.root.manager.loggerDict if name.startswith(below))]
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


@contextmanager
def this_machine(workers: int = 0) -> Iterator[Client]:
    """A cluster of processes on this machine, one a core unless said otherwise; gone at the end.

    Raises:
        UsageError: a number of workers that is none.
        SetupError: the processes do not start.
    """
    distributed = library("distributed")
    if workers < 0:
        raise UsageError(f"{workers} workers; expected at least 1, or 0 for one a core")
    count = workers or len(os.sched_getaffinity(0))
    with quiet(), library("dask").config.set(FEW_INTERRUPTIONS), ExitStack() as ends:
        with uninterrupted():
            try:
                cluster = distributed.LocalCluster(
                    n_workers=count, threads_per_worker=1, processes=True, silence_logs=logging.CRITICAL,
                    dashboard_address="127.0.0.1:0", host="127.0.0.1",
                )  # fmt: skip
            except (OSError, RuntimeError, TimeoutError) as error:
                raise SetupError(
                    f"{count} worker processes did not start ({_line(error)}); expected memory and ports for them: "
                    "give fewer with --workers"
                ) from None
            ends.callback(_close, cluster)
            client = distributed.Client(cluster)
            ends.callback(_close, client)
        yield client


@contextmanager
def uninterrupted() -> Iterator[None]:
    """A Ctrl-C in the block is raised at its end, and processes that are begun in it never hear one.

    Dask cannot be stopped while it starts its processes or ends them. The terminal sends Ctrl-C to its workers too,
    which have nothing to say about it: the process that began them ends them.
    """
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or usual is None:
        yield  # only the main thread is interrupted
        return
    came: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)

    resource_tracker.ensure_running()  # its start, else within the block, lets signals through again
    signal.signal(signal.SIGINT, note)
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # threads and processes of the block inherit it
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)
        signal.signal(signal.SIGINT, usual)
        if came:
            signal.raise_signal(signal.SIGINT)


def _close(opened: LocalCluster | Client) -> None:
    with uninterrupted():
        opened.close()


def connect(address: str, patience: float = ANSWER_SECONDS) -> Client:
    """A client of a scheduler that runs.

    Args:
        address: such as ``tcp://host:8786``.
        patience: longest wait for an answer [s].

    Raises:
        UsageError: the address is not valid.
        SetupError: nothing answers there.
    """
    distributed = library("distributed")
    try:
        return distributed.Client(address, timeout=patience, set_as_default=False)
    except ValueError as error:
        raise UsageError(f"scheduler {address}: {error}; expected an address such as tcp://host:8786") from None
    except (OSError, TimeoutError) as error:
        reason = "no answer" if isinstance(error, TimeoutError) else _line(error)
        raise SetupError(
            f"no scheduler at {address} ({reason}); expected one that runs: start it with dask scheduler, or leave "
            "--scheduler away to work on this machine"
        ) from None


def check_workers(client: Client) -> None:
    """Refuse a cluster whose workers would compute with other code than this.

    Raises:
        SetupError: there is no worker, or one has no msd_ident or another version of it.
    """
    try:
        client.wait_for_workers(1, timeout=WORKER_SECONDS)
    except TimeoutError:
        raise SetupError(
            f"the scheduler has no workers after {WORKER_SECONDS:g} s; expected at least one: start it with dask worker"
        ) from None
    here = code_version()
    try:
        found: dict[str, str] = client.run(code_version)
    except MsdError:
        raise
    except Exception as error:
        raise SetupError(
            f"a worker cannot say its version of msd_ident ({_line(error)}); expected {here} on all: install it there"
        ) from None
    others = {worker: version for worker, version in found.items() if version != here}
    if others:
        worker, version = next(iter(sorted(others.items())))
        raise SetupError(
            f"worker {worker} runs msd_ident {version}, here it is {here} ({len(others)} of {len(found)} workers "
            "differ); expected one version everywhere: install the same on all and start them again"
        )


def threads(client: Client) -> int:
    """Tasks that run at once."""
    return sum(client.nthreads().values())


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
