"""What the nodes say on ``/diagnostics``: one status a concern, a sentence and the numbers behind it."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.impl.rcutils_logger import RcutilsLogger

from msd_ident.ros.buffer import LiveBuffer
from msd_ident.ros.inputs import Input, listed

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR

#: Silence of the encoder that counts as an error [s].
SILENCE = 2.0
#: Part of late samples that counts as a warning.
MANY = 0.01


def array(stamp: Time, *statuses: DiagnosticStatus) -> DiagnosticArray:
    """Statuses with the instant at which they hold."""
    message = DiagnosticArray(status=list(statuses))
    message.header.stamp = stamp
    return message


def status(name: str, level: bytes, sentence: str, values: Mapping[str, object]) -> DiagnosticStatus:
    """One status."""
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    return DiagnosticStatus(level=level, name=name, message=sentence, hardware_id="", values=pairs)


def log(logger: RcutilsLogger, good: bool, sentence: str) -> None:
    """Say how something went. A line of its own for each severity: rclpy raises when one line changes it."""
    if good:
        logger.info(sentence)
    else:
        logger.warning(sentence)


def data_status(name: str, buffer: LiveBuffer, force: Sequence[Input], position: Sequence[Input]) -> DiagnosticStatus:
    """How the measurements are doing."""
    level, sentence = _judge_data(buffer, force, position)
    counts = buffer.counts
    ns, _ = buffer.recent(1.0)
    values = {
        "position samples": counts.positions,
        "force samples": counts.forces,
        "samples in buffer": buffer.position.size,
        "samples in the last second": ns.size,
        "late": counts.late,
        "duplicates": counts.duplicates,
        "missing by sequence": sum(entry.signal.missing for entry in position if entry.signal),
        "restarts of the clock": counts.restarts,
    }
    return status(name, level, sentence, values)


def _judge_data(buffer: LiveBuffer, force: Sequence[Input], position: Sequence[Input]) -> tuple[bytes, str]:
    counts = buffer.counts
    for entry in (*position, *force):
        if entry.problem:
            return ERROR, entry.problem
    heard = max(entry.heard for entry in position)
    odd = [entry.signal.problem for entry in (*position, *force) if entry.signal and entry.signal.problem]
    if not counts.positions:
        return ERROR, odd[0] if odd else f"no position samples; expected some on {listed(position)}"
    silent = time.monotonic() - heard
    if silent > SILENCE:
        return ERROR, f"no position sample for {silent:.0f} s; expected them on {listed(position)}"
    if force and not counts.forces:
        return WARN, odd[0] if odd else f"no force samples yet; expected some on {listed(force)}"
    if odd:
        return WARN, odd[0]
    if counts.late > MANY * counts.positions:
        return WARN, f"{counts.late} of {counts.positions} samples came late"
    return OK, f"{counts.positions} position samples, {counts.forces} force samples"
