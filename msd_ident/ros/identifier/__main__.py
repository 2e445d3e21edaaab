"""``ros2 run msd_ident identifier``: entry point of the node."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from msd_ident.ros.common.entry_point import run_node


def main(args: Sequence[str] | None = None) -> int:
    """Run the identifier until a signal; the exit code."""
    return run_node("identifier", "Identifier", args)


if __name__ == "__main__":
    sys.exit(main())
