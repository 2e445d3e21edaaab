"""Statuses that the nodes publish on ``/diagnostics``: each a sentence with its numbers."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node

from msd_ident.ros.common import names
from msd_ident.ros.common.fault_log import FaultLog
from msd_ident.ros.common.inputs import Input, crowds, listed
from msd_ident.ros.common.live_buffer import LiveBuffer
from msd_ident.ros.common.missing_samples import SILENCE, TopicCount

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR

#: Faults that one sentence tells.
MOST_SENTENCES = 3


class DiagnosticsPublisher:
    """Publishes the statuses of a node.

    Args:
        node: the node.
        hardware_id: name of the rig; empty: the namespace.
    """

    def __init__(self, node: Node, hardware_id: str) -> None:
        self._node = node
        self._hardware_id = hardware_id or node.get_namespace().strip("/") or "rig"
        self._publisher = node.create_publisher(DiagnosticArray, names.DIAGNOSTICS, 10)

    def name(self, concern: str) -> str:
        """Name of a status: the node with its namespace, then what it is about."""
        return names.status_name(self._node.get_namespace(), self._node.get_name(), concern)

    def publish(self, *statuses: DiagnosticStatus) -> None:
        """Publish statuses with the instant at which they hold."""
        for one in statuses:
            one.hardware_id = self._hardware_id
        message = DiagnosticArray(status=list(statuses))
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)


def status(name: str, level: bytes, sentence: str, values: Mapping[str, object]) -> DiagnosticStatus:
    """One status."""
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    return DiagnosticStatus(level=level, name=name, message=sentence, hardware_id="", values=pairs)


def log(logger: RcutilsLogger, good: bool, sentence: str) -> None:
    """Say how something went. A line of its own for each severity: rclpy raises when one line changes it.

    What went wrong is said once in a while: the same is in the answer to who asked, and on ``/diagnostics``.
    """
    if good:
        logger.info(sentence)
    else:
        logger.warning(sentence, throttle_duration_sec=1.0)


def data_status(
    name: str, buffer: LiveBuffer, force: Sequence[Input], position: Sequence[Input], watch: FaultLog
) -> DiagnosticStatus:
    """How the measurements are doing."""
    level, sentence = _judge_data(buffer, force, position, watch)
    counts = buffer.counts
    ns, _ = buffer.recent(1.0)
    values: dict[str, object] = {
        "position samples": counts.positions,
        "force samples": counts.forces,
        "samples in buffer": buffer.position.size,
        "samples in the last second": ns.size,
        "late": counts.late,
        "duplicates": counts.duplicates,
        "wild stamps": counts.wild,
        "recordings begun anew": counts.restarts,
    }
    for entry in (*position, *force):
        if entry.count.received:
            values |= topic_values(entry.topic, entry.count, entry.missing)
    return status(name, level, sentence, {**values, **fault_values(watch)})


def topic_values(topic: str, count: TopicCount, missing: int) -> dict[str, object]:
    """Rate of a topic and what is missing, for a status."""
    return {
        f"{topic}: rate [Hz]": f"{count.rate:.6g}",
        f"{topic}: missing by numbers": missing,
        f"{topic}: missing by stamps": count.holes,
    }


def fault_values(watch: FaultLog) -> dict[str, object]:
    """How often each fault was seen, for a status."""
    return {f"seen: {kind}": times for kind, times in watch.counts.items()}


def _judge_data(
    buffer: LiveBuffer, force: Sequence[Input], position: Sequence[Input], watch: FaultLog
) -> tuple[bytes, str]:
    counts = buffer.counts
    for entry in (*position, *force):
        if entry.problem:
            return ERROR, entry.problem
    odd = [entry.signal.problem for entry in (*position, *force) if entry.signal and entry.signal.problem]
    if not counts.positions:
        return ERROR, odd[0] if odd else f"no position samples; expected some on {listed(position)}"
    silent = time.monotonic() - max(entry.count.last_received for entry in position)
    if silent > SILENCE:
        nobody = "" if any(entry.publishers for entry in position) else ", and nobody publishes them"
        return ERROR, f"no position sample for {silent:.0f} s{nobody}; expected them on {listed(position)}"
    warnings = [*watch.recent, *crowds(position), *_silences(force)]
    if force and not counts.forces:
        warnings.append(f"no force samples yet; expected some on {listed(force)}")
    if warnings:
        return WARN, "; ".join(warnings[:MOST_SENTENCES])
    return OK, f"{counts.positions} position samples, {counts.forces} force samples"


def _silences(force: Sequence[Input]) -> Iterator[str]:
    """A force that came in a stream and does no more. One that is sent when it changes may be silent for long."""
    for entry in force:
        if entry.count.silence:
            yield f"{silence(entry.topic, entry.count)}: the last force is assumed to persist"


def silence(topic: str, count: TopicCount) -> str:
    """A stream that has ended, in words."""
    return f"{topic}: no message for {count.silence:.0f} s, where {count.rate:.3g} messages came in a second"
