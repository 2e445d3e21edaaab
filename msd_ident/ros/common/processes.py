"""A group of processes that are started and ended together, whatever happens in between. Imports no ROS."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from msd_ident.errors import SetupError
from msd_ident.ros.common.signals import ENDING, handled

#: Time that a program has to end by itself [s].
PATIENCE = 5.0
#: Option of prctl(2): the signal that a process gets when its parent ends, however it ends.
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class _Program:
    name: str
    process: subprocess.Popen[bytes]
    log: Path


class Processes:
    """A group of programs, each in a session of its own; leaving the block ends them all."""

    def __init__(self, logs: Path, environment: Mapping[str, str]) -> None:
        self._logs = logs
        self._environment = dict(environment)
        self._programs: list[_Program] = []

    def start(self, name: str, module: str, arguments: Sequence[str]) -> None:
        """Run a Python module; its output goes to ``NAME.log``."""
        log = self._logs / f"{name}.log"
        with log.open("wb") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", module, *arguments],
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_end_with_parent,
            )
        self._programs.append(_Program(name, process, log))

    def pid(self, name: str) -> int:
        """Number of a program's process."""
        return next(program.process.pid for program in self._programs if program.name == name)

    def check(self) -> None:
        """See that all are running.

        Raises:
            SetupError: one has ended.
        """
        for program in self._programs:
            code = program.process.poll()
            if code is not None:
                raise SetupError(
                    f"{program.name} ended with code {code}: {_last_line(program.log)}; expected it to run: "
                    f"see {program.log}"
                )

    def stop(self) -> None:
        """End all: ask first, then force; nothing of them is left."""
        for program in self._programs:
            _signal(program.process, signal.SIGINT)
        deadline = time.monotonic() + PATIENCE
        for program in self._programs:
            try:
                program.process.wait(max(deadline - time.monotonic(), 0.1))
            except subprocess.TimeoutExpired:
                _signal(program.process, signal.SIGKILL)
                program.process.wait()

    def __enter__(self) -> Processes:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with _signals_later():
            self.stop()


@contextmanager
def _signals_later() -> Iterator[None]:
    """Let signals that come within the block act after it."""
    came: list[int] = []
    try:
        with handled(lambda number, frame: came.append(number), *ENDING):
            yield
    finally:
        if came:
            signal.raise_signal(came[0])


def _signal(process: subprocess.Popen[bytes], number: int) -> None:
    """Signal the program and what it started."""
    with suppress(ProcessLookupError):  # when it has ended, and nothing of it is left
        os.killpg(process.pid, number)


def _end_with_parent() -> None:
    """In the child: be ended by the kernel when the parent is killed and cannot do it."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


def _last_line(log: Path) -> str:
    lines = log.read_text(errors="replace").strip().splitlines()
    return lines[-1].strip() if lines else "it said nothing"
