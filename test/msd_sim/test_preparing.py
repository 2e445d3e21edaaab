"""A rig that compiles its solver says so, and ends when it is asked to, whatever the compiler has left."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from msd_sim import kernel
from msd_sim.node.preparing import prepare, warm_up
from msd_sim.rig import Rig
from msd_sim.truth import Truth

WORDS = "rig: loading or compiling its solver for "
#: ``python -m msd_sim.node``, which speaks after half a second in place of five: the compiler works all that time.
NODE = "from msd_sim.node import main, preparing; preparing.TOLD_AFTER = 0.5; raise SystemExit(main())"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_rig_that_compiles_says_so_and_obeys_before_it_is_done(tmp_path: Path, number: int) -> None:
    cold = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", NODE]
    with subprocess.Popen(command, env=cold, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            said = process.stderr.readline()
            assert said.startswith(WORDS) and "`msd warm` does it beforehand" in said
            process.send_signal(number)
            process.send_signal(number)
            code = process.wait(60.0)
            outermost = f"kernel.{kernel.run.__name__}-*.nbc"
            assert not list(tmp_path.rglob(outermost)), "it waited for the compiler's end"
            assert code == 0 and "Traceback" not in process.stderr.read()
        finally:
            process.kill()


def test_what_fails_in_the_thread_is_raised() -> None:
    def work() -> None:
        raise ValueError("no compiler")

    with pytest.raises(ValueError, match="no compiler"):
        prepare(lambda: False, work)


def test_a_quick_start_says_nothing() -> None:
    said: list[str] = []
    assert prepare(lambda: False, lambda: None, said.append)
    assert said == []


def test_warm_compiles_solver_and_rig() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "msd_ident.cli.main", "warm"], capture_output=True, text=True, check=True
    )
    assert "solver: ready after" in done.stdout and "rig: ready after" in done.stdout


def test_instants_of_a_record_compile_nothing_anew() -> None:
    """They cannot be written to, which is another type for numba: the second one took a second in each process."""
    warm_up()
    known = list(kernel.run.signatures)
    instants = np.array([0.0, 0.1])
    instants.setflags(write=False)
    Rig(Truth(1.0, 1.0, 100.0, {})).sample(instants)
    assert kernel.run.signatures == known and all("readonly" not in str(one) for one in known)
