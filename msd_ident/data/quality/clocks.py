"""Clocks of force and position that are apart, and a force that is only known for a part of the record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, warning
from msd_ident.data.record import Record

_UNKNOWN = "force_unknown"


def force_unknown(findings: Iterable[Finding]) -> bool:
    """Whether the cart of a record with these findings moves before the force is known."""
    return any(finding.code == _UNKNOWN for finding in findings)


def clocks(record: Record, motion: Motion) -> Iterator[Finding]:
    """Findings on motion before its cause or long after it, and on a force known for a part of the record only."""
    soon = max(2 * record.period, 0.002)
    if record.force_time[0] - motion.onset > soon:
        yield warning(
            _UNKNOWN,
            "the cart moves before the first sample of the force, which comes at "
            f"{record.force_time[0] - record.time[0]:.3f} s: what moved it is not known, so no cause is certain; "
            "record the force from before the motion on",
        )
    elif motion.early > soon:
        yield warning(
            "clocks_apart",
            f"the cart moves {motion.early:.3f} s before the force first changes: the clocks of force and encoder "
            "are apart, or something else pushed",
        )
    elif motion.half_period and motion.late > max(0.5 * motion.half_period, 5 * record.period):
        yield warning(
            "clocks_apart",
            f"the cart moves only {motion.late:.3f} s after a force step, a quarter of an oscillation or more: the "
            "clocks of force and encoder are apart, or the force acts late",
        )
    if record.force.size < 100:
        return
    late, early = record.force_time[0] - record.time[0], record.time[-1] - record.force_time[-1]
    spacing = 10 * float(np.median(np.diff(record.force_time))) + 10 * record.period
    for lack, where in ((late, "begins after"), (early, "ends before")):
        if lack > max(0.05 * record.duration, spacing):
            yield warning(
                "partial_overlap",
                f"the force {where} the position by {lack:.3f} s of {record.duration:.3f} s: use the part where both "
                "are recorded",
            )
