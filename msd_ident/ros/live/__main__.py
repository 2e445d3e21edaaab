"""``ros2 run msd_ident live``: entry point of the live view's node."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from msd_ident.ros.common.entry_point import run_node
from msd_ident.ros.common.signals import Signals


def _require_page(signals: Signals) -> dict[str, object]:
    from msd_ident.live.needs import require_page

    require_page()
    return {}


def main(args: Sequence[str] | None = None) -> int:
    """Run the live view until a signal; the exit code."""
    return run_node("live", "LiveView", args, prepare=_require_page)


if __name__ == "__main__":
    sys.exit(main())
