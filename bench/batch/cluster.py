"""A scheduler and workers in processes of their own, started as the documentation says, and restarted when
they end, as a service manager does.
"""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

#: How often the processes are looked after [s].
_LOOK = 0.2


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Cluster:
    """Processes of ``dask scheduler`` and ``dask worker``.

    Args:
        workers: how many.
        folder: for their logs and scratch.
    """

    def __init__(self, workers: int, folder: Path) -> None:
        self._folder, self._port = folder, free_port()
        self.address = f"tcp://127.0.0.1:{self._port}"
        folder.mkdir(parents=True, exist_ok=True)
        dask = str(Path(sys.executable).parent / "dask")
        scheduler = [dask, "scheduler", "--host", "127.0.0.1", "--port", str(self._port), "--dashboard-address", ":0"]
        worker = [dask, "worker", self.address, "--nthreads", "1", "--no-dashboard", "--death-timeout", "20"]
        self._commands: list[Sequence[str]] = [scheduler, *([worker] * workers)]
        self._running: list[subprocess.Popen[bytes]] = [self._start(place) for place in range(workers + 1)]
        self._ends = threading.Event()
        self._keeper = threading.Thread(target=self._keep, daemon=True)
        self._keeper.start()

    def __enter__(self) -> Cluster:
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._keeper.join()
        for process in self._running:
            _end(process)

    def kill_worker(self, lots: random.Random) -> None:
        """Kill one: its nanny with all below it, or the process below that works."""
        place = lots.randrange(1, len(self._running))
        below = _children(self._running[place].pid)
        if below and lots.random() < 0.5:
            _kill(lots.choice(below))
        else:
            _end(self._running[place])

    def kill_scheduler(self) -> None:
        """Kill it; it is started again at the same address."""
        _end(self._running[0])

    def _start(self, place: int) -> subprocess.Popen[bytes]:
        log = (self._folder / f"{place}.log").open("ab")
        own = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        scratch = self._folder / f"scratch{place}"
        extra = ["--local-directory", str(scratch)] if place else []
        command = [*self._commands[place], *extra]
        return subprocess.Popen(command, stdout=log, stderr=log, env=own, start_new_session=True)

    def _keep(self) -> None:
        while not self._ends.wait(_LOOK):
            for place, process in enumerate(self._running):
                if process.poll() is not None:
                    _end(process)
                    self._running[place] = self._start(place)


def _children(pid: int) -> list[int]:
    try:
        text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    except OSError:
        return []
    return [int(one) for one in text.split()]


def _kill(pid: int) -> None:
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        return


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process with all that it started: its group is its own."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
