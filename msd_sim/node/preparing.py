"""Loading and compiling the rig in a thread: a signal ends the process at once, and it says what takes so long."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable

#: A start that takes longer than this says what it does, and again each so often [s].
TOLD_AFTER, TOLD_EVERY = 5.0, 10.0


def prepare(
    asked: Callable[[], bool], work: Callable[[], None] | None = None, say: Callable[[str], None] | None = None
) -> bool:
    """Do the work in a thread and wait for it; whether it was done before somebody asked to stop.

    Args:
        asked: whether to stop.
        work: what to do; compiling the rig by default.
        say: told, in one line, when it takes long.

    Raises:
        BaseException: what the work raised.
    """
    failed: list[BaseException] = []

    def do() -> None:
        try:
            (work or warm_up)()
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=do, name="preparing", daemon=True)
    thread.start()
    begin, told = time.monotonic(), TOLD_AFTER
    while thread.is_alive():
        thread.join(0.05)
        if asked():
            return False
        passed = time.monotonic() - begin
        if passed > told and thread.is_alive():
            told = passed + TOLD_EVERY
            (say or _to_stderr)(
                f"rig: loading or compiling its solver for {passed:.0f} s now; it compiles once after an installation, "
                "about 10 s on a free core and minutes on a busy machine (`msd warm` does it beforehand)"
            )
    if failed:
        raise failed[0]
    return True


def warm_up() -> None:
    """Load the rig's compiled code, or compile it."""
    from msd_sim.rig import Rig
    from msd_sim.truth import Truth

    Rig(Truth(1.0, 1.0, 100.0, {})).sample([0.0])


def leave(code: int) -> None:
    """End the process now: a thread that compiles cannot be interrupted."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
