"""``msd replay``: a bag back to the graph."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from msd_ident.cli import options


def replay(
    bag: Annotated[Path, options.path_argument(metavar="BAG", help="rosbag2 folder, .mcap or .db3 file")],
    rate: Annotated[float, typer.Option(help="playback speed, 0.01 to 100")] = 1.0,
    loop: Annotated[bool, typer.Option("--loop", help="restart at the end")] = False,
    clock: Annotated[bool, typer.Option("--clock", help="publish /clock for nodes with use_sim_time")] = False,
    topics: Annotated[list[str] | None, typer.Option("--topic", help="play only this topic; repeatable")] = None,
    wait: Annotated[float, typer.Option(help="longest wait until every topic has a subscriber, in seconds")] = 3.0,
) -> int:
    """Play a bag as it was recorded: same bytes, order and QoS, at a chosen speed."""
    from msd_ident.cli.needs_ros import require_ros

    require_ros("msd replay")
    from msd_ident.ros.common.signals import noted_signals

    with noted_signals() as signals:
        from msd_ident.ros.common.node_runner import run
        from msd_ident.ros.common.parameters import overrides
        from msd_ident.ros.replayer.node import Replayer

        given = {
            "bag": str(bag),
            "rate": rate,
            "loop": loop,
            "clock": clock,
            "wait": wait,
            **({"topics": topics} if topics else {}),
        }

        def make() -> Replayer:
            return Replayer(overrides(given), on_end=signals.finish)

        return run(make, signals, args=[])
