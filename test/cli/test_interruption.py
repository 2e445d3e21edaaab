"""Ctrl-C while Python cannot raise an exception."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import ctypes, signal, sys, time
from msd_ident.cli.interruption import send_lost_signals_again

send_lost_signals_again()
number = signal.Signals[sys.argv[1]]
if number != signal.SIGINT:
    signal.signal(number, lambda number, frame: sys.exit(128 + number))

class Dropped:
    def __del__(self):
        signal.raise_signal(number)
        time.sleep(0.1)

@ctypes.CFUNCTYPE(None)
def called_by_c():
    signal.raise_signal(number)
    time.sleep(0.1)

try:
    called_by_c() if sys.argv[2] == "callback" else Dropped()
    time.sleep(10.0)
    print("lost")
except (KeyboardInterrupt, SystemExit) as error:
    print(type(error).__name__, getattr(error, "code", ""))
"""


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", *words], capture_output=True, text=True, timeout=60.0)


@pytest.mark.parametrize("place", ["callback", "destructor"])
@pytest.mark.parametrize(
    ("number", "raised"), [("SIGINT", "KeyboardInterrupt"), ("SIGTERM", "SystemExit 143"), ("SIGHUP", "SystemExit 129")]
)
def test_a_signal_in_a_callback_or_a_destructor_still_interrupts(number: str, raised: str, place: str) -> None:
    done = run(SCRIPT, number, place)
    assert (done.stdout.strip(), done.stderr) == (raised, "")


def test_any_other_exception_there_is_still_printed() -> None:
    done = run(SCRIPT.replace("signal.raise_signal(number)", "1 / 0").replace("10.0", "0.0"), "SIGINT", "destructor")
    assert done.stdout.strip() == "lost" and "ZeroDivisionError" in done.stderr


def test_a_command_that_is_interrupted_while_it_loads_ends_with_130_and_a_line() -> None:
    begun = "import signal, msd_ident.cli.main as m; m._register = lambda names: signal.raise_signal(signal.SIGINT)\n"
    done = run(begun + "raise SystemExit(m.main())")
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "msd: interrupted\n")


@pytest.mark.parametrize("command", ["identify", "diagnose", "design", "simulate"])
def test_a_command_that_is_interrupted_in_its_work_says_so(command: str) -> None:
    begun = (
        "import signal, sys, typer, msd_ident.cli.main as m\n"
        "def command(): signal.raise_signal(signal.SIGINT)\n"
        "m.importlib.import_module = lambda name: type('module', (), {name.split('.')[-1]: staticmethod(command)})\n"
        "sys.argv[1:] = [WORD]\n"
        "raise SystemExit(m.main())"
    )
    done = run(begun.replace("WORD", repr(command)))
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "msd: interrupted\n")
