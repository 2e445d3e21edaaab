"""Programs that are started and ended together."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import os, signal, sys
from pathlib import Path
from msd_ident.ros.common.processes import Processes

number = signal.Signals[sys.argv[2]]
signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))

class Slow(Processes):
    def stop(self):
        os.kill(os.getpid(), number)
        super().stop()
        print("all ended", flush=True)

try:
    with Slow(Path(sys.argv[1]), os.environ) as group:
        group.start("sleeper", "asyncio", [])
        sleeper = group.pid("sleeper")
    print("went on")
except (KeyboardInterrupt, SystemExit) as error:
    print(type(error).__name__, os.path.exists(f"/proc/{sleeper}"))
"""


@pytest.mark.parametrize(("number", "raised"), [("SIGINT", "KeyboardInterrupt"), ("SIGTERM", "SystemExit")])
def test_a_signal_while_the_programs_are_ended_acts_once_they_have(tmp_path: Path, number: str, raised: str) -> None:
    words = [sys.executable, "-c", SCRIPT, str(tmp_path), number]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60.0)
    assert done.stdout.splitlines() == ["all ended", f"{raised} False"] and not done.stderr
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
