"""Ctrl-C is not lost where Python drops the exception of a signal."""

from __future__ import annotations

import os
import signal
import sys
import threading

#: Time until a lost signal is sent again [s]: the callback in which it was lost has returned by then.
_AGAIN = 0.02


def send_lost_signals_again() -> None:
    """From now on, a signal whose exception Python drops is sent to this process again.

    Python prints and drops an exception that leaves a destructor, or a callback which C code has called. llvmlite has
    such a callback for each function that numba compiles or loads, so Ctrl-C was lost there now and then.
    """
    usual = sys.unraisablehook

    def again(dropped: sys.UnraisableHookArgs) -> None:
        """Send the signal again that raised the exception; print any other exception."""
        number = _signal_of(dropped.exc_value)
        if number is None:
            return usual(dropped)
        timer = threading.Timer(_AGAIN, os.kill, (os.getpid(), number))
        timer.daemon = True
        timer.start()

    sys.unraisablehook = again


def _signal_of(error: BaseException | None) -> int | None:
    """The signal that raised an exception; None if it was none."""
    if isinstance(error, KeyboardInterrupt):
        return signal.SIGINT
    if isinstance(error, SystemExit) and error.code in (128 + signal.SIGTERM, 128 + signal.SIGHUP):
        return int(error.code) - 128
    return None
