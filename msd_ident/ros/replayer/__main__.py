"""``ros2 run msd_ident replayer``: entry point of the node."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from msd_ident.ros.common.entry_point import run_node


def main(args: Sequence[str] | None = None) -> int:
    """Play the bag of the parameter ``bag`` to its end or until a signal; the exit code."""
    return run_node("replayer", "Replayer", args, prepare=lambda signals: {"on_end": signals.finish})


if __name__ == "__main__":
    sys.exit(main())
