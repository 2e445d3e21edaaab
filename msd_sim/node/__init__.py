"""The way into the rig node, ``ros2 run msd_ident rig``: hears signals from the first moment, so imports nothing heavy.

The handler only takes a note: a second Ctrl-C inside the shutdown has no effect.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from types import FrameType

from msd_sim.errors import RigError

#: Signals that end the node.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Stop:
    """Whether a signal has come that ends the node."""

    def __init__(self) -> None:
        self.asked = False

    def ask(self, _number: int, _frame: FrameType | None) -> None:
        """Signal handler."""
        self.asked = True


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the rig until a signal; exit code 0 then, 2 for parameters that make no sense."""
    stop = Stop()
    for number in ENDING:
        signal.signal(number, stop.ask)
    try:
        from msd_sim.node.preparing import leave, prepare

        if not prepare(lambda: stop.asked, _load):
            leave(0)
        from msd_sim.node.rig_node import run

        run(stop, arguments)
    except RigError as error:
        print(f"rig: {error}", file=sys.stderr)
        return 2
    finally:
        # Not back to their deadly defaults, as the interpreter does at its end with those that are handled.
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)
    return 0


def _load() -> None:
    """All that takes time before the node is there."""
    from msd_sim.node import rig_node  # noqa: F401
    from msd_sim.node.preparing import warm_up

    warm_up()
