"""``ros2 run msd_ident recorder``: entry point of the node."""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence

from msd_ident.ros.common.entry_point import run_node


def main(args: Sequence[str] | None = None) -> int:
    """Run the recorder until a signal; the exit code."""
    return run_node("recorder", "Recorder", args, others=(signal.SIGUSR1, signal.SIGUSR2))


if __name__ == "__main__":
    sys.exit(main())
