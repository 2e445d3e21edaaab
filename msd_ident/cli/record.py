"""``msd record``: topics of the graph into a bag."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated, Optional

import typer

from msd_ident.errors import UsageError


def record(
    topics: Annotated[
        Optional[list[str]],  # noqa: UP045 - typer reads it at run time, also on Python 3.10
        typer.Argument(metavar="[TOPICS…]", help="topics to record; none: force, encoder and encoder_batch"),
    ] = None,
    out: Annotated[Optional[Path], typer.Option(help="bag to make; else named by date and time")] = None,  # noqa: UP045
    duration: Annotated[float, typer.Option(min=0.0, help="seconds; 0: until Ctrl-C")] = 0.0,
    every: Annotated[bool, typer.Option("--all", help="every topic there is and those that come")] = False,
    compression: Annotated[str, typer.Option(help="of the bag's chunks: zstd or none")] = "zstd",
) -> int:
    """Record topics to a rosbag2 folder (MCAP) until Ctrl-C; topics that come later are waited for."""
    from msd_ident.cli.needs_ros import require_ros

    require_ros("msd record")
    if every and topics:
        raise UsageError("--all and topics were given; expected one of the two")
    from msd_ident.ros.signals import noted_signals

    with noted_signals(signal.SIGUSR1, signal.SIGUSR2) as signals:
        from msd_ident.ros.parameters import overrides
        from msd_ident.ros.recorder_node import Recorder
        from msd_ident.ros.run import run

        target = out.expanduser().absolute() if out else None
        given = {
            "autostart": True,
            "all_topics": every,
            "compression": compression,
            "bag_folder": str(target.parent) if target else ".",
            "folder": target.name if target else "",
            **({"topics": topics} if topics else {}),
        }
        made: list[Recorder] = []

        def make() -> Recorder:
            made.append(Recorder(overrides(given)))
            if duration:
                signals.finish_after(duration)
            return made[0]

        code = run(make, signals, args=[])
    if made and made[0].summary:
        print(made[0].summary.sentence)
    return code
