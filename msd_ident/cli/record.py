"""``msd record``: topics of the graph into a bag."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from msd_ident.cli import options
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.ros.common.signals import Signals
    from msd_ident.ros.recorder.recording import Summary

#: Longest wait for somebody who publishes, where the recording has a duration [s].
WAIT = 5.0


TopicsArgument = Annotated[
    list[str] | None,
    typer.Argument(metavar="[TOPICS…]", help="topics to record; default: force, encoder and encoder_batch"),
]
OutOption = Annotated[Path | None, options.output_option(help="folder of the bag; default: named by date and time")]
DurationOption = Annotated[float, options.source_option(min=0.0, help="duration, in seconds; 0: until Ctrl-C")]
EveryOption = Annotated[bool, options.source_option("--all", help="all topics, including those that start later")]
CompressionOption = Annotated[str, options.output_option(help="compression of the bag: zstd or none")]
NamespaceOption = Annotated[
    str, options.source_option(help="ROS namespace of the topics; default: the one with publishers")
]


def record(
    topics: TopicsArgument = None,
    out: OutOption = None,
    duration: DurationOption = 0.0,
    every: EveryOption = False,
    compression: CompressionOption = "zstd",
    namespace: NamespaceOption = "",
) -> int:
    """Record topics to a rosbag2 folder (MCAP) until Ctrl-C; waits for topics that start later."""
    from msd_ident.cli.needs_ros import require_ros

    require_ros("msd record")
    if every and topics:
        raise UsageError("--all and topics were given; expected one of the two")
    from msd_ident.ros.common.signals import noted_signals

    with noted_signals(signal.SIGUSR1, signal.SIGUSR2) as signals:
        from msd_ident.ros.common.graph_discovery import kept_discovery
        from msd_ident.ros.common.node_runner import run
        from msd_ident.ros.common.parameters import overrides
        from msd_ident.ros.recorder.node import Recorder, check_request

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
            """Find the graph to record, and make the recorder in it."""
            check_request(target, topics or [], compression)
            with kept_discovery():
                place = namespace or _found(topics or [], every, signals, WAIT if duration else 0.0)
                made.append(Recorder(overrides(given), namespace=place))
            if duration:
                signals.finish_after(duration)
            return made[0]

        code = run(make, signals, args=[])
    return _report(made[0].summary if made else None, code)


def _found(topics: list[str], every: bool, signals: Signals, seconds: float) -> str:
    """Namespace of relative names, once somebody publishes one of them."""
    from msd_ident.ros.common import names
    from msd_ident.ros.common.graph_discovery import namespace_of

    relative = [topic for topic in topics if not topic.startswith(("/", "~"))]
    if every or (topics and not relative):
        return "/"
    place = namespace_of(relative or [names.ENCODER, names.ENCODER_BATCH], lambda: signals.ended, seconds)
    if place is None:
        raise UsageError("interrupted before anybody published what is to be recorded; nothing was recorded")
    if place != "/":
        typer.echo(f"recording in the namespace {place}", err=True)
    return place


def _report(summary: Summary | None, code: int) -> int:
    """Say what was recorded; nothing is no success."""
    if summary is None:
        return code
    if not summary.messages and not code:
        topics = ", ".join(summary.topics) or "no topic"
        raise DataError(
            f"nothing was recorded in {summary.folder}: no message came, of {topics}; expected some: does the rig run, "
            "under the same namespace and ROS_DOMAIN_ID?"
        )
    print(summary.sentence)
    return code
