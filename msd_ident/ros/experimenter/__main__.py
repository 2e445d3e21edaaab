"""``ros2 run msd_ident experimenter``: the way into the experimenter node."""

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
    """Run the experimenter until a signal; the exit code."""
    parallel.one_blas_thread()
    with noted_signals() as signals:
        try:
            from msd_ident.ros.common.node_runner import run

            def make() -> Owned:
                from msd_ident.ros.experimenter.node import Experimenter

                return Experimenter()

            return run(make, signals, args)
        except MsdError as error:
            return fail(error)


if __name__ == "__main__":
    sys.exit(main())
