"""How a command ends: what it leaves to the system."""

from __future__ import annotations

import subprocess
import sys


def _printed(code: str, *arguments: object) -> str:
    given = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(given, capture_output=True, text=True, check=True).stdout


def test_the_end_of_a_command_takes_nothing_apart() -> None:
    """To look through half a million objects for cycles before the process ends takes a fifth of msd identify."""
    code = """
import atexit, gc
atexit.register(lambda: print(gc.get_freeze_count() > 0))  # runs after what main registers
from msd_ident.cli.main import main
main()
"""
    assert _printed(code, "--version").splitlines()[-1] == "True"
