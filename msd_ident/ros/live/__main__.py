"""``ros2 run msd_ident live``: the way into the live view's node."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from msd_ident import parallel
from msd_ident.errors import MsdError
from msd_ident.ros.common.signals import fail, noted_signals

if TYPE_CHECKING:
    from msd_ident.ros.common.node_runner import Owned


def main(args: Sequence[str] | None = None) -> int:
    """Run the live view until a signal; the exit code."""
    parallel.one_blas_thread()
    with noted_signals() as signals:
        try:
            from msd_ident.live.needs import require_page

            require_page()
            from msd_ident.ros.common.node_runner import run

            def make() -> Owned:
                from msd_ident.ros.live.node import LiveView

                return LiveView()

            return run(make, signals, args)
        except MsdError as error:
            return fail(error)


if __name__ == "__main__":
    sys.exit(main())
