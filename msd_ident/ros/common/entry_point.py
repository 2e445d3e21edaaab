"""What ``__main__`` of every node does. ROS is loaded only once signals are noted and the process is set up."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING

from msd_ident import parallel
from msd_ident.errors import MsdError, fail
from msd_ident.ros.common.signals import Signals, noted_signals

if TYPE_CHECKING:
    from msd_ident.ros.common.node_runner import NodeOwner


def run_node(
    folder: str,
    owner: str,
    args: Sequence[str] | None,
    others: Sequence[signal.Signals] = (),
    prepare: Callable[[Signals], dict[str, object]] = lambda signals: {},
) -> int:
    """Run a node until a signal; the exit code. An error that the user can correct is printed in one line.

    Args:
        folder: of this package, whose module ``node`` has the node's owner.
        owner: its class.
        args: of the command line; ``None`` for those of the process.
        others: signals that the node takes beside those that end it.
        prepare: called before ROS is loaded; gives arguments for the owner.
    """
    parallel.one_blas_thread()
    with noted_signals(*others) as signals:
        try:
            options = prepare(signals)
            from msd_ident.ros.common.node_runner import run

            def make() -> NodeOwner:
                made: NodeOwner = getattr(import_module(f"msd_ident.ros.{folder}.node"), owner)(**options)
                return made

            return run(make, signals, args)
        except MsdError as error:
            return fail(error)
