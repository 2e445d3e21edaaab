"""``msd`` in a process of its own that begins with what it imports: a tenth of a second, not two."""

from __future__ import annotations

import multiprocessing
import os
import sys
from dataclasses import dataclass
from pathlib import Path

#: What commands import within: imported once, before any of them.
HEAVY = (
    *("msd_ident.cli.main", "msd_ident.cli.diagnose", "msd_ident.cli.pages", "msd_ident.cli.groups", "rich.console"),
    *("msd_ident.workflow.pipeline", "msd_ident.io", "msd_ident.io.repair", "msd_ident.design", "pydantic.main"),
)

_processes = multiprocessing.get_context("forkserver")
_processes.set_forkserver_preload(list(HEAVY))


@dataclass(frozen=True)
class Done:
    """What came of a command; no exit code where it had to be killed."""

    code: int | None
    err: str


def run(arguments: list[str], folder: Path, seconds: float) -> Done:
    """The command in ``folder``; killed after so many seconds."""
    said = folder / "said.txt"
    process = _processes.Process(target=_command, args=(arguments, str(folder), str(said)))
    process.start()
    process.join(seconds)
    ended = process.exitcode is not None
    process.kill()
    process.join()
    return Done(process.exitcode if ended else None, said.read_text(encoding="utf-8"))


def _command(arguments: list[str], folder: str, said: str) -> None:
    """What the process does: standard input and output are nothing, errors go to a file."""
    nothing, errors = os.open(os.devnull, os.O_RDWR), os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for ours, theirs in ((nothing, 0), (nothing, 1), (errors, 2)):
        os.dup2(ours, theirs)
    from msd_ident.cli.main import main

    os.chdir(folder)
    sys.stdin, sys.stdout, sys.stderr = open(0), open(1, "w"), open(2, "w")  # noqa: SIM115
    sys.argv = ["msd", *arguments]
    sys.exit(main())
